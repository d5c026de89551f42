"""The page and the plots of a sweep, from its parts: what came of each lane against what varied."""

from __future__ import annotations

import shutil
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.report import chapters, plots
from stribeck.report.cells import digits
from stribeck.report.files import write_figure
from stribeck.report.page import Chapter, FigureSvg, LaneCurves, Table
from stribeck.report.quantities import Quantity, human, prefixed, scale
from stribeck.scenario import Scenario
from stribeck.simulation import Ensemble, simulate_ensemble
from stribeck.sweeps import tables as tables_of
from stribeck.sweeps.job import Sweep
from stribeck.sweeps.maps import (
    Lanes,
    axis_of,
    cell_lanes,
    drawn_lanes,
    evenly,
    heat_map,
    lane_words,
    logarithmic,
    parallel_axes,
    picked,
    spread_lanes,
    varied,
    whole_grid,
)  # fmt: skip
from stribeck.sweeps.places import Folder, fetched

Rows = Mapping[str, NDArray[Any]]  # what came of the lanes, by column
FOLDER = "_report"  # readers of a folder of parts pass over names that begin with an underscore
_MEASURES = ("amplitude", "period", "slips")
_LANES_SHOWN = 8
_ROWS_SHOWN = 60
_PICKED = 100  # lanes whose trajectories the page keeps, at most
_ROOM = 2_000_000  # rows of these
_PATIENCE = 20.0  # s that simulating them may take
_DOTS = 2000  # of a figure that are drawn each by itself; more are an image
_MOST = 200_000  # lanes in a plot: more show nothing new


def _columns(scenario: Scenario) -> tuple[str, str, str]:
    """Position, velocity and force that are shown: of a machine, those of its first body, contact or link."""
    names = [column.name for column in scenario.system.columns]
    last = [name.rpartition(".")[2] for name in names]
    force = next((names[last.index(f)] for f in ("F", "f") if f in last), names[1])
    return names[0], names[1], force


def _measured(scenario: Scenario) -> tuple[str, ...]:
    position, _, force = _columns(scenario)
    return (f"peak_{force}", f"final_{position}", *_MEASURES)


def write_sweep_page(sweep: Sweep, command: str = "") -> list[str]:
    """Write the plots and report.html into the folder ``_report`` of a sweep; where they are."""
    if isinstance(sweep.place, Folder):
        return list(map(str, _write(sweep, sweep.place.folder / FOLDER, command)))
    names = []
    with tempfile.TemporaryDirectory() as made:
        for path in _write(sweep, Path(made) / FOLDER, command):
            names.append(f"{FOLDER}/{path.name}")
            sweep.place.put(names[-1], partial(shutil.copyfile, path))
    return [f"{sweep.place}/{name}" for name in names]


def _write(sweep: Sweep, folder: Path, command: str) -> list[Path]:
    figures: list[FigureSvg] = []
    tables: list[Table] = []
    text = [f"{len(sweep.lanes)} lanes; what varied: {', '.join(sweep.lanes.values)}."]
    kept = _kept(sweep)
    rows = _read(sweep) if sweep.summary else _measured_here(sweep, kept)
    quantities = [_quantity(sweep, rows, name) for name in _shown(sweep, rows)]
    over = _over_several(sweep, quantities)
    if rows:
        figures = [_measures(sweep, rows)]
        tables = [_table(sweep, rows)]
        if len(sweep.lanes) > _ROWS_SHOWN:
            text.append(f"The first {_ROWS_SHOWN} lanes; the files have all of them.")
    figures.append(_lanes(sweep, *kept[0]))
    folder.mkdir(exist_ok=True)
    paths = [path for figure in (*over, *figures) for path in write_figure(figure, folder)]
    trajectories = _picked(sweep, kept, quantities)
    found = [Chapter("pick", "Pick a lane", text[:1], figures=over, picked=trajectories), *chapters.plots(figures)]
    found.append(Chapter("lanes", "The lanes", text[1:], tables))
    scenario = sweep.lanes.scenario
    found += [*chapters.of_laws(scenario), chapters.of_scenario(scenario)]
    introduction = [
        _in_short(len(sweep.lanes), quantities),
        "Files of numbers: part-*" + (".csv" if sweep.as_csv else ".parquet") + " beside this folder.",
    ]
    return [*paths, chapters.write_page(folder, f"{scenario.name}: a sweep", introduction, found, command)]


