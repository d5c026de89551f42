"""The paper's two sketches, drawn: Figs. 5 and 8."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from examples.paper.common import Printed, finish
from stribeck.mouth import plots

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_ARROW = {"arrowstyle": "-|>", "color": "black", "lw": 1.0, "shrinkA": 0, "shrinkB": 0}


def _arrow(axis: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    axis.annotate("", end, start, arrowprops=_ARROW)


def _box(axis: Axes, x: float, y: float, width: float, height: float, text: str) -> None:
    from matplotlib.patches import Rectangle

    axis.add_patch(Rectangle((x, y - height / 2), width, height, facecolor="white", edgecolor="black", linewidth=1.1))
    axis.text(x + width / 2, y, text, ha="center", va="center", fontsize=8.5)


def _empty(height: float, x: tuple[float, float], y: tuple[float, float]) -> tuple[Figure, Axes]:
    built, axes = plots.figure([["sketch"]], height)
    axis = axes["sketch"]
    axis.set(xlim=x, ylim=y, aspect="equal")
    axis.axis("off")
    return built, axis


def spring() -> Printed:
    """A body on a surface, pulled through a spring."""
    with plots.style():
        built, axis = _empty(1.7, (0, 12), (0, 2.6))
        axis.plot([0.4, 11.6], [0.5, 0.5], color="black", linewidth=1.1)
        for x in np.arange(0.6, 11.6, 0.35):
            axis.plot([x, x - 0.2], [0.5, 0.28], color="black", linewidth=0.6)
        _box(axis, 2.0, 1.1, 2.2, 1.2, "m")
        coil = np.linspace(0, 1, 400)
        wave = 0.22 * np.sin(2 * np.pi * 7 * coil) * ((coil > 0.08) & (coil < 0.92))
        axis.plot(4.2 + 4.0 * coil, 1.1 + wave, color="black", linewidth=1.1)
        axis.text(6.2, 1.55, "k", ha="center")
        _arrow(axis, (8.2, 1.1), (9.6, 1.1))
        axis.text(9.75, 1.1, "x = 0.1 m/s t", va="center")
        axis.plot([3.1, 3.1], [1.8, 2.3], color="black", linewidth=0.8)
        _arrow(axis, (3.1, 2.15), (4.2, 2.15))
        axis.text(4.35, 2.15, "y", va="center")
        _arrow(axis, (1.9, 0.72), (0.9, 0.72))
        axis.text(0.85, 0.95, "F", ha="center")
        caption = "Physical set-up for stick-slip motion: m = 1 kg, k = 2 N/m, friction F between body and surface."
        return finish(built, "fig05_spring", caption)


def pid() -> Printed:
    """The PID loop around the body with friction."""
    from matplotlib.patches import Circle

    with plots.style():
        built, axis = _empty(2.3, (0, 14), (0.3, 4.1))
        for x, y in ((1.6, 2.6), (7.2, 2.6), (9.0, 2.6)):
            axis.add_patch(Circle((x, y), 0.22, facecolor="white", edgecolor="black", linewidth=1.1))
        _arrow(axis, (0.4, 2.6), (1.38, 2.6))
        axis.text(0.45, 2.8, "r")
        _arrow(axis, (1.82, 2.6), (2.9, 2.6))
        _box(axis, 2.9, 2.6, 2.6, 0.9, "K_p + K_i / s")
        _arrow(axis, (5.5, 2.6), (6.98, 2.6))
        _arrow(axis, (7.42, 2.6), (8.78, 2.6))
        axis.text(8.0, 2.8, "u")
        _arrow(axis, (9.22, 2.6), (9.9, 2.6))
        _box(axis, 9.9, 2.6, 1.4, 0.9, "1 / (m s)")
        _arrow(axis, (11.3, 2.6), (12.1, 2.6))
        axis.text(11.5, 2.8, "v")
        _box(axis, 12.1, 2.6, 0.9, 0.9, "1 / s")
        _arrow(axis, (13.0, 2.6), (13.9, 2.6))
        axis.text(13.5, 2.8, "y")
        _box(axis, 9.3, 3.6, 1.6, 0.6, "friction")
        axis.plot([11.7, 11.7, 10.9], [2.6, 3.6, 3.6], color="black", linewidth=1.0)
        axis.plot([9.3, 9.0], [3.6, 3.6], color="black", linewidth=1.0)
        _arrow(axis, (9.0, 3.6), (9.0, 2.82))
        axis.text(8.65, 3.1, "F")
        _box(axis, 8.4, 1.5, 1.2, 0.7, "K_d")
        axis.plot([11.7, 11.7, 9.6], [2.6, 1.5, 1.5], color="black", linewidth=1.0)
        axis.plot([8.4, 7.2], [1.5, 1.5], color="black", linewidth=1.0)
        _arrow(axis, (7.2, 1.5), (7.2, 2.38))
        axis.plot([13.4, 13.4, 1.6], [2.6, 0.6, 0.6], color="black", linewidth=1.0)
        _arrow(axis, (1.6, 0.6), (1.6, 2.38))
        for x, y in ((1.75, 2.1), (7.35, 2.1), (9.2, 2.95)):
            axis.text(x, y, "-", fontsize=11)
        caption = "PID position control of a body with friction; the derivative acts on the measured velocity."
        return finish(built, "fig08_pid_loop", caption)
