"""Pictures over several varied numbers whose lanes can be picked, and the trajectories that a picked lane shows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.report import plots
from stribeck.report.page import FigureSvg, LaneCurves
from stribeck.report.quantities import Quantity, Scale, human, prefixed, scale
from stribeck.scenario import Scenario
from stribeck.scenario.declared import declared
from stribeck.simulation import Ensemble

Lanes = tuple[NDArray[np.int64], Ensemble]  # some lanes by number, and their trajectories
_CELLS = 40_000  # of a heat map
_DRAWN = 600  # cells of a figure that are drawn each by itself; more are an image
_LINES = 400  # of a picture with parallel axes
_POINTS = 240  # of a trajectory


def logarithmic(values: Array) -> bool:
    """Whether values want a logarithmic axis."""
    return bool(values.min() > 0 and values.max() / values.min() > 30)


def whole_grid(values: Mapping[str, Array]) -> tuple[Array, Array] | None:
    """The values along both axes where two numbers vary over a whole grid, each pair once; else None."""
    if len(values) != 2:
        return None
    (x, y) = values.values()
    along, up = np.unique(x), np.unique(y)
    pairs = {(a, b) for a, b in zip(x.tolist(), y.tolist(), strict=True)}
    whole = len(pairs) == len(x) == len(along) * len(up) and min(len(along), len(up)) > 1
    return (along, up) if whole and len(x) <= _CELLS else None


def cell_lanes(values: Mapping[str, Array], found: tuple[Array, Array]) -> NDArray[np.int64]:
    """The lanes of the cells of a whole grid (:func:`whole_grid`), row by row from below."""
    i, j = (np.searchsorted(along, x) for along, x in zip(found, values.values(), strict=True))
    lanes = np.empty(len(i), np.int64)
    lanes[j * len(found[0]) + i] = np.arange(len(i))
    return lanes


def spread_lanes(values: Mapping[str, Array], found: tuple[Array, Array], most: int) -> NDArray[np.int64]:
    """The lanes of a coarser grid within a whole one (:func:`whole_grid`), so that one of them is near each cell."""
    across, up = (len(each) for each in found)
    rows = min(up, max(1, most // min(across, math.isqrt(most))))
    columns = min(across, max(1, most // rows))
    cells = cell_lanes(values, found).reshape(up, across)
    return np.sort(cells[np.ix_(evenly(up, rows), evenly(across, columns))].ravel())


def varied(scenario: Scenario, values: Mapping[str, Array]) -> list[Quantity]:
    """What varied, with units where the file's tables declare them."""
    units = {path: own.unit if (own := declared(scenario, path)) else "" for path in values}
    return [Quantity(path, units[path], "", x) for path, x in values.items()]


def axis_of(quantity: Quantity) -> Scale:
    """How an axis shows what varied: from zero, whatever the change."""
    factor, unit = prefixed(quantity.unit, float(np.max(np.abs(quantity.values))))
    return Scale(factor, 0.0, f"{quantity.name} ({unit})" if unit else quantity.name)


def heat_map(over: Sequence[Quantity], found: tuple[Array, Array], quantities: Sequence[Quantity]) -> FigureSvg:
    """A cell a lane, coloured by each measure, over the values along both axes (:func:`whole_grid`)."""
    values, scales = {q.name: q.values for q in over}, [axis_of(q) for q in over]
    (first, second), edges = values, [s.of(_edges(each)) for s, each in zip(scales, found, strict=True)]
    order = cell_lanes(values, found)
    with plots.style():
        layout = [[q.name for q in quantities[i : i + 2]] for i in range(0, len(quantities), 2)]
        if len(layout) > 1 and len(layout[-1]) == 1:
            layout[-1].append(".")
        made, axes = plots.figure(layout, 2.7 * len(layout))
        for quantity in quantities:
            axis, shown = axes[quantity.name], scale([quantity])
            z = np.ma.masked_invalid(shown.of(quantity.values)[order].reshape(len(found[1]), -1))
            axis.set_facecolor("#bbbbbb")
            axis.grid(False)
            drawn = axis.pcolormesh(*edges, z, cmap="viridis", rasterized=len(order) * len(quantities) > _DRAWN)
            axis.set(xlabel=scales[0].label, ylabel=scales[1].label, title=shown.label)
            for log, name in ((logarithmic(found[0]), "x"), (logarithmic(found[1]), "y")):
                if log:
                    getattr(axis, f"set_{name}scale")("log")
            made.colorbar(drawn, ax=axis)
        caption = f"What came of each lane over {first} and {second}; grey: nothing to show. A click on a cell shows its lane."
        return plots.finish(made, "map", caption, pdf=True)


