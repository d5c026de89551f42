"""What the chapters share: the three laws, their simulations, and numbers as text."""

from __future__ import annotations

from typing import Any

from stribeck import examples
from stribeck.errors import StribeckError
from stribeck.scenario import Scenario
from stribeck.simulation import Solution, simulate

# label, law, its own constants
LAWS: tuple[tuple[str, str, dict[str, float]], ...] = (
    ("lugre", "lugre", {}),
    ("lugre_sobczyk, k_v = 1e7 s/m", "lugre_sobczyk", {"k_v": 1e7}),
    ("lugre_majorant, k_v = 1e6 s/m", "lugre_majorant", {"k_v": 1e6}),
)
REFERENCE = LAWS[0][0]


def scenario(example: str, law: str, constants: dict[str, float], **changes: Any) -> Scenario:
    """An example scenario under a law; keywords replace values, with __ for the dot: drive__signal__rate=2.0."""
    data = Scenario.load(examples.path(example)).data
    table = {"name": law, "parameters": data["law"]["parameters"], **constants}
    paths = {path.replace("__", "."): value for path, value in changes.items()}
    return Scenario({**data, "law": table}).with_changes(paths)


def simulate_all(example: str, **changes: Any) -> dict[str, Solution]:
    """An example scenario under each of the laws, by label.

    Raises:
        StribeckError: a simulation failed.
    """
    found = {}
    for label, law, constants in LAWS:
        found[label] = simulate(scenario(example, law, constants, **changes))
        if found[label].reason:
            raise StribeckError(f"{example} under {label} failed: {found[label].reason}")
    return found


def percent(share: float) -> str:
    """A share as a percentage with three digits."""
    return f"{100 * share:.3g} %"
