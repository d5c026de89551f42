"""Hunting under PID control: the paper's Figs. 8 and 9."""

from __future__ import annotations

from examples.paper import sketches
from examples.paper.common import PROPOSED, REFERENCE, Chapter, Done, finish, record, solve_all
from stribeck.loops.oscillation import amplitude_and_period
from stribeck.mouth import plots
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Table
from stribeck.simulation.comparison import deviations
from stribeck.simulation.drawing import curves

SETTLED = 150.0  # s


def chapter(done: Done) -> Chapter:
    """Position over the whole run, the first 100 s, and after the transients."""
    solutions = solve_all("limit_cycle")
    reference = solutions[REFERENCE]
    with plots.style():
        built, axes = plots.figure([["all", "all"], ["first", "late"]], 5.2)
        for panel in ("all", "first", "late"):
            _, of_y = curves(axes[panel], solutions, "t", "y")
            axes[panel].plot(reference.t, of_y.of(reference["r"]), color=plots.GRAY, linewidth=0.8)
        axes["all"].set_title("(a) complete simulation (setpoint in gray)")
        axes["first"].set_xlim(0, 100)
        axes["first"].set_title("(b) first 100 s")
        axes["late"].set_xlim(SETTLED, 250)
        axes["late"].set_ylim(0.9 / of_y.factor, 1.1 / of_y.factor)
        axes["late"].set_title("(c) after the transients")
        plots.legend(built, axes["all"])
        figure = finish(
            built, "fig09_limit_cycle",
            "The setpoint steps by 1 m at 10 s. The controller's integral winds up while the body sticks, and the body "
            "jumps over the setpoint again and again: a limit cycle.",
        )  # fmt: skip
    cycles = {}
    for label, s in solutions.items():
        late = s.t > SETTLED
        amplitude, period = amplitude_and_period(s.t[late], s["y"][late])
        cycles[label] = float(amplitude), float(period)
    off = {label: deviations(reference, solutions[label])["y"]["max_relative"] for label in PROPOSED}
    rows = [
        [label, f"{a:.6f}", f"{period:.2f}", f"{solutions[label].peaks['y']:.5f}", percent(off.get(label))]
        for label, (a, period) in cycles.items()
    ]
    table = Table(["law", "amplitude (m)", "period (s)", "largest y (m)", "largest deviation / peak"], rows)
    numbers = {
        "amplitude": {label: a for label, (a, _) in cycles.items()},
        "period": {label: period for label, (_, period) in cycles.items()},
        "overshoot": {label: s.peaks["y"] for label, s in solutions.items()},
        "deviation_of_peak": off,
    }
    text = (
        "Friction and integral action together hunt around the setpoint: K_p = 3 N/m, K_i = 4 N/(m s), K_d = 6 N s/m.",
    )
    return Chapter(
        "limit_cycle",
        "Limit cycles under PID control",
        text,
        [table],
        [sketches.pid(), figure],
        numbers,
        record(solutions),
    )
