"""The page of ``stribeck design`` of a servo: conditions, proof, and V along the simulation."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from stribeck.constants import DECIDED
from stribeck.control.gains import Condition
from stribeck.errors import left_out
from stribeck.files import write_summary
from stribeck.loops.lyapunov import Along
from stribeck.loops.servo import ServoDesign
from stribeck.mouth import page, plots
from stribeck.mouth.document import Chapter, Document, Figure, FigureSvg, Table
from stribeck.scenario import said as of_scenario
from stribeck.scenario.cascade import gains_of
from stribeck.simulation.drawing import overview


def write_servo(found: ServoDesign, summary: Mapping[str, object], folder: Path, command: str = "") -> list[str]:
    """Write gains.svg and plot.svg (with PNG and PDF), report.html and, last, summary.json; the paths."""
    solution, paths = found.solution, list[Path]()
    with left_out("the plots and the page"):
        figures: list[Figure | FigureSvg] = [_along(found.along)] if found.along is not None else []
        figures.append(overview({solution.scenario.name: solution}))
        text, tables = _conditions(found)
        derivation = f"dV/dt = {summary['derivative']}"
        chapter = Chapter("conditions", "Conditions and proof", text, tables, code=derivation)
        pages = [chapter, Chapter("plots", "Plots", figures=figures), of_scenario.file(solution.scenario)]
        word = {True: "is proved", False: "is refuted", None: "is not settled"}[found.proof.proven]
        lead = f"that V decreases for |v| up to {found.gains.v_max:.4g} m/s {word}"
        title = f"{solution.scenario.name}: do these gains hold?"
        paths = page.write(Document(title, lead, (), pages), folder, command)
    return write_summary(paths, folder, folder, summary)


def _conditions(found: ServoDesign) -> tuple[list[str], list[Table]]:
    gains, v, proof = gains_of(found.solution.scenario), found.gains, found.proof
    rows = [_row("exact condition", v.exact), _row("corrected (21)", v.sufficient)]
    head = ["condition", "holds", "needs K_D at least (N s/m)", "margin", "certifies up to (m/s)"]
    proposed = [[n, f"{gains[n]:.6g}", f"{v.proposed[n]:.6g}"] for n in ("K_D", "K")]
    word = {True: "proved", False: "refuted", None: "not settled"}[proof.proven]
    why = f" ({proof.reason})" if proof.reason else ""
    text = [
        f"By intervals, dV/dt <= 0 for all errors and |v| <= {v.v_max:.4g} m/s: {word}{why}, {proof.boxes} boxes.",
        f"Corrected (21) also needs K < {v.largest_K_sufficient:.4g} m/N.",
        "Not covered: " + "; ".join(found.not_covered) + ".",
    ]
    return text, [Table(head, rows), Table(["gain", "given", "with a factor of two to spare"], proposed)]


def _row(name: str, c: Condition) -> list[str]:
    speed = "any" if c.largest_speed is None else f"{c.largest_speed:.4g}"
    return [name, DECIDED[c.holds], f"{c.least_K_D:.4g}", f"{c.margin:.4g}", speed]


def _along(found: Along) -> FigureSvg:
    """V, and dV/dt with its bound where it has one."""
    with plots.style():
        rows = [["V"]] if found.dV_dt is None else [["V"], ["rate"]]
        made, axes = plots.figure(rows, 2.2 * len(rows) + 0.4)
        axes["V"].plot(*plots.thin(found.t, found.V), color=plots.COLOURS[2])
        axes["V"].set(xlabel="t (s)", ylabel="V (J)", title="Lyapunov function along the simulation")
        plots.logarithmic(axes["V"], x=False)
        if found.dV_dt is not None:
            axis = axes["rate"]
            for i, (values, label) in enumerate(((found.bound, "bound (19)"), (found.dV_dt, "dV/dt"))):
                if values is not None:
                    falling = np.where(values < 0, -values, np.nan)
                    plots.line(axis, i + 1, *plots.thin(found.t, falling), label)
            axis.set(xlabel="t (s)", ylabel="-dV/dt (W)", title="how fast it falls, and the proof's bound")
            plots.logarithmic(axis, x=False)
            axis.legend(fontsize=8)
        caption = (
            "Where a line is missing V does not fall: rounding, at the level of the solver's tolerance, or a rise."
        )
        return plots.finish(made, "gains", caption, pdf=True)
