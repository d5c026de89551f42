"""Stick-slip of a mass pulled through a spring: the paper's Figs. 5 and 6."""

from __future__ import annotations

from examples.paper import sketches
from examples.paper.common import PROPOSED, REFERENCE, Chapter, Done, finish, record, solve_all
from stribeck.mouth import plots
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Table
from stribeck.simulation.comparison import deviations
from stribeck.simulation.drawing import curves


def chapter(done: Done) -> Chapter:
    """Position over the whole run and closer; velocity and friction force beside them."""
    solutions = solve_all("stick_slip")
    reference = solutions[REFERENCE]
    with plots.style():
        built, axes = plots.figure([["y", "detail"], ["v", "F"]], 5.4)
        _, of_y = curves(axes["y"], solutions, "t", "y")
        axes["y"].plot(reference.t, of_y.of(reference["x"]), color=plots.GRAY, linewidth=0.8)
        axes["y"].annotate("far end x", (14, 2.6 / of_y.factor), color=plots.GRAY, fontsize=8)
        axes["y"].set_title("(a) complete simulation")
        curves(axes["detail"], solutions, "t", "y")
        last = float(reference.events["slip"][-2])
        near = (reference.t > last - 0.6) & (reference.t < last + 0.7)
        axes["detail"].set_xlim(last - 0.6, last + 0.7)
        low, high = reference["y"][near].min() - 0.02, reference["y"][near].max() + 0.05
        axes["detail"].set_ylim(low / of_y.factor, high / of_y.factor)
        axes["detail"].set_title("(b) detail: the fifth slip")
        curves(axes["v"], solutions, "t", "v")
        curves(axes["F"], solutions, "t", "F")
        plots.legend(built, axes["y"])
        figure = finish(
            built, "fig06_stick_slip",
            "The far end of the spring moves at 0.1 m/s. The body stands still until the spring force passes the static "
            "friction, then jumps; the slower its law lets go, the later. Deviations do not grow chaotically.",
        )  # fmt: skip
    off = {label: deviations(reference, solutions[label])["y"] for label in PROPOSED}
    rows = [
        [
            label, f"{len(s.events['slip'])}", f"{s.final['y']:.6f}",
            f"{off[label]['max']:.3e}" if label in off else "-",
            percent(off[label]["max_relative"]) if label in off else "-",
        ]
        for label, s in solutions.items()
    ]  # fmt: skip
    table = Table(["law", "slips", "y at 40 s (m)", "largest deviation (m)", "of the peak"], rows)
    numbers = {
        "y_end": {label: s.final["y"] for label, s in solutions.items()},
        "slips": {label: s.events["slip"].tolist() for label, s in solutions.items()},
        "deviation": {label: each["max"] for label, each in off.items()},
        "deviation_of_peak": {label: each["max_relative"] for label, each in off.items()},
    }
    text = ("A body on a slowly pulled spring sticks and slips: mass 1 kg, spring 2 N/m.",)
    return Chapter(
        "stick_slip", "Stick-slip motion", text, [table], [sketches.spring(), figure], numbers, record(solutions)
    )
