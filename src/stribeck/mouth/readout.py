"""What a page needs to read values off a drawn figure: where its panels stand, on which scales, and what their lines are.

The page's script (``page.js``) takes the curves themselves from the drawing, so that nothing is kept twice."""

from __future__ import annotations

import json
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from stribeck.errors import printable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

DPI = 72.0  # of an SVG: its unit is a point


def marked(figure: Figure) -> str:
    """An attribute ``data-axes`` that tells of every panel of a laid out figure; its lines get ids by which it names them."""
    panels = [_panel(axis, k, figure) for k, axis in enumerate(figure.axes) if axis.axison and _is_read(axis)]
    return f'data-axes="{escape(json.dumps(panels, separators=(",", ":")))}"' if panels else ""


def _is_read(axis: Axes) -> bool:
    """Not a map's key, nor on a scale that the script does not know."""
    return axis.get_label() != "<colorbar>" and {axis.get_xscale(), axis.get_yscale()} <= {"linear", "log", "asinh"}


def _panel(axis: Axes, k: int, figure: Figure) -> dict[str, object]:
    width, height = figure.get_size_inches() * DPI
    place = axis.get_position()
    box = [place.x0 * width, (1 - place.y1) * height, place.width * width, place.height * height]
    panel: dict[str, object] = {
        "box": [round(x, 2) for x in box],
        "title": _plain(axis.get_title(loc="left") or axis.get_title()),
        "x": _scale(axis.xaxis, axis.get_xlim()),
        "y": _scale(axis.yaxis, axis.get_ylim()),
        "lines": _lines(axis, k),
    }
    if (cells := _cells(axis)) is not None:
        panel["cells"] = cells
    return panel


def _lines(axis: Axes, k: int) -> list[list[str]]:
    """The id and the name of whatever has points that can be read off."""
    lines = []
    for j, drawn in enumerate((*axis.get_lines(), *axis.collections)):
        if type(drawn).__name__ not in ("Line2D", "PathCollection") or drawn.get_rasterized():
            continue
        if drawn.get_gid() is None:
            drawn.set_gid(f"line-{k}-{j}")
        label = str(drawn.get_label())
        lines.append([str(drawn.get_gid()), "" if label.startswith("_") else _plain(label)])
    return lines


def _scale(axis: Axis, limits: tuple[float, float]) -> dict[str, object]:
    """Label, kind and limits of a scale; words that stand in the place of numbers."""
    from matplotlib.ticker import FixedFormatter, FixedLocator, FuncFormatter

    scale: dict[str, object] = {"label": _plain(axis.get_label_text()), "ends": [float(f"{x:.9g}") for x in limits]}
    kind = axis.get_scale()
    if kind != "linear":
        scale["kind"] = kind
    if kind == "asinh":
        scale["width"] = float(f"{getattr(axis.get_transform(), 'linear_width', 1.0):.9g}")
    locator, formatter = axis.get_major_locator(), axis.get_major_formatter()
    if kind == "linear" and isinstance(locator, FixedLocator) and isinstance(formatter, FixedFormatter | FuncFormatter):
        places = [float(x) for x in np.asarray(locator(), float)]
        ticks = list(zip(places, map(_plain, formatter.format_ticks(places)), strict=True))
        if any(text and not text[-1:].isdigit() for _, text in ticks):
            scale["words"] = ticks
    return scale


def _cells(axis: Axes) -> dict[str, object] | None:
    """The edges and the values of a map, row by row from below."""
    from matplotlib.collections import QuadMesh

    mesh = next((drawn for drawn in axis.collections if isinstance(drawn, QuadMesh)), None)
    if mesh is None:
        return None
    corners = np.asarray(mesh.get_coordinates())
    values: list[float] = np.ma.filled(np.ma.asarray(mesh.get_array(), float), np.nan).ravel().tolist()
    edges = [[float(f"{x:.6g}") for x in side] for side in (corners[0, :, 0], corners[:, 0, 1])]
    return {"x": edges[0], "y": edges[1], "values": [float(f"{z:.4g}") if np.isfinite(z) else None for z in values]}


def _plain(text: str) -> str:
    return printable(text.replace("\\$", "$").lstrip("\u200b"))
