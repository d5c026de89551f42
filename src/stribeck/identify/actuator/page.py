"""The files of a fit of a machine: machine.toml, parameters.toml and report.html."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import tomli_w

from stribeck.arrays import Array
from stribeck.files import finite, seen_from, together, write_text
from stribeck.identify.actuator.intervals import THRESHOLD
from stribeck.identify.actuator.result import LogResult, MachineFit, Parameter
from stribeck.identify.report.files import FITS
from stribeck.mouth.cells import digits
from stribeck.mouth.document import Chapter, FigureSvg, Table
from stribeck.mouth.page import html
from stribeck.mouth.plots import figure, finish, legend, line, style, thin
from stribeck.scenario.moved import moved
from stribeck.version import __version__

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FILES = ("parameters.toml", "report.html", "machine.toml")
_ZOOM = 0.15  # of a recording: the part shown larger
_PROFILES = 12
_HIGHEST = 12.0  # of a profile, as far as it is drawn


def write_machine_fit(
    fit: MachineFit, folder: Path, command: str, title: str, origin: Path = Path(), logs: Path | None = None
) -> list[str]:
    """Write what was found into a folder; the paths. ``origin`` is the folder of the machine's file; ``logs`` the file
    of the recordings, which parameters.toml names."""
    with together(folder, last=FILES[0], older=FITS) as place:
        parameters, page, machine = (place / name for name in FILES)
        write_text(page, report(fit, command, title))
        write_text(parameters, toml(fit, command, None if logs is None else seen_from(folder, logs)))
        written = [page, parameters]
        if fit.status == "done":
            write_text(machine, f"# Found by: {command}\n" + tomli_w.dumps(moved(fit.data, origin, folder)))
            written.append(machine)
    return [str(folder / path.name) for path in written]


def toml(fit: MachineFit, command: str, logs: str | None = None) -> str:
    """The numbers by path, with intervals and verdicts."""
    told = {"version": __version__, "command": command, "status": fit.status}
    if fit.reason:
        told["reason"] = fit.reason
    if logs is not None:
        told["logs"] = logs
    rows = {name: finite(p.to_json()) for name, p in fit.parameters.items()}
    rows = {name: {k: x for k, x in row.items() if x is not None and x != ""} for name, row in rows.items()}
    return tomli_w.dumps({**told, "parameters": rows})


def report(fit: MachineFit, command: str, title: str) -> str:
    """The page that stands alone."""
    about = f"Stribeck {__version__}, {command}"
    open_ = [n for n, p in fit.parameters.items() if p.verdict != "found"]
    first = f"{len(fit.parameters)} numbers were sought in {len(fit.logs)} recordings: {fit.status}. {fit.reason}"
    second = (
        f"Not told by these recordings: {', '.join(open_)}." if open_ else "Every number is told by the recordings."
    )
    chapters = [_numbers(fit), _errors(fit), *_others(fit), *[_log(log, i) for i, log in enumerate(fit.logs)]]
    chapters += [*_profiles(fit), *_relation(fit), _paste(fit)]
    return html(
        title,
        about,
        [first, second if fit.status == "done" else "No intervals are given.", *fit.notes],
        chapters,
        command,
    )


def number_or_open(x: float | None) -> str:
    """A number for people; what is open says so."""
    return digits(x, "open")


def _numbers(fit: MachineFit) -> Chapter:
    rows = [
        [n, number_or_open(p.value), number_or_open(p.low), number_or_open(p.high), p.unit or "1", p.verdict]
        for n, p in fit.parameters.items()
    ]
    tables = [Table(["number", "value", "95 % from", "to", "unit", "verdict"], rows)]
    if why := [[n, p.why, p.experiment or "-"] for n, p in fit.parameters.items() if p.why]:
        tables.append(Table(["number", "why", "what would tell it"], why, prose=True))
    return Chapter("numbers", "What was found", [], tables)


def _errors(fit: MachineFit) -> Chapter:
    rows = [
        [log.file, "held out" if log.held_out else "fitted", x.column, f"{x.rms:.4g}", x.unit, f"{100 * x.relative:.3g} %"]
        for log in fit.logs for x in log.traces
    ]  # fmt: skip
    head = ["recording", "used", "column", "error (rms)", "unit", "of its changes"]
    return Chapter("errors", "Errors", [], [Table(head, rows)])


def _share(x: float | None) -> str:
    return "-" if x is None else f"{100 * x:.3g} %"


def _others(fit: MachineFit) -> list[Chapter]:
    found = []
    if fit.baselines:
        rows = [
            [n, _share(b.get("held_out")), _share(b.get("fitted")), b.get("why", "")] for n, b in fit.baselines.items()
        ]
        found.append(
            Chapter("baselines", "Beside simpler friction", [], [Table(["friction", "held out", "fitted", ""], rows)])
        )
    if fit.laws:
        rows = [[n, _share(x), str(fit.laws["numbers"][n])] for n, x in fit.laws["errors"].items()]
        text = [f"Picked: {fit.laws['picked']}."]
        found.append(Chapter("laws", "Which law", text, [Table(["law", "held out", "numbers"], rows)]))
    if fit.transfer is not None:
        rows = [
            [m["name"], number_or_open(m["from"]["value"]), number_or_open(m["to"]["value"])]
            for m in fit.transfer["moved"]
        ]
        text = [f"Moved beyond both intervals: {', '.join(r[0] for r in rows) or 'nothing'}."]
        found.append(Chapter("transfer", "The other recordings", text, [Table(["number", "here", "there"], rows)]))
    return found


def _log(log: LogResult, i: int) -> Chapter:
    names = [x.column for x in log.traces]
    layout = [[f"{n}", f"{n} zoom"] for n in names] + [[f"{n} left", f"{n} left"] for n in names]
    with style():
        made, axes = figure(layout, 1.9 * len(layout) + 0.4)
        for x in log.traces:
            zoom = _zoom(x.t, x.measured)
            for name, part in ((x.column, slice(None)), (f"{x.column} zoom", zoom)):
                line(axes[name], 0, *thin(x.t[part], x.measured[part]), "measured")
                line(axes[name], 1, *thin(x.t[part], x.predicted[part]), "predicted")
                axes[name].set(xlabel="t (s)", ylabel=f"{x.column} ({x.unit or '1'})")
            line(axes[f"{x.column} left"], 0, *thin(x.t, x.predicted - x.measured), "left")
            axes[f"{x.column} left"].set(xlabel="t (s)", ylabel=f"residual ({x.unit or '1'})")
        legend(made, axes[names[0]])
        drawn: FigureSvg = finish(made, f"log_{i}", "Measured and predicted, a part of it larger, and what is left.")
    return Chapter(f"log{i}", f"{log.file}{' (held out)' if log.held_out else ''}", [], [], [drawn])


def _zoom(t: Array, x: Array) -> slice:
    """The part of a record in which most happens."""
    width = max(int(_ZOOM * len(t)), 2)
    busy = np.abs(np.diff(np.diff(x), prepend=0.0))
    smooth = np.convolve(busy, np.ones(width), "valid")
    at = int(np.argmax(smooth))
    return slice(at, at + width)


def _profiles(fit: MachineFit) -> list[Chapter]:
    shown = {n: p for n, p in fit.parameters.items() if len(p.profile) > 2}
    names = list(shown)[:_PROFILES]
    if not names:
        return []
    layout = [names[i : i + 3] for i in range(0, len(names), 3)]
    layout[-1] += ["."] * (len(layout[0]) - len(layout[-1]))  # nothing there
    with style():
        made, axes = figure(layout, 1.9 * len(layout))
        for n in names:
            _profile(axes[n], n, shown[n])
        drawn = finish(made, "profiles", "How much worse the fit gets when a number is held and all others adapt.")
    text = [
        "An interval ends where the curve crosses the line; a curve that stays below it is a number that is not told."
    ]
    return [Chapter("profiles", "Profiles", text, [], [drawn])]


def _profile(axis: Axes, name: str, p: Parameter) -> None:
    x, rise = np.array(p.profile).T
    fine: Array = np.linspace(x[0], x[-1], 200)
    signed = np.sign(x - x[np.argmin(rise)]) * np.sqrt(rise)  # nearly straight: a profile is nearly a parabola
    axis.plot(fine, np.interp(fine, x, signed) ** 2, color="#0072B2")
    axis.plot(x, rise, "o", color="#0072B2", markersize=2.5)
    near = x[rise < _HIGHEST]
    if len(near) > 1:
        axis.set_xlim(near.min() - 0.1 * np.ptp(near), near.max() + 0.1 * np.ptp(near))
    axis.axhline(THRESHOLD, color="#D55E00", linewidth=0.8)
    axis.set(title=".".join(name.split(".")[-3:]), ylim=(0, max(6.0, min(float(rise.max()), 12.0))))
    axis.locator_params(axis="x", nbins=2)


def _relation(fit: MachineFit) -> list[Chapter]:
    if fit.relation is None or len(fit.relation[0]) < 2:
        return []
    names, matrix = fit.relation
    rows = [
        [f"{i} {n}", *(f"{x:.2f}" for x in row)]
        for i, (n, row) in enumerate(zip(names, matrix.tolist(), strict=True), 1)
    ]
    text = [f"Go together: {', '.join(g['names'])}." for g in fit.correlated] or [
        "No two numbers can stand for each other."
    ]
    return [Chapter("correlation", "Correlation", text, [Table(["", *map(str, range(1, len(names) + 1))], rows)])]


def _paste(fit: MachineFit) -> Chapter:
    options = [f"--set {n}={p.value:.6g}" for n, p in fit.parameters.items() if "log." not in n]
    return Chapter("paste", "To paste", ["As options:"], code=" \\\n".join(options))
