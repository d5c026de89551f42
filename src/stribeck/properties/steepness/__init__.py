"""The smallest steepness k_v with which a smooth law is as close to the exact one as a user needs.

A smaller k_v is a smoother law: dF/dt varies less abruptly around v = 0, and a fixed step resolves it. A larger one is
closer to |v|. The user says which errors are tolerable. Closed forms answer where there are any, otherwise the law's
steady state.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

from stribeck import laws
from stribeck.constants import show
from stribeck.errors import InputError
from stribeck.laws.base import Law
from stribeck.properties.steepness.cost import Cost, cost
from stribeck.properties.steepness.search import Requirement, counterpart, family
from stribeck.properties.steepness.tolerated import Tolerated

__all__ = ["Cost", "Requirement", "Steepness", "Tolerated", "smallest_steepness"]

MAJORANTS = {"lugre": "lugre_majorant", "elastoplastic": "elastoplastic_majorant"}


@dataclass(frozen=True)
class Steepness:
    """The smallest k_v of a law that meets every tolerance.

    Attributes:
        law: the law's name.
        k_v: in s/m; 0 if any will do, None if none will.
        requirements: each tolerance by itself, and the k_v that it needs.
        cost: the price at this k_v.
        rotary: whether the machine turns: rad for m, N m for N in all units.
    """

    law: str
    k_v: float | None
    requirements: tuple[Requirement, ...]
    cost: Cost | None
    rotary: bool = False

    def to_dict(self) -> dict[str, object]:
        """As plain data."""
        return asdict(self)


def smallest_steepness(law: Law, tolerated: Tolerated) -> dict[str, Steepness]:
    """The smallest k_v that meets the tolerances, for a law and for the majorant law of its family.

    Args:
        law: a bristle law with k_v; the value of its k_v plays no part.
        tolerated: the errors that are allowed.

    Returns:
        By law: the one asked for, and the majorant law unless it is that.

    Raises:
        InputError: a tolerance is not valid, or the law is another; one line for each problem.
    """
    if problems := tolerated.problems():
        raise InputError(problems)
    fit = [n for n, each in laws.builtin().items() if each.has_z and "k_v" in each.constants()]
    if law.name not in fit or type(law) is not laws.builtin()[law.name]:
        raise InputError(f"{show(law.name)}: must be a law with bristles and k_v: {', '.join(fit)}")
    by_law = {}
    for name in dict.fromkeys((law.name, MAJORANTS[family(law)])):
        variant = law if name == law.name else counterpart(law, name)
        requirements = tuple(tolerance.need(variant) for tolerance in tolerated.tolerances(variant))
        needed = [each.k_v for each in requirements if each.k_v is not None]
        k_v = max(needed) if len(needed) == len(requirements) else None
        price = cost(variant, k_v, tolerated.fastest(variant)) if k_v else None
        by_law[name] = Steepness(name, k_v, requirements, price, law.rotary)
    return by_law
