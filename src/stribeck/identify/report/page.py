"""The report of a fit: one page that stands alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stribeck.constants import DECIDED
from stribeck.errors import StribeckError
from stribeck.identify.log import Log
from stribeck.identify.report import pictures, traces
from stribeck.identify.report.formula import model_lines
from stribeck.identify.result import Fit
from stribeck.identify.statistics.choose import Choice
from stribeck.properties import check
from stribeck.report.cells import digits, percent
from stribeck.report.page import Chapter, Table, html
from stribeck.version import __version__

_LONG = 80  # letters: names of more files than fit in a head are counted
_SAME = 0.05  # of a speed: closer ones share a line


def page(result: Fit | Choice, log: Log, command: str, data: str) -> str:
    """The report as HTML."""
    fit = result.best if isinstance(result, Choice) else result
    chapters = [
        _result(fit), _model(fit), *([_laws(result)] if isinstance(result, Choice) else []), *_selection(fit), _data(log, data),
        *_traces(fit, log), *_curve(fit, log), *_levels(fit), *_loops(fit),
        *_residuals(fit, log), *_profiles(fit), *_properties(fit),
    ]  # fmt: skip
    about = f"Stribeck {__version__}, {command}, data SHA-256 {fit.data_hash[:16]}..."
    unknown = [n for n in fit.unidentified if n in fit.estimates]
    introduction = [
        f"Law {fit.law}, method {fit.method}. The relative force error, norm(residual)/norm(force), is "
        f"{percent(fit.relative_force_error, 3)}"
        + (f", and {percent(fit.cross_validated_error, 3)} on data left out." if fit.cross_validated_error else "."),
        *_of_output(fit),
        f"The data do not determine {', '.join(unknown)}: see below for why, and for what to measure."
        if unknown
        else "The data determine every parameter of the law.",
    ]
    names = data.split(", ")
    title = data if len(data) <= _LONG else f"{len(names)} files, {names[0]} to {names[-1]}"
    return html(f"{fit.law} fitted to {title}", about, introduction, chapters, command)


def _result(fit: Fit) -> Chapter:
    rows = {**fit.estimates, **fit.body}
    known = [
        [n, digits(e.value, "open"), digits(e.low, "open"), digits(e.high, "open"), e.unit or "1"]
        for n, e in rows.items()
        if e.identifiable
    ]
    known += [
        [n, v if isinstance(v, str) else digits(v, "open"), "given", "given", _unit(fit, n)]
        for n, v in fit.fixed.items()
        if n not in rows
    ]
    tables = [Table(["parameter", "value", "95 % from", "to", "unit"], known)]
    if unknown := {n: e for n, e in rows.items() if not e.identifiable}:
        tables.append(
            Table(
                ["not determined", "why", "what to measure"],
                [[n, e.doubt, e.experiment] for n, e in unknown.items()],
                prose=True,
            )
        )
    if len(fit.names) > 1:
        relation = [
            [n, *(f"{x:.2f}" if np.isfinite(x) else "-" for x in row)]
            for n, row in zip(fit.names, fit.correlations.tolist(), strict=True)
        ]
        tables.append(Table(["correlation", *fit.names], relation))
    return Chapter("result", "Parameters", list(fit.notes), tables)


def _model(fit: Fit) -> Chapter:
    return Chapter(
        "model", "Model", [f"What was fitted with law {fit.law}, SI units."], code="\n".join(model_lines(fit))
    )


def _unit(fit: Fit, name: str) -> str:
    from stribeck import laws

    constants = laws.find(fit.law).constants()
    return constants[name].unit or "1" if name in constants else ""


def _laws(choice: Choice) -> Chapter:
    rows = [
        [r["law"], percent(r["cross_validated_error"], 3), percent(r["relative_force_error"], 3), str(r["numbers"])]
        for r in choice.table()
    ]
    text = [
        f"Picked: {choice.picked}: {choice.reason}.",
        *(f"{n}: not fitted: {why}" for n, why in choice.failed.items()),
    ]
    head = ["law", "error on data left out", "error of the fit", "numbers fitted"]
    return Chapter("laws", "Which law", text, [Table(head, rows)])


def _selection(fit: Fit) -> list[Chapter]:
    steps = fit.details.get("selection")
    if not steps:
        return []
    rows = [[s["added"], percent(s["cross_validated_error"], 3), percent(s["relative_force_error"], 3)] for s in steps]
    text = ["Each line adds what lowers the error on data left out most; it stops where that is less than a hundredth."]
    return [
        Chapter("terms", "Which terms", text, [Table(["added", "error on data left out", "error of the fit"], rows)])
    ]


def _data(log: Log, data: str) -> Chapter:
    count = len(list(log.runs()))
    text = [
        f"{len(log)} rows in {count} {'run' if count == 1 else 'runs'}, one every {log.step:.6g} s. Found and done:"
        if log.quality
        else f"{len(log)} rows, one every {log.step:.6g} s.",
        *log.quality,
    ]
    table = Table(["column", "from"], [[n, s] for n, s in log.sources.items() if n != "unfiltered"], prose=True)
    return Chapter("data", "Data", text, [table], pictures.data(log))


def _curve(fit: Fit, log: Log) -> list[Chapter]:
    if fit.prediction is None:
        return []
    text = ["Friction is the measured force less what belongs to the rig: inertia, offset and the like."]
    segments = fit.details.get("segments", [])
    tables = []
    if segments:
        text.append(f"{len(segments)} stretches of constant speed were found; each is a circle.")
        head = ["speed (m/s)", "stretches", "seconds in all", "friction (N)", "spread between stretches (N)"]
        tables = [Table(head, _by_speed(segments))]
    return [Chapter("curve", "Friction against velocity", text, tables, [pictures.curve(fit, log)])]


def _by_speed(segments: Sequence[dict[str, float]]) -> list[list[str]]:
    """Stretches of nearly the same speed in one line."""
    ordered = sorted(segments, key=lambda s: s["velocity"])
    groups: list[list[dict[str, float]]] = []
    for s in ordered:
        last = groups[-1][-1]["velocity"] if groups else None
        if last is not None and abs(s["velocity"] - last) <= _SAME * abs(last):
            groups[-1].append(s)
        else:
            groups.append([s])
    return [
        [
            f"{np.mean([s['velocity'] for s in g]):.4g}", str(len(g)), f"{sum(s['duration'] for s in g):.3g}",
            f"{np.mean([s['friction'] for s in g]):.4g}", f"{np.std([s['friction'] for s in g]):.2g}",
        ]
        for g in groups
    ]  # fmt: skip


def _levels(fit: Fit) -> list[Chapter]:
    rows = fit.details.get("levels")
    if not rows:
        return []
    text = ["The friction level F_c of each file, all else being shared, and what the fit without that file predicts."]
    body = []
    for r in rows:
        at = ", ".join(f"{n.removeprefix('F_c_by_')} {x:.4g}" for n, x in r["at"].items())
        own = [f"{r[key]:.4g}" for key in ("level", "low", "high")]
        told = [f"{r[key]:.4g}" if key in r else "-" for key in ("predicted", "predicted_low", "predicted_high")]
        body.append([r["file"], at or "-", *own, *told])
    head = ["file", "mean (SI)", "F_c (N)", "95 % from", "to", "predicted (N)", "95 % from", "to"]
    figures = [pictures.levels(rows)] if rows[0]["at"] else []
    return [Chapter("levels", "Friction level by file", text, [Table(head, body)], figures)]


def _loops(fit: Fit) -> list[Chapter]:
    loops = fit.details.get("loops", ())
    if not len(loops):
        return []
    text = ["Small reversals, in which the contact mostly holds, measured and as simulated along the measured motion."]
    return [Chapter("presliding", "Presliding", text, figures=[pictures.loops(loops)])]


def _traces(fit: Fit, log: Log) -> list[Chapter]:
    shown = traces.figure(fit, log)
    if shown is None:
        return []
    text = ["What was measured and what the fit makes of it; the ends, where the motion's filter errs, are left out."]
    return [Chapter("traces", "Measured and fitted", text, figures=[shown])]


def _residuals(fit: Fit, log: Log) -> list[Chapter]:
    if fit.prediction is None:
        return []
    text = ["What the fit leaves, in time and against the velocity. A pattern is something that the model lacks."]
    return [Chapter("residuals", "Residuals", text, figures=[pictures.residuals(fit, log)])]


def _profiles(fit: Fit) -> list[Chapter]:
    if not fit.profiles:
        return []
    text = [
        "How much worse the fit gets when one parameter is held at a value and all others adapt. The interval ends where "
        "the curve crosses the line; a flat curve is a parameter that the data do not determine."
    ]
    return [Chapter("profiles", "Profiles of the likelihood", text, figures=[pictures.profiles(fit)])]


def _properties(fit: Fit) -> list[Chapter]:
    try:
        law = fit.as_law()
    except StribeckError:
        open_ones = ", ".join(n for n in fit.unidentified if n in fit.estimates)
        text = [f"Not decided: they hang on {open_ones or 'constants'}, which the data do not determine."]
        return [Chapter("properties", "Properties of the result", text)]
    if not law.has_z:
        return []
    rows = [
        [name, DECIDED[v.holds], v.evidence.get("reason", v.method) if v.holds is None else v.method]
        for name, v in check(law).properties.items()
    ]
    text = [
        "What 'stribeck check' proves or refutes for the law with the fitted values (docs/check.md): yes is proved, for no "
        "there is a counterexample. The values are taken as exact: their intervals do not count here."
    ]
    return [Chapter("properties", "Properties of the result", text, [Table(["property", "holds", "how"], rows, True)])]


def _of_output(fit: Fit) -> list[str]:
    if "output" not in fit.details:
        return []
    left = percent(fit.details["output_error"], 3)
    return [f"The {fit.details['output']} is what is fitted: {left} of its changes is left."]
