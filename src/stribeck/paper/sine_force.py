"""A slow sinusoidal force just above F_s: the paper's Fig. 7."""

from __future__ import annotations

from stribeck.analysis.comparison import deviations
from stribeck.paper.common import REFERENCE, percent, simulate_all
from stribeck.report import plots
from stribeck.report.page import Chapter, FigureSvg, Table


def chapter() -> Chapter:
    """Friction force and velocity under a force of 1.1 F_s at 0.25 Hz."""
    solutions = simulate_all("sine_force")
    reference = solutions[REFERENCE]
    with plots.style():
        made, axes = plots.figure([["F", "v"]], 3.2)
        plots.draw(axes["F"], solutions, "t", "F")
        axes["F"].plot(reference.t, reference["u"], color="#888888", linewidth=0.8)
        plots.draw(axes["v"], solutions, "t", "v")
        plots.legend(made, axes["v"])
        svg = plots.svg(made)
    rows, numbers = [], {}
    for label, solution in solutions.items():
        off = deviations(reference, solution)
        numbers[label] = {name: off[name]["max_relative"] for name in ("v", "F")}
        numbers[label] |= {"F_peak": solution.peaks["F"], "v_peak": solution.peaks["v"]}
        rows.append(
            [
                label,
                f"{solution.peaks['F']:.4f}",
                f"{solution.peaks['v']:.5f}",
                percent(off["v"]["max_relative"] or 0.0),
            ]
        )
    table = Table(["law", "peak F (N)", "peak v (m/s)", "deviation of v / peak"], rows)
    caption = (
        "Friction follows the applied force (grey) until F_s is reached, falls to F_c, and the body moves in the "
        "direction of the force until it sticks again."
    )
    text = ("The body must stay where it is while the force is below the static friction, and move above it.",)
    figures = [FigureSvg("fig07_sine_force", svg, caption)]
    return Chapter("sine_force", "A sinusoidal force above F_s", text, [table], figures, numbers)