def _in_short(count: int, quantities: Sequence[Quantity]) -> str:
    """What came of all lanes, in one line and in units that a person would use."""
    told = []
    for q in quantities:
        low, high = float(np.nanmin(q.values)), float(np.nanmax(q.values))
        unit = prefixed(q.unit, abs(high))[1]
        first = human(low, q.unit).removesuffix(f" {unit}") if low else "0"  # one unit where both have the same
        told.append(f"{q.name} {first} to {human(high, q.unit)}")
    return f"{count} lanes: {', '.join(told)}." if told else f"{count} lanes."


def _picked(sweep: Sweep, kept: Sequence[Lanes], quantities: Sequence[Quantity]) -> LaneCurves:
    """What the page keeps of lanes, and says of these and of those that are lines or cells."""
    values, names = sweep.lanes.values, list(dict.fromkeys(_columns(sweep.lanes.scenario)))
    found, grid = picked(kept, names), whole_grid(values)
    if len(values) > 1 and grid is None:
        lanes = np.union1d(drawn_lanes(len(sweep.lanes)), list(found.curves))
    else:
        lanes = np.array(sorted(found.curves))
    order = cell_lanes(values, grid).tolist() if grid is not None else []
    return replace(found, about=lane_words(varied(sweep.lanes.scenario, values), quantities, lanes), cells=order)


