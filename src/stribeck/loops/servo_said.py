"""The document of a servo's design: conditions, proof, and V along the simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stribeck.constants import DECIDED
from stribeck.loops.gains import Condition
from stribeck.loops.lyapunov import Along, gains_of
from stribeck.loops.proof import derive
from stribeck.mouth import plots
from stribeck.mouth.cells import digits, human
from stribeck.mouth.document import PAGE, Cell, Chapter, Document, Figure, Head, Table
from stribeck.scenario import said as of_scenario
from stribeck.simulation.drawing import overview

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawn

    from stribeck.loops.servo import ServoDesign

_SPANS = 4  # of time that are shown
_WORD = {True: "proved", False: "refuted", None: "not decided"}


def servo(result: ServoDesign) -> Document:
    """The document of a :class:`~stribeck.loops.ServoDesign`."""
    scenario, v, proof = result.solution.scenario, result.gains, result.proof
    given = gains_of(scenario)
    facts = [f"by intervals, for all errors, in {proof.boxes} boxes{f': {proof.reason}' if proof.reason else ''}"]
    if not v.exact.holds:
        facts.append(
            f"gains with a margin of two: K_D = {digits(v.proposed['K_D'], 4)}, or K = {digits(v.proposed['K'], 4)}"
        )
    facts.append("not covered: " + "; ".join(result.not_covered))
    rows = [_row("exact condition", v.exact), _row("corrected eq. (21)", v.sufficient)]
    numbers = [Head(text, 4) for text in ("needs K_D at least (N s/m)", "margin", "up to (m/s)")]
    head: list[str | Head] = ["condition", "holds", *numbers]
    gains: list[list[Cell]] = [[n, given[n], v.proposed[n]] for n in ("K_D", "K")]
    conditions = Chapter(
        "conditions", "Conditions and proof", (),
        [Table(head, rows), Table(["gain", "given", "with a factor of two to spare"], gains, on=PAGE)],
        facts=[
            f"K_D = {given['K_D']:g} N s/m, K = {given['K']:g} m/N, w <= {digits(v.w_max, 4)} 1/s",
            f"corrected eq. (21) also needs K < {digits(v.largest_K_sufficient, 4)} m/N",
        ],
        code=f"dV/dt = {derive().derivative}",
    )  # fmt: skip
    drawn = [] if result.along is None else [_lyapunov_figure(result.along)]
    figures = [*drawn, overview({scenario.name: result.solution})]
    chapters = [conditions, *([_along(result)] if result.along is not None else [])]
    return Document(
        scenario.name,
        f"V decreases for |v| <= {digits(v.v_max, 4)} m/s: {_WORD[proof.proven]}",
        facts,
        [*chapters, Chapter("plots", "Plots", figures=figures, on=PAGE), of_scenario.file(scenario)],
    )


def _row(name: str, c: Condition) -> list[Cell]:
    return [name, DECIDED[c.holds], c.least_K_D, c.margin, "any" if c.largest_speed is None else c.largest_speed]


def _along(result: ServoDesign) -> Chapter:
    """V along the simulation: its ends, rises, and the intervals above the bound."""
    along = result.along
    assert along is not None
    facts = [
        f"V goes from {human(along.V[0], 'J', 4)} to {human(along.V[-1], 'J', 4)}; rows after which it rises by more than "
        f"1e-9 V(0): {int(along.rises.sum())}; largest rise: {human(along.largest_rise, 'J')}"
    ]
    for what, spans in zip(("V rises", "dV/dt above eq. (19)", "valve saturates"), along.spans.values(), strict=True):
        if spans:
            more = f" and {len(spans) - _SPANS} more" if len(spans) > _SPANS else ""
            facts.append(f"{what}: t = " + ", ".join(f"{a:g} to {b:g}" for a, b in spans[:_SPANS]) + f" s{more}")
    if (stays := result.staying) is not None:
        word = "stays" if stays.holds else "is not shown to stay"
        facts.append(
            f"from this start |v| {word} below {digits(result.gains.v_max, 4)} m/s (V falls, so |v| <= {digits(stays.bound, 4)} "
            f"m/s); so it does from every start with V(0) < {human(stays.largest_V, 'J', 4)} and lambda |e(0)| <= "
            "sqrt(2 V(0)/M)"
        )
    return Chapter("along", "Along the simulation", facts=facts)


def _lyapunov_figure(along: Along) -> Figure:
    """A figure of V, and of dV/dt with its bound if there is one."""

    def draw() -> Drawn:
        rows = [["V"]] if along.dV_dt is None else [["V"], ["rate"]]
        figure, axes = plots.figure(rows, 2.2 * len(rows) + 0.4)
        axes["V"].plot(*plots.thin(along.t, along.V), color=plots.COLORS[2])
        axes["V"].set(xlabel="t (s)", ylabel="V (J)", title="Lyapunov function along the simulation")
        plots.logarithmic(axes["V"], x=False)
        if along.dV_dt is not None:
            axis = axes["rate"]
            for i, (values, label) in enumerate(((along.bound, "bound, eq. (19)"), (along.dV_dt, "dV/dt"))):
                if values is not None:
                    falling = np.where(values < 0, -values, np.nan)
                    plots.line(axis, i + 1, *plots.thin(along.t, falling), label)
            axis.set(xlabel="t (s)", ylabel="-dV/dt (W)", title="how fast it falls, and the proof's bound")
            plots.logarithmic(axis, x=False)
            axis.legend(fontsize=8)
        return figure

    caption = "Where a line is missing V does not fall: rounding, at the level of the solver's tolerance, or a rise."
    return Figure("gains", caption, draw)
