"""Hunting under PID control: the paper's Figs. 8 and 9."""

from __future__ import annotations

from stribeck.analysis.oscillation import amplitude_and_period
from stribeck.paper.common import REFERENCE, simulate_all
from stribeck.report import plots
from stribeck.report.page import Chapter, FigureSvg, Table

_SETTLED = 150.0  # s


def chapter() -> Chapter:
    """Position over the whole run, the first 100 s, and after the transients."""
    solutions = simulate_all("limit_cycle")
    reference = solutions[REFERENCE]
    with plots.style():
        made, axes = plots.figure([["all", "all"], ["first", "late"]], 4.8)
        for panel in ("all", "first", "late"):
            plots.draw(axes[panel], solutions, "t", "y")
            axes[panel].plot(reference.t, reference["r"], color="#888888", linewidth=0.8)
        axes["first"].set_xlim(0, 100)
        axes["first"].set_title("first 100 s")
        axes["late"].set_xlim(_SETTLED, 250)
        axes["late"].set_ylim(0.9, 1.1)
        axes["late"].set_title("after the transients")
        plots.legend(made, axes["all"])
        svg = plots.svg(made)
    rows, numbers = [], {}
    for label, solution in solutions.items():
        late = solution.t > _SETTLED
        amplitude, period = amplitude_and_period(solution.t[late], solution["y"][late])
        numbers[label] = {"amplitude": amplitude, "period": period, "overshoot": solution.peaks["y"]}
        rows.append([label, f"{amplitude:.6f}", f"{period:.2f}", f"{solution.peaks['y']:.5f}"])
    table = Table(["law", "amplitude (m)", "period (s)", "largest y (m)"], rows)
    caption = (
        "The setpoint (grey) steps by 1 m at 10 s. The controller's integral winds up while the body sticks, and the "
        "body jumps over the setpoint again and again: a limit cycle."
    )
    text = ("Friction and integral action together hunt around the setpoint.",)
    figures = [FigureSvg("fig09_limit_cycle", svg, caption)]
    return Chapter("limit_cycle", "Limit cycle under PID control", text, [table], figures, numbers)
