"""A slow sinusoidal force just above F_s: the paper's Fig. 7."""

from __future__ import annotations

from examples.paper.common import PROPOSED, REFERENCE, Chapter, Done, finish, record, scenario, solve, solve_all
from stribeck.mouth import plots
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Table
from stribeck.simulation.comparison import deviations
from stribeck.simulation.drawing import curves


def chapter(done: Done) -> Chapter:
    """Friction force and velocity under a force of 1.1 F_s at 0.25 Hz, and the velocity with viscous friction alone."""
    solutions = solve_all("sine_force")
    reference = solutions[REFERENCE]
    sigma_2 = reference.scenario.law.values["sigma_2"] or 0.0
    # the law of Makkar et al. without its first five terms is viscous friction
    viscous_law = {"g1": 0.0, "g2": 1.0, "g3": 0.0, "g4": 0.0, "g5": 1.0, "g6": sigma_2}
    viscous = solve(scenario("sine_force", ("makkar", viscous_law)), "viscous friction")
    with plots.style():
        built, axes = plots.figure([["F"], ["v"]], 5.0)
        _, of_F = curves(axes["F"], solutions, "t", "F")
        axes["F"].plot(reference.t, of_F.of(reference["u"]), color=plots.GRAY, linewidth=0.8)
        axes["F"].annotate("applied force", (1.45, 1.45 / of_F.factor), color=plots.GRAY, fontsize=8)
        axes["F"].set_title("(a) friction force")
        _, of_v = curves(axes["v"], solutions, "t", "v")
        axes["v"].plot(viscous.t, of_v.of(viscous["v"]), color=plots.GRAY, linewidth=1.0)
        axes["v"].annotate("viscous friction alone", (2.6, 1.25 / of_v.factor), color=plots.GRAY, fontsize=8)
        axes["v"].set_title("(b) velocity")
        plots.legend(built, axes["F"])
        figure = finish(
            built, "fig07_sine_force",
            "Friction follows the applied force (gray) until F_s is reached, falls to F_c, and the body moves in the "
            f"direction of the force until it sticks again. With viscous friction alone (b, gray) the body never rests and "
            f"reaches {viscous.peaks['v']:.3f} m/s where LuGre reaches {reference.peaks['v']:.3f} m/s.",
        )  # fmt: skip
    off = {label: deviations(reference, solutions[label]) for label in PROPOSED}
    rows = [
        [
            label,
            f"{s.peaks['F']:.4f}",
            f"{s.peaks['v']:.5f}",
            percent(off[label]["v"]["max_relative"]) if label in off else "-",
        ]
        for label, s in solutions.items()
    ]
    table = Table(["law", "peak F (N)", "peak v (m/s)", "largest deviation of v / peak"], rows)
    numbers = {
        "v_peak": {label: s.peaks["v"] for label, s in solutions.items()}
        | {"viscous friction alone": viscous.peaks["v"]},
        "F_peak": {label: s.peaks["F"] for label, s in solutions.items()},
        "deviation_of_peak_v": {label: each["v"]["max_relative"] for label, each in off.items()},
    }
    text = ("The body must stay where it is while the force is below the static friction, and move above it.",)
    return Chapter(
        "sine_force", "A sinusoidal force just above F_s", text, [table], [figure], numbers, record(solutions)
    )
