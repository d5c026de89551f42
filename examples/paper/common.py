"""What the chapters share: the laws, their simulations, lines and numbers as text."""

from __future__ import annotations

import io
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from stribeck import examples
from stribeck.arrays import Array
from stribeck.errors import StribeckError, StribeckNote
from stribeck.mouth import document, plots
from stribeck.mouth.document import FigureSvg
from stribeck.scenario import Scenario
from stribeck.simulation import Solution, simulate

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Printed(FigureSvg):
    """A figure of the paper, which is written as PNG too."""

    png: bytes = b""


def finish(made: Figure, name: str, caption: str) -> Printed:
    """The drawn figure under a name, with its caption. Call within :func:`stribeck.mouth.plots.style`."""
    return Printed(name, plots.svg(made), caption, png(made))


def png(made: Figure) -> bytes:
    """A figure that :func:`stribeck.mouth.plots.svg` has laid out as PNG."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    buffer = io.BytesIO()
    FigureCanvasAgg(made)
    made.savefig(buffer, format="png", dpi=160, metadata={"Software": None}, pil_kwargs={"compress_level": 3})
    return buffer.getvalue()


@dataclass(frozen=True)
class Chapter(document.Chapter):
    """A chapter of the report: what it says, and ``numbers`` and ``data`` (columns) for programs."""

    figures: Sequence[Printed] = ()
    numbers: Mapping[str, Any] = field(default_factory=dict)
    data: Mapping[str, ArrayLike] = field(default_factory=dict)


Variant = tuple[str, dict[str, float]]  # a law and its own constants

STEEPNESSES = (1e6, 1e7, 1e8)  # s/m, the paper's k_v
REFERENCE = "lugre"
# What the paper compares: the original, and its proposal at three values of k_v.
PAPER: dict[str, Variant] = {
    REFERENCE: ("lugre", {}),
    **{f"proposed, k_v = 1e{n} s/m": ("lugre_sobczyk", {"k_v": 10.0**n}) for n in (6, 7, 8)},
}
# Every law with bristles.
BRISTLES: dict[str, Variant] = {
    "lugre": ("lugre", {}),
    "lugre_arctan": ("lugre_arctan", {"k_v": 1e6}),
    "lugre_sobczyk": ("lugre_sobczyk", {"k_v": 1e6}),
    "lugre_majorant": ("lugre_majorant", {"k_v": 1e6}),
    "elastoplastic": ("elastoplastic", {"z_ba": 7e-6}),
    "elastoplastic_sobczyk": ("elastoplastic_sobczyk", {"z_ba": 7e-6, "k_v": 1e6}),
    "elastoplastic_majorant": ("elastoplastic_majorant", {"z_ba": 7e-6, "k_v": 1e6}),
    "dahl": ("dahl", {}),
}
PROPOSED = tuple(PAPER)[1:]

Done = Mapping[str, Chapter]  # the chapters before, for what they computed


def scenario(example: str, variant: Variant, **changes: object) -> Scenario:
    """An example scenario under a law; keywords replace values, with __ for the dot: drive__signal__rate=2.0."""
    law, constants = variant
    data = Scenario.load(examples.path(example)).data
    table = {"name": law, "parameters": data["law"]["parameters"], **constants}
    return Scenario({**data, "law": table}).with_changes({k.replace("__", "."): v for k, v in changes.items()})


def solve(wanted: Scenario, label: str = "") -> Solution:
    """The solution of a scenario that must succeed.

    Raises:
        StribeckError: the simulation failed.
    """
    with warnings.catch_warnings():
        # laws without damping are shown as they are: nobody who makes the report can tighten their tolerance
        warnings.simplefilter("ignore", StribeckNote)
        solution = simulate(wanted)
    if solution.reason:
        raise StribeckError(f"{wanted.name} under {label or wanted.law.name} failed: {solution.reason}")
    return solution


def solve_all(example: str, variants: Mapping[str, Variant] = PAPER, **changes: object) -> dict[str, Solution]:
    """An example scenario under each of the laws, by label."""
    return {label: solve(scenario(example, variant, **changes), label) for label, variant in variants.items()}


def record(solutions: Mapping[str, Solution]) -> dict[str, Array]:
    """The columns of several solutions below each other, with the law's label in the column ``law``."""
    names = ("t", *(column.name for column in next(iter(solutions.values())).columns))
    labels = np.repeat(list(solutions), [len(s.t) for s in solutions.values()])
    return {"law": labels, **{name: np.concatenate([s[name] for s in solutions.values()]) for name in names}}
