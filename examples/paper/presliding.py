"""Presliding displacement: the paper's Fig. 4."""

from __future__ import annotations

import numpy as np

from examples.paper.common import PROPOSED, REFERENCE, Chapter, Done, finish, record, solve_all
from stribeck.mouth import plots
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Table
from stribeck.simulation.comparison import deviations
from stribeck.simulation.drawing import curves

_INSTANTS = (10.0, 15.0, 35.0, 40.0)  # s: the ends of the ramps and of the holds


def chapter(done: Done) -> Chapter:
    """Friction against displacement under a force below F_s, and the displacement at four instants."""
    solutions = solve_all("presliding")
    at = {label: [float(np.interp(t, s.t, s["y"])) for t in _INSTANTS] for label, s in solutions.items()}
    off = {label: deviations(solutions[REFERENCE], solutions[label])["y"]["max_relative"] or 0.0 for label in PROPOSED}
    # over the last second of the first hold, when what is elastic has settled
    held = {label: float(np.interp(15.0, s.t, s["y"]) - np.interp(14.0, s.t, s["y"])) for label, s in solutions.items()}
    with plots.style():
        built, axes = plots.figure([["F_y", "y_t"]], 3.3)
        curves(axes["F_y"], solutions, "y", "F")
        curves(axes["y_t"], solutions, "t", "y")
        plots.legend(built, axes["F_y"])
        figure = finish(
            built, "fig04_presliding",
            "Friction force against displacement (left, the paper's panel) and displacement against time (right) while the "
            "force is ramped to 0.95 F_s, held for 5 s, reversed, held and released. LuGre comes to rest during a hold; the "
            f"proposed law creeps, by {1e6 * held[PROPOSED[0]]:.2f}, {1e6 * held[PROPOSED[1]]:.2f} and "
            f"{1e6 * held[PROPOSED[2]]:.2f} µm/s, so its deviation grows for as long as the force is held.",
        )  # fmt: skip
    rows = [[label, *(f"{1e6 * y:.2f}" for y in at[label]), percent(off.get(label))] for label in solutions]
    table = Table(["y (µm) at t =", *(f"{t:g} s" for t in _INSTANTS), "largest deviation / peak"], rows)
    text = (
        "A force that stays below the static friction moves the body by the deflection of the bristles alone. All speeds are "
        "small here, so this is where a smooth |v| costs most.",
    )
    numbers = {"instants": _INSTANTS, "y": at, "deviation_of_peak": off, "creep": held}
    return Chapter("presliding", "Presliding displacement", text, [table], [figure], numbers, record(solutions))