def _kept(sweep: Sweep) -> list[Lanes]:
    """Lanes whose trajectories the page keeps, simulated once more: few from the first to the last, and the others of a
    small sweep, or more of a large one (of a grid, along both axes), unless a lane takes long."""
    most = max(_LANES_SHOWN, min(_PICKED, _ROOM // sweep.lanes.scenario.rows))
    grid = whole_grid(sweep.lanes.values)
    wanted = evenly(len(sweep.lanes), most) if grid is None else spread_lanes(sweep.lanes.values, grid, most)
    few = wanted[evenly(len(wanted), _LANES_SHOWN)]
    begun = time.monotonic()
    kept = [_again(sweep, few)]
    each = (time.monotonic() - begun) / len(few)
    more = np.setdiff1d(wanted, few)
    return [*kept, _again(sweep, more)] if len(more) and each * len(more) < _PATIENCE else kept


def _again(sweep: Sweep, lanes: NDArray[np.int64]) -> Lanes:
    return lanes, simulate_ensemble(sweep.lanes.scenario, {path: x[lanes] for path, x in sweep.lanes.values.items()})


def _measured_here(sweep: Sweep, kept: Sequence[Lanes]) -> Rows:
    """The measures of all lanes from those that were simulated again; none where these are but some."""
    if sum(len(lanes) for lanes, _ in kept) < len(sweep.lanes):
        return {}
    order = np.argsort(np.concatenate([lanes for lanes, _ in kept]))
    tables = [{name: x for name, _, _, x in tables_of.summary(found, 0)} for _, found in kept]
    measured = {
        name: np.concatenate([table[name] for table in tables])[order]
        for name in (*sweep.lanes.values, *_measured(sweep.lanes.scenario))
        if name in tables[0]
    }
    return {"lane": np.arange(len(order)), **measured}


def _over_several(sweep: Sweep, quantities: Sequence[Quantity]) -> list[FigureSvg]:
    """A heat map over two numbers, or parallel axes of more."""
    values = dict(sweep.lanes.values)
    often = [q for q in quantities if np.isfinite(q.values).mean() > 0.5]
    beyond = any(np.isnan(plots.drawable(x)).any() for x in values.values())  # an axis cannot have them
    if not often or len(values) < 2 or beyond:
        return []
    found, over = whole_grid(values), varied(sweep.lanes.scenario, values)
    return [parallel_axes(over, often) if found is None else heat_map(over, found, often)]


def _shown(sweep: Sweep, rows: Rows) -> list[str]:
    return [name for name in _measured(sweep.lanes.scenario) if name in rows and np.isfinite(rows[name]).any()]


def _quantity(sweep: Sweep, rows: Rows, measure: str) -> Quantity:
    columns = {c.name: c for c in sweep.lanes.scenario.system.columns}
    column = columns.get(measure.partition("_")[2])
    if measure == "amplitude":
        column = columns[_columns(sweep.lanes.scenario)[0]]
    unit = column.of_motion(sweep.lanes.scenario.rotary).unit if column else _UNITS.get(measure, "")
    return Quantity(_WORDS.get(measure, measure), unit, "", rows[measure].astype(float))


def _read(sweep: Sweep) -> Rows:
    """The rows of the lanes, of the files in order."""
    from stribeck.recorded import opened

    wanted = ("lane", *sweep.lanes.values, *_measured(sweep.lanes.scenario))
    found: dict[str, list[Array]] = {name: [] for name in wanted}
    for part in range(sweep.parts):
        with fetched(sweep.place, sweep.name(part)) as path:
            source = opened(path)
            columns = source.columns({name: name for name in wanted if name in source.names})
        for name, values in columns.items():
            found[name].append(values)
    return {name: np.concatenate(parts) for name, parts in found.items() if parts}


def _table(sweep: Sweep, rows: Rows) -> Table:
    names = [name for name in rows if name != "lane"]
    count = min(len(sweep.lanes), _ROWS_SHOWN)
    body = [[str(i), *(digits(float(rows[name][i])) for name in names)] for i in range(count)]
    return Table(["lane", *names], body)


def _measures(sweep: Sweep, rows: Rows) -> FigureSvg:
    """A panel for each measure and path: the measure against the path, other paths by colour."""
    paths = list(sweep.lanes.values)
    of_path = {q.name: axis_of(q) for q in varied(sweep.lanes.scenario, sweep.lanes.values)}
    measures = _shown(sweep, rows)
    pick = np.arange(len(sweep.lanes))[:: max(1, len(sweep.lanes) // _MOST)]
    layout = [[f"{m}|{p}" for p in paths[:3]] for m in measures]
    with plots.style():
        made, axes = plots.figure(layout, 2.0 * len(layout) + 0.3)
        for key, axis in axes.items():
            measure, path = key.split("|")
            of_y = scale([_quantity(sweep, rows, measure)])
            x = plots.drawable(of_path[path].of(rows[path][pick]))
            y = plots.drawable(of_y.of(rows[measure][pick].astype(float)))
            other = next((p for p in paths if p != path), None)
            if other is None:
                order = np.argsort(x)
                dense = len(pick) * len(axes) > _DOTS
                axis.plot(x[order], y[order], "-" if dense else "o-", color=plots.COLOURS[2], markersize=3)
            else:
                values = plots.drawable(of_path[other].of(rows[other][pick]))
                dots = axis.scatter(
                    x, y, c=values, s=9, cmap="viridis", norm="log" if logarithmic(values) else None,
                    rasterized=len(pick) * len(axes) > _DOTS,
                )  # fmt: skip
                made.colorbar(dots, ax=axis, label=of_path[other].label)
            if logarithmic(x):
                axis.set_xscale("log")
            axis.set(xlabel=of_path[path].label, ylabel=of_y.label)
        caption = "What came of each lane, against what varied"
        caption += "; the colour is another path's value." if len(paths) > 1 else "."
        return plots.finish(made, "sweep", caption, pdf=True)


_UNITS = {"period": "s"}
_WORDS = {
    "peak_F": "largest |F|", "final_y": "y at the end", "amplitude": "amplitude of y", "slips": "slips",
    "period": "period of y",
}  # fmt: skip


def _lanes(sweep: Sweep, lanes: NDArray[np.int64], found: Ensemble) -> FigureSvg:
    from matplotlib import colormaps

    colours = colormaps["viridis"](np.linspace(0, 0.9, len(lanes)))
    labels = [
        ", ".join(f"{path.rpartition('.')[2]} = {x[lane]:.4g}" for path, x in sweep.lanes.values.items())
        for lane in lanes
    ]
    known = {c.name: c for c in found.columns}
    with plots.style():
        names = list(dict.fromkeys(_columns(sweep.lanes.scenario)))
        made, axes = plots.figure([[name] for name in names], 5.4)
        of_t = scale([Quantity("t", "s", "time", found.t)])
        for name, axis in axes.items():
            of_y = scale([Quantity(name, known[name].unit, known[name].meaning, found[name])])
            for label, colour, y in zip(labels, colours, found[name], strict=True):
                axis.plot(
                    *plots.thin(of_t.of(found.t), plots.drawable(of_y.of(y))), color=colour, label=label, linewidth=1
                )
            axis.set(xlabel=of_t.label, ylabel=of_y.label, title=known[name].meaning)
        if len(lanes) > 1:
            plots.legend(made, axes[names[0]])
        return plots.finish(made, "lanes", f"{len(lanes)} of the lanes, from the first (dark) to the last.", pdf=True)
