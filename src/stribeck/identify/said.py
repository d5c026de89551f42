"""The documents of fits and predictions. All layout and wording of these reports is here."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from stribeck import laws
from stribeck.constants import rotary_unit
from stribeck.identify import figures
from stribeck.identify.formula import model_lines
from stribeck.identify.log import Trace
from stribeck.identify.models.forms import in_words
from stribeck.mouth.cells import human, percent
from stribeck.mouth.document import (
    PAGE,
    TERMINAL,
    Amount,
    Cell,
    Chapter,
    Document,
    Ends,
    Figure,
    Head,
    Share,
    Table,
    Uncertain,
)

if TYPE_CHECKING:
    from stribeck.identify.core.states import Estimate
    from stribeck.identify.predicted import Predicted
    from stribeck.identify.result import LogFit, MachineFit
    from stribeck.identify.validate import Validated

HEAD = ("parameter", "estimate", "95 % interval", "model range", "unit", "state")
UNCERTAINTIES = (
    "The 95 % interval covers the change of an estimate if the same experiment is repeated. The model range also covers "
    "effects that the model may lack."
)
_SPEED_UNITS = {unit("N"): unit("m/s") for unit in (str, rotary_unit)}  # of a speed, by that of the friction there
_OTHERS = 3  # models in the headline

# -- parts of both kinds of fits -----------------------------------------------------------------------------------------


def _row(name: str, e: Estimate, speed: float | None) -> list[Cell]:
    """A row of the table of estimates; a level of friction is named with its speed."""
    label = name if speed is None else f"{name} ({human(speed, _SPEED_UNITS[e.unit])})"
    estimate = Uncertain(e.value, e.interval, not e.identifiable)
    interval, model_range = (Ends(ends, e.value) for ends in (e.interval, e.range))
    return [label, estimate, interval, model_range, e.unit or "1", str(e.state)]


def _numbers(
    estimates: Mapping[str, Estimate],
    given: Sequence[list[Cell]],
    speeds: Mapping[str, float],
    notes: Sequence[str],
    in_table: Collection[str],
) -> list[Chapter]:
    """The table of estimates, the reasons why some are withheld, and the notes. A terminal prints only the first notes.

    Args:
        in_table: notes that a page has in its table of reasons.
    """
    rows = [*(_row(n, e, speeds.get(n)) for n, e in estimates.items()), *given]
    why: list[list[Cell]] = [[n, e.why, e.experiment or "-"] for n, e in estimates.items() if e.why or e.experiment]
    tables = [Table(HEAD, rows)]
    if why:
        tables.append(Table(["parameter", "reason", "what to measure"], why, prose=True, on=PAGE))
    text = [UNCERTAINTIES, *(["A level is the friction at one of the recorded speeds."] if speeds else [])]
    return [
        Chapter("result", "Parameters", [*text, *(each for each in notes if each not in in_table)], tables),
        Chapter("notes", "Notes", facts=notes, brief=True, on=TERMINAL),
    ]


def _open(parameters: Mapping[str, Estimate], act: str = "") -> list[str]:
    """The estimates that are not identifiable, or bounds: a line for each, with the reason and the experiment.

    Those that no experiment would determine come first: the reason is all that a reader has. ``act``: the
    verb of the experiments, unless they have their own.
    """
    lines = [
        (
            bool(e.experiment),
            f"{n}: {e.state}{f': {e.why}' if e.why else ''}{f'; {act}{e.experiment}' if e.experiment else ''}",
        )
        for n, e in parameters.items()
        if e.why or e.experiment
    ]
    return [line for _, line in sorted(lines, key=lambda each: each[0])]


def _beside(lead: str, others: Mapping[str, float | None], words: str = "") -> str:
    """The headline with the residuals of other models, the largest first."""
    known = sorted(((x, n) for n, x in others.items() if x is not None), reverse=True)[:_OTHERS]
    return f"{lead} ({words}{', '.join(f'{n} {percent(x)}' for x, n in known)})" if known else lead


def _relation(relation: tuple[list[str], np.ndarray] | None) -> list[Chapter]:
    """The correlation of the estimates."""
    if relation is None or len(relation[0]) < 2:
        return []
    names, matrix = relation
    rows: list[list[Cell]] = [
        [f"{i} {n}", *(f"{x:.2f}" if np.isfinite(x) else "-" for x in row)]
        for i, (n, row) in enumerate(zip(names, matrix.tolist(), strict=True), 1)
    ]
    table = Table([Head(""), *map(str, range(1, len(names) + 1))], rows)
    return [Chapter("correlation", "Correlation", (), [table], on=PAGE)]


def _overlay(key: str, title: str, shown: Sequence[Trace], words: tuple[str, str]) -> Chapter:
    """Measured and computed columns against time."""
    caption = f"{words[0].capitalize()} and {words[1]}; a detail of the largest difference; and the difference."
    return Chapter(key, title, figures=[Figure(key, caption, partial(figures.traces, shown, words))], on=PAGE)


# -- a law fitted to a log -------------------------------------------------------------------------------------------------


def of_log(fit: LogFit) -> Document:
    """A law fitted to a log."""
    memory = laws.find(fit.law_name).has_z  # fits by simulation compare all rows, static ones those in motion
    alike = [c for c in fit.candidates if not c["chosen"] and laws.find(c["law"]).has_z is memory]
    others = {c["name"]: c["relative_force_error"] for c in alike}
    notes, in_table = fit.notes, [e.advice(n) for n, e in fit.parameters.items()]
    if fit.method == "dynamic" and fit.status != "stopped":
        in_table = _open(fit.parameters, "measure ")
        notes = (*notes, *in_table)
    of_data = fit.log.quality if fit.log else ()  # on a page they stand in the chapter on the data
    notes, in_table = (*notes, *of_data), [*in_table, *of_data]
    return Document(
        fit.title,
        _beside(fit.lead, others),
        (),
        [
            *_numbers(fit.parameters, _given(fit), fit.speeds, notes, in_table), *_relation(fit.relation),
            _model(fit), *_candidates(fit), *_data(fit), *_traces(fit), *_curve(fit),
        ],
    )  # fmt: skip


def _given(fit: LogFit) -> list[list[Cell]]:
    """The given constants as rows of the table."""
    turns = fit.log is not None and fit.log.rotary
    units = {n: c.unit_for(turns) or "1" for n, c in laws.find(fit.law_name).constants().items()}
    return [
        [n, x if isinstance(x, str) else f"{x:.6g}", "-", "-", units.get(n, ""), "given"]
        for n, x in fit.values.items()
        if n in fit.given and n not in fit.parameters
    ]


def _model(fit: LogFit) -> Chapter:
    text = [f"The fitted model, with law {fit.law_name} and method {fit.method}, in SI units."]
    if fit.cross_validated_error is not None:
        text.append(f"The relative residual on held-out data is {percent(fit.cross_validated_error)}.")
    return Chapter("model", "Model", text, code="\n".join(model_lines(fit)), on=PAGE)


def _candidates(fit: LogFit) -> list[Chapter]:
    if len(fit.candidates) < 2:
        return []
    rows: list[list[Cell]] = [
        [c["name"], "; ".join(map(in_words, c["forms"])) or "-", Share(c["relative_force_error"]), c["numbers"]]
        for c in fit.candidates
    ]
    text = ["The static law with the least BIC is reported. Forms are further terms, for effects that the law lacks."]
    if any(laws.find(c["law"]).has_z for c in fit.candidates if c["law"] in laws.builtin()):
        text.append(
            "A law with bristles is fitted by simulation, to all rows. "
            "It is reported if it halves the static law's residual there, and identifies as many numbers."
        )
    table = Table(["law", "forms", "relative residual", "parameters"], rows, prose=True)
    return [Chapter("candidates", "Candidates", text, [table], on=PAGE)]


def _data(fit: LogFit) -> list[Chapter]:
    if (log := fit.log) is None:
        return []
    count = len(log.runs())
    rows = f"{len(log)} rows in {count} {'run' if count == 1 else 'runs'}, one every {log.step:.6g} s."
    text = [f"{rows} SHA-256 {fit.data_hash[:16]}...", *(["Notes on the data:"] if log.quality else []), *log.quality]
    table = Table(["column", "source"], [[n, s] for n, s in log.sources.items() if n != "unfiltered"], prose=True)
    shown = [Figure("data", "The log as it was fitted.", partial(figures.data, log))]
    return [Chapter("data", "Data", text, [table], shown, on=PAGE)]


def _traces(fit: LogFit) -> list[Chapter]:
    """The fitted signal against time: the motion, or friction."""
    if (shown := fit.output) is None:
        if (p := fit.friction) is None:
            return []
        unit = rotary_unit("N") if fit.log is not None and fit.log.rotary else "N"
        shown = Trace("friction", unit, p.time, p.measured, p.fitted)
    return [_overlay("traces", "Measured and fitted", [shown], ("measured", "fitted"))]


def _curve(fit: LogFit) -> list[Chapter]:
    if (p := fit.friction) is None:
        return []
    text = [
        "Friction is the measured force minus the other forces of the rig, such as inertia and offset.",
        "The residuals are below. A pattern in them is an effect that the model lacks.",
    ]
    shown = Figure(
        "curve",
        "Measured friction, the fitted law at constant speeds, and the residuals.",
        partial(figures.curve, fit, p),
    )
    return [Chapter("curve", "Friction against velocity", text, figures=[shown], on=PAGE)]


# -- a machine fitted to its recordings ------------------------------------------------------------------------------------


def of_machine(fit: MachineFit) -> Document:
    """A machine fitted to its recordings."""
    plainer = {n: b.get("held_out") or b.get("fitted") for n, b in list(fit.baselines.items())[1:]}
    chapters = [*_numbers(fit.parameters, (), fit.speeds, *_of_machine(fit)), _errors(fit), *_other_friction(fit)]
    for i, log in enumerate(fit.logs):
        if log.traces:
            title = f"{log.file}{' (held out)' if log.held_out else ''}"
            chapters.append(_overlay(f"log{i}", title, log.traces, ("measured", "simulated")))
    lead = _beside(fit.lead, plainer, "simpler friction: ")
    return Document(fit.title, lead, (), [*chapters, *_relation(fit.relation)])


def _of_machine(fit: MachineFit) -> tuple[list[str], list[str]]:
    """Notes of one sentence each: doubts, withheld values, and values that cannot be separated; and the withheld ones alone."""
    open_ones = [] if fit.status == "stopped" else _open(fit.parameters)
    together = [f"Cannot be separated: {', '.join(group['names'])}." for group in fit.correlated]
    failed = [f"{label} was not fitted: {why}." for label, why in (fit.laws or {"failed": {}})["failed"].items()]
    return [*fit.notes, *open_ones, *together, *failed], open_ones


def _errors(fit: MachineFit) -> Chapter:
    rows: list[list[Cell]] = [
        [log.file, "held out" if log.held_out else "fitted", column, Amount(e["rms"], e["unit"]), Share(e["relative"])]
        for log in fit.logs for column, e in log.errors.items()
    ]  # fmt: skip
    head = ["recording", "used", "column", "error (rms)", "relative to changes"]
    return Chapter("errors", "Errors", [], [Table(head, rows)], on=PAGE)


def _other_friction(fit: MachineFit) -> list[Chapter]:
    chapters = []
    if fit.baselines:
        rows: list[list[Cell]] = [
            [n, Share(b.get("held_out")), Share(b.get("fitted")), b.get("why", "")] for n, b in fit.baselines.items()
        ]
        table = Table(["friction", "held out", "fitted", ""], rows)
        chapters.append(Chapter("baselines", "Comparison with simpler friction", [], [table], on=PAGE))
    if fit.laws:
        rows = [[n, Share(x), fit.laws["numbers"][n]] for n, x in fit.laws["errors"].items()]
        text = [f"Chosen: {fit.laws['picked']}."]
        chapters.append(
            Chapter("laws", "Choice of the law", text, [Table(["law", "held out", "parameters"], rows)], on=PAGE)
        )
    return chapters


# -- predictions -----------------------------------------------------------------------------------------------------------


def of_prediction(prediction: Predicted) -> Document:
    """The force that a fit predicts of a record."""
    model = prediction.model
    rows: list[list[Cell]] = [[record, of, Share(x)] for record, of, x in _residuals(prediction)]
    slow = ""
    if model.slowest is not None:
        slowest = human(model.slowest, _SPEED_UNITS[prediction.force.unit])
        slow = (
            f", {100 * prediction.slow:.0f} % of them at rest or below {slowest}, the slowest sliding that was fitted"
        )
    about = f"{len(prediction.force.t)} rows{slow}; fitted to {model.title}"
    in_fit = model.relative_force_error if model.predictor is None else model.cross_validated_error
    others = (
        [f"{percent(in_fit)} {'in' if model.predictor is None else 'held out in'} the fit"]
        if in_fit is not None
        else []
    )
    others.append(f"{percent(prediction.constant_error)} for a constant force")
    shown = [prediction.force, prediction.friction]
    return Document(
        prediction.title,
        f"{model.law_name}, relative residual {percent(prediction.force_error)} ({', '.join(others)})",
        [about, *prediction.notes()],
        [
            Chapter("errors", "Errors", (), [Table(["recording", "quantity", "relative residual"], rows)]),
            _overlay("prediction", "Measured and predicted", shown, ("measured", "predicted")),
        ],
    )


def _residuals(prediction: Predicted) -> list[tuple[str, str, float]]:
    """The relative residuals of the record and of the fit's: the record, what is compared, and the residual."""
    model, beyond = prediction.model, prediction.beyond
    simulated = model.predictor is None
    compared = "all rows" if simulated else "rows that slide"
    here, there = "this one", "of the fit"
    rows: list[tuple[str, str, float | None]] = [(here, f"force, {compared}", prediction.force_error)]
    if not simulated:
        rows.append((here, "force, all rows", prediction.all_rows_error))
    if beyond and beyond.rows:
        rows.append((here, "force, rows beyond the fitted range", beyond.error))
        rows.append((here, "force, rows within this range", beyond.within))
    rows += [
        (here, f"friction alone, {compared}", prediction.friction_error),
        (here, f"constant force, {compared}", prediction.constant_error),
    ]
    if simulated:
        rows.append((there, "force, all rows", model.known["relative_force_error"]))
    else:
        rows += [
            (there, "force, rows that slide, held out", model.known["cross_validated_error"]),
            (there, "force, filtered rows that were fitted", model.known["relative_force_error"]),
            ("another one", "force, rows that slide, expected", model.expected),
        ]
    return [(record, of, x) for record, of, x in rows if x is not None]


def of_validation(comparison: Validated) -> Document:
    """A machine's motion beside a record."""
    rows: list[list[Cell]] = [
        [name, Amount(e["rms"], e["unit"]), Amount(e["largest"], e["unit"]), Share(e["relative"])]
        for name, e in comparison.errors.items()
    ]
    off = [f"{name} by {percent(e['relative'])} of its changes" for name, e in comparison.errors.items()]
    return Document(
        comparison.title,
        f"off: {'; '.join(off)}",
        [f"{comparison.status}: {comparison.rows} rows"],
        [
            Chapter(
                "errors", "Errors", (), [Table(["quantity", "rms error", "largest", "rms relative to changes"], rows)]
            ),
            _overlay("validation", "Measured and simulated", comparison.traces, ("measured", "simulated")),
        ],
    )
