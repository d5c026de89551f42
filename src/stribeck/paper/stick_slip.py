"""Stick-slip of a mass pulled through a spring: the paper's Figs. 5 and 6."""

from __future__ import annotations

from stribeck.analysis.comparison import deviations
from stribeck.paper.common import REFERENCE, percent, simulate_all
from stribeck.report import plots
from stribeck.report.page import Chapter, FigureSvg, Table


def chapter() -> Chapter:
    """Position, a closer look at the last slip, velocity and friction force."""
    solutions = simulate_all("stick_slip")
    reference = solutions[REFERENCE]
    with plots.style():
        made, axes = plots.figure([["y", "detail"], ["v", "F"]], 4.8)
        plots.draw(axes["y"], solutions, "t", "y")
        axes["y"].plot(reference.t, reference["x"], color="#888888", linewidth=0.8)
        axes["y"].annotate("far end of the spring", (22, 2.2), (4, 3.2), color="#666666", fontsize=8)
        plots.draw(axes["detail"], solutions, "t", "y")
        last = float(reference.events["slip"][-2])
        axes["detail"].set_xlim(last - 0.1, last + 0.3)
        near = reference["y"][(reference.t > last - 0.1) & (reference.t < last + 0.3)]
        axes["detail"].set_ylim(near.min() - 0.002, near.max() + 0.002)
        axes["detail"].set_title("the fifth slip, closer")
        plots.draw(axes["v"], solutions, "t", "v")
        plots.draw(axes["F"], solutions, "t", "F")
        plots.legend(made, axes["v"])
        svg = plots.svg(made)
    rows, numbers = [], {}
    for label, solution in solutions.items():
        off = deviations(reference, solution)["y"]["max_relative"] or 0.0
        numbers[label] = {"y_end": solution.final["y"], "slips": len(solution.events["slip"]), "deviation_of_peak": off}
        rows.append([label, f"{len(solution.events['slip'])}", f"{solution.final['y']:.6f}", percent(off)])
    table = Table(["law", "slips", "y at 40 s (m)", "largest deviation / peak"], rows)
    caption = (
        "The far end of the spring moves at 0.1 m/s; the body stands still until the spring force passes the static "
        "friction, then jumps. The laws differ in when they let go, by an amount that does not grow chaotically."
    )
    text = ("A body on a slowly pulled spring sticks and slips.",)
    return Chapter("stick_slip", "Stick-slip", text, [table], [FigureSvg("fig06_stick_slip", svg, caption)], numbers)
