"""The report of a fit: one page that stands alone."""

from __future__ import annotations

import numpy as np

from stribeck.constants import DECIDED
from stribeck.errors import StribeckError
from stribeck.identify.log import Log
from stribeck.identify.report import pictures, traces
from stribeck.identify.report.formula import model_lines
from stribeck.identify.result import Estimate, Fit
from stribeck.mouth.cells import digits, percent
from stribeck.mouth.document import Chapter, Table
from stribeck.mouth.page import html
from stribeck.properties import check
from stribeck.version import __version__

_LONG = 80  # letters: names of more files than fit in a head are counted


def page(fit: Fit, command: str, data: str) -> str:
    """The report as HTML."""
    log = fit.log
    chapters = [
        _result(fit), _model(fit), *_candidates(fit), *([_data(log, data), *_traces(fit, log)] if log is not None else []),
        *_curve(fit), *_residuals(fit), *_properties(fit),
    ]  # fmt: skip
    about = f"Stribeck {__version__}, {command}, data SHA-256 {fit.data_hash[:16]}..."
    left_out = f", and {percent(fit.cross_validated_error, 3)} on data left out" if fit.cross_validated_error else ""
    introduction = [
        f"Law {fit.law_name}, method {fit.method}. The relative force error, norm(residual)/norm(force), is "
        f"{percent(fit.relative_force_error, 3)}{left_out}.",
        *_of_output(fit),
        *fit.notes[:1],
    ]
    names = data.split(", ")
    title = data if len(data) <= _LONG else f"{len(names)} files, {names[0]} to {names[-1]}"
    return html(f"{fit.law_name} fitted to {title}", about, introduction, chapters, command)


HEAD = ["parameter", "estimate", "95 % from", "to", "range from", "to", "unit", "state"]


UNCERTAINTIES = (
    "The interval says how far an estimate would move in another stretch of this experiment; the range says how far it may "
    "be from the truth if the model lacks something."
)


def estimate_row(name: str, e: Estimate) -> list[str]:
    """An estimate below :data:`HEAD`."""
    wide = [digits(x if np.isfinite(x) else None, "open") for x in e.range] if e.range else ["-", "-"]
    ends = (digits(x, "open") for x in (e.low, e.high))
    return [
        f"{'' if e.identifiable else '~'}{name}", digits(e.value, "open"), *ends, *wide, e.unit or "1", str(e.state)
    ]  # fmt: skip


def _result(fit: Fit) -> Chapter:
    rows = [estimate_row(n, e) for n, e in fit.parameters.items()]
    rows += [
        [n, v if isinstance(v, str) else digits(v, "open"), *["given"] * 4, _unit(fit, n), "given"]
        for n, v in fit.fixed.items()
        if n not in fit.parameters
    ]
    tables = [Table(HEAD, rows)]
    if open_ones := {n: e for n, e in fit.parameters.items() if e.experiment}:
        advice = [[n, e.why, e.experiment] for n, e in open_ones.items()]
        tables.append(Table(["not determined", "why", "what to measure"], advice, prose=True))
    if len(fit.names) > 1:
        relation = [
            [n, *(f"{x:.2f}" if np.isfinite(x) else "-" for x in row)]
            for n, row in zip(fit.names, fit.correlations.tolist(), strict=True)
        ]
        tables.append(Table(["correlation", *fit.names], relation))
    speeds = fit.details.get("speeds", {})
    told = ", ".join(f"{n.removeprefix('level ')} {v:.4g}" for n, v in speeds.items())
    text = [
        UNCERTAINTIES,
        *([f"Levels are the friction at speeds that were seen (SI): {told}."] if told else []),
        *fit.notes,
    ]
    return Chapter("result", "Parameters", text, tables)


def _model(fit: Fit) -> Chapter:
    return Chapter(
        "model", "Model", [f"What was fitted with law {fit.law_name}, SI units."], code="\n".join(model_lines(fit))
    )


def _unit(fit: Fit, name: str) -> str:
    from stribeck import laws

    constants = laws.find(fit.law_name).constants()
    return constants[name].unit or "1" if name in constants else ""


def _candidates(fit: Fit) -> list[Chapter]:
    if len(fit.candidates) < 2:
        return []
    rows = [
        [c["name"], ", ".join(c["forms"]) or "-", percent(c["relative_force_error"], 3), str(c["numbers"])]
        for c in fit.candidates
    ]
    text = ["The model of the least BIC is reported. Forms are what the law lacks, chosen from one table."]
    return [
        Chapter(
            "candidates",
            "Candidates",
            text,
            [Table(["law", "forms", "relative residual", "numbers"], rows, prose=True)],
        )
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


def _curve(fit: Fit) -> list[Chapter]:
    if fit.prediction is None:
        return []
    text = ["Friction is the measured force less what belongs to the rig: inertia, offset and the like."]
    return [Chapter("curve", "Friction against velocity", text, figures=[pictures.curve(fit)])]


def _traces(fit: Fit, log: Log) -> list[Chapter]:
    shown = traces.figure(fit, log)
    if shown is None:
        return []
    text = ["What was measured and what the fit makes of it; the ends, where the motion's filter errs, are left out."]
    return [Chapter("traces", "Measured and fitted", text, figures=[shown])]


def _residuals(fit: Fit) -> list[Chapter]:
    if fit.prediction is None:
        return []
    text = ["What the fit leaves, in time and against the velocity. A pattern is something that the model lacks."]
    return [Chapter("residuals", "Residuals", text, figures=[pictures.residuals(fit)])]


def _properties(fit: Fit) -> list[Chapter]:
    try:
        law = fit.law()
    except StribeckError:
        open_ones = ", ".join(n for n, e in fit.estimates.items() if not e.usable)
        text = [f"Not decided: they hang on {open_ones or 'constants'}, which the data do not determine."]
        return [Chapter("properties", "Properties of the result", text)]
    if not law.has_z:
        return []
    rows = [
        [name, DECIDED[v.holds], v.evidence.get("reason", v.method) if v.holds is None else v.method]
        for name, v in check(law).properties.items()
    ]
    text = [
        "What 'stribeck check' proves or refutes for the law with the fitted values: yes is proved, for no "
        "there is a counterexample. The values are taken as exact: their intervals do not count here."
    ]
    return [Chapter("properties", "Properties of the result", text, [Table(["property", "holds", "how"], rows, True)])]


def _of_output(fit: Fit) -> list[str]:
    if "output" not in fit.details:
        return []
    left = percent(fit.details["output_error"], 3)
    return [f"The {fit.details['output']} is what is fitted: {left} of its changes is left."]
