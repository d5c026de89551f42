"""The files of a fit of a machine: machine.toml, parameters.toml and report.html."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import tomli_w

from stribeck.arrays import Array
from stribeck.files import seen_from, together, write_text
from stribeck.identify.actuator.result import LogResult, MachineFit
from stribeck.identify.core.states import Estimate
from stribeck.identify.report.files import FITS
from stribeck.identify.report.page import HEAD, UNCERTAINTIES, estimate_row
from stribeck.mouth.cells import digits
from stribeck.mouth.document import Chapter, FigureSvg, Table
from stribeck.mouth.page import html
from stribeck.mouth.plots import figure, finish, legend, line, style, thin
from stribeck.scenario.moved import moved
from stribeck.version import __version__

FILES = ("parameters.toml", "report.html", "machine.toml")
_ZOOM = 0.15  # of a recording: the part shown larger


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
    """The numbers by path and the levels, each with both uncertainties and its state."""
    told = {"version": __version__, "command": command, "status": fit.status}
    if fit.reason:
        told["reason"] = fit.reason
    if logs is not None:
        told["logs"] = logs
    rows = {name: _row(e) for name, e in fit.parameters.items()}
    levels = {name: {"speed": fit.speeds[name], **_row(e)} for name, e in fit.levels.items()}
    return tomli_w.dumps({**told, "parameters": rows, "levels": levels})


def _row(e: Estimate) -> dict[str, object]:
    """An estimate without what is open or empty."""
    own = {
        "value": e.value, "low": e.low, "high": e.high, "range": None if e.range is None else list(e.range), "unit": e.unit,
        "identifiable": e.identifiable, "state": str(e.state), "depends_on": e.depends_on, "why": e.why,
        "experiment": e.experiment,
    }  # fmt: skip
    return {k: x for k, x in own.items() if x is not None and x != ""}


def report(fit: MachineFit, command: str, title: str) -> str:
    """The page that stands alone."""
    about = f"Stribeck {__version__}, {command}"
    open_ = [n for n, p in fit.parameters.items() if not p.identifiable]
    first = f"{len(fit.parameters)} numbers were sought in {len(fit.logs)} recordings: {fit.status}. {fit.reason}"
    second = f"Not identifiable: {', '.join(open_)}." if open_ else "Every number is identifiable."
    chapters = [_numbers(fit), _errors(fit), *_others(fit), *[_log(log, i) for i, log in enumerate(fit.logs)]]
    chapters += [*_relation(fit), _paste(fit)]
    return html(
        title,
        about,
        [first, second, *fit.notes],
        chapters,
        command,
    )


def number_or_open(x: object) -> str:
    """A number for people; what is open says so."""
    return digits(float(x) if isinstance(x, int | float) and np.isfinite(x) else None, "open")


def _numbers(fit: MachineFit) -> Chapter:
    every = {**fit.parameters, **fit.levels}
    tables = [Table(HEAD, [estimate_row(n, e) for n, e in every.items()])]
    if why := [[n, p.why, p.experiment or "-"] for n, p in every.items() if p.why]:
        tables.append(Table(["number", "why", "what would tell it"], why, prose=True))
    told = ", ".join(f"{n} {v:.4g}" for n, v in fit.speeds.items())
    text = [UNCERTAINTIES, *([f"Levels are the friction at speeds that were seen (SI): {told}."] if told else [])]
    return Chapter("numbers", "What was found", text, tables)


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