def _edges(centres: Array) -> Array:
    """The ends of the cells around some values, halfway on the axis that they want."""
    at = np.log(centres) if logarithmic(centres) else centres
    between = 0.5 * (at[1:] + at[:-1])
    found = np.concatenate([[2 * at[0] - between[0]], between, [2 * at[-1] - between[-1]]])
    return np.exp(found) if logarithmic(centres) else found


def evenly(count: int, most: int) -> NDArray[np.int64]:
    """So many of the numbers below ``count``, or all: evenly from the first to the last."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def drawn_lanes(count: int) -> NDArray[np.int64]:
    """The lanes that parallel axes show."""
    return evenly(count, _LINES)


def parallel_axes(over: Sequence[Quantity], quantities: Sequence[Quantity]) -> FigureSvg:
    """An axis for each varied number and each measure, and a line a lane, coloured by the first measure."""
    from matplotlib import colormaps

    columns = {axis_of(q).label: axis_of(q).of(q.values) for q in over}
    columns |= {scale([q]).label: scale([q]).of(q.values) for q in quantities}
    count = len(over[0].values)
    lanes = drawn_lanes(count)
    heights = {name: _height(x) for name, x in columns.items()}
    colour = heights[scale([quantities[0]]).label]
    with plots.style():
        made, axes = plots.figure([["all"]], 3.6)
        axis = axes["all"]
        for lane in lanes:
            line = [heights[name][lane] for name in columns]
            shade = colormaps["viridis"](colour[lane]) if np.isfinite(colour[lane]) else "#bbbbbb"
            axis.plot(range(len(line)), line, color=shade, linewidth=1.1, alpha=0.75, gid=f"lane-{lane}")
        for i, (name, x) in enumerate(columns.items()):
            axis.axvline(i, color="0.4", linewidth=0.8)
            for height, value, side in ((1.03, np.nanmax(x), "bottom"), (-0.03, np.nanmin(x), "top")):
                axis.text(i, height, f"{value:.4g}", ha="center", va=side, fontsize=7)
            axis.text(i, -0.13, name, ha="center", va="top", fontsize=7, rotation=0, wrap=True)
        axis.set(xlim=(-0.4, len(columns) - 0.6), ylim=(-0.3, 1.1))
        axis.axis("off")
        more = f" {len(lanes)} of {count} lanes." if len(lanes) < count else ""
        caption = (
            f"Each line is a lane, from what varied (left) to what came of it.{more} A click on a line shows its lane."
        )
        return plots.finish(made, "axes", caption, pdf=True)


def _height(x: Array) -> Array:
    """From 0 at the least value to 1 at the largest, on the axis that they want."""
    finite = x[np.isfinite(x)]
    at = np.log(x) if len(finite) and logarithmic(finite) else np.asarray(x, float)
    low, high = (np.nanmin(at), np.nanmax(at)) if len(finite) else (0.0, 0.0)
    return (at - low) / (high - low) if high > low else np.where(np.isfinite(at), 0.5, np.nan)


def picked(kept: Sequence[Lanes], names: Sequence[str]) -> LaneCurves:
    """The trajectories of some lanes, thinned, for the page."""
    _, first = kept[0]
    pick = evenly(len(first.t), _POINTS)
    units = {c.name: c.unit for c in first.columns}
    scales = {name: scale([Quantity(name, units[name], "", e[name]) for _, e in kept]) for name in names}
    curves = {
        int(lane): [[_brief(x) for x in scales[name].of(found[name][i, pick])] for name in names]
        for lanes, found in kept
        for i, lane in enumerate(lanes)
    }
    return LaneCurves([_brief(t) for t in first.t[pick]], [scales[name].label for name in names], curves, {})


def lane_words(over: Sequence[Quantity], quantities: Sequence[Quantity], lanes: NDArray[np.int64]) -> dict[int, str]:
    """What some lanes are, and what came of them, in words."""
    found = {}
    for lane in lanes.tolist():
        came = [f"{q.name} {human(float(q.values[lane]), q.unit)}" for q in quantities if np.isfinite(q.values[lane])]
        given = ", ".join(f"{q.name} = {q.values[lane]:.6g} {q.unit}".rstrip() for q in over)
        found[lane] = f"{given}: {', '.join(came)}" if came else given
    return found


def _brief(x: float) -> float | None:
    return float(f"{x:.5g}") if np.isfinite(x) else None
