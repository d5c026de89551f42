"""Presliding displacement: the paper's Fig. 4."""

from __future__ import annotations

import numpy as np

from stribeck.analysis.comparison import deviations
from stribeck.paper.common import REFERENCE, percent, simulate_all
from stribeck.report import plots
from stribeck.report.page import Chapter, FigureSvg, Table

_INSTANTS = (10.0, 15.0, 35.0, 40.0)  # s: the ends of the ramps and of the holds


def chapter() -> Chapter:
    """Friction against displacement under a force below F_s, and the displacement at four instants."""
    solutions = simulate_all("presliding")
    with plots.style():
        made, axes = plots.figure([["Fy", "yt"]], 3.2)
        plots.draw(axes["Fy"], solutions, "y", "F")
        plots.draw(axes["yt"], solutions, "t", "y")
        plots.legend(made, axes["Fy"])
        svg = plots.svg(made)
    at = {label: [float(np.interp(t, s.t, s["y"])) for t in _INSTANTS] for label, s in solutions.items()}
    off = {label: deviations(solutions[REFERENCE], s)["y"]["max_relative"] or 0.0 for label, s in solutions.items()}
    rows = [[label, *(f"{1e6 * y:.2f}" for y in at[label]), percent(off[label])] for label in solutions]
    table = Table(["y (um) at t =", *(f"{t:g} s" for t in _INSTANTS), "largest deviation / peak"], rows)
    caption = (
        "Friction force against displacement (left) and displacement against time (right) while the force is ramped to "
        "0.95 F_s, held, reversed, held and released. During a hold LuGre comes to rest; the continuous versions creep."
    )
    text = (
        "A force that stays below the static friction moves the body by the deflection of the bristles alone. This is "
        "where a smooth |v| costs most, since all speeds are small.",
    )
    numbers = {"instants": _INSTANTS, "y": at, "deviation_of_peak": off}
    return Chapter(
        "presliding", "Presliding displacement", text, [table], [FigureSvg("fig04_presliding", svg, caption)], numbers
    )
