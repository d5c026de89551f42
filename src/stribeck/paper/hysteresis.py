"""Friction lag at a prescribed velocity."""

from __future__ import annotations

import numpy as np

from stribeck.paper.common import REFERENCE, percent, simulate_all
from stribeck.report import plots
from stribeck.report.page import Chapter, FigureSvg, Table


def chapter() -> Chapter:
    """The friction force against a velocity that swings around the Stribeck velocity."""
    solutions = simulate_all("hysteresis")
    reference = solutions[REFERENCE]
    law = reference.scenario.law
    with plots.style():
        made, axes = plots.figure([["Fv", "Ft"]], 3.2)
        plots.draw(axes["Fv"], solutions, "v", "F")
        v = np.linspace(reference["v"].min(), reference["v"].max(), 200)
        axes["Fv"].plot(v, law.steady_force(v), color="#888888", linewidth=0.8)
        plots.draw(axes["Ft"], solutions, "t", "F")
        plots.legend(made, axes["Ft"])
        svg = plots.svg(made)
    rows, numbers = [], {}
    for label, solution in solutions.items():
        later = solution.t > 0.5
        off = float(np.max(np.abs(solution["F"] - reference["F"])[later]) / np.max(np.abs(reference["F"])))
        numbers[label] = {"F_peak": float(solution["F"][later].max()), "deviation_of_peak": off}
        rows.append([label, f"{numbers[label]['F_peak']:.5f}", percent(off)])
    table = Table(["law", "largest F after 0.5 s (N)", "deviation of F / peak"], rows)
    caption = (
        "The friction force lags behind the steady curve (grey): a loop, wider for faster changes of the velocity."
    )
    text = ("At a prescribed velocity the friction force depends on the past: it is larger while the body speeds up.",)
    figures = [FigureSvg("hysteresis", svg, caption)]
    return Chapter("hysteresis", "Hysteresis at a prescribed velocity", text, [table], figures, numbers)
