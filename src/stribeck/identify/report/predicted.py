"""How a prediction is told: measured and predicted over each other, and what is left."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stribeck.arrays import Array
from stribeck.files import together
from stribeck.identify.predict import Predicted
from stribeck.identify.validate import Validated
from stribeck.mouth import page, plots
from stribeck.mouth.cells import percent
from stribeck.mouth.document import PAGE, Amount, Cell, Chapter, Document, Figure, Share, Table
from stribeck.mouth.quantities import Quantity, scale

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawn

_ZOOM = 0.1  # of the record
_PLACES = 3  # of a share

Traces = Mapping[str, tuple[str, Array, Array]]  # by label: unit, measured, predicted


def by_fit(found: Predicted, data: str, folder: str) -> Document:
    """The force that a fit, which stands in the folder, predicts of a record."""
    model, traces, friction = found.model, found.traces, found.friction
    shown = {
        "force": ("N", traces.measured, traces.fitted),
        "friction": ("N", friction.measured, friction.fitted),
    }
    rows: list[list[Cell]] = [[name, Share(x, _PLACES)] for name, x in _errors(found).items()]
    facts = [
        f"{len(traces.time)} rows of {data}, {found.rest:.0%} at rest; fitted to another record ({folder})",
        *found.notes(),
    ]
    return Document(
        f"{model.law}, {model.method}",
        f"the predicted force is off by {percent(found.force_error, _PLACES)}",
        facts,
        [_table(rows, ["of", "error"]), *_overlay("prediction", traces.time, shown, ("measured", "predicted"))],
    )


def _errors(found: Predicted) -> dict[str, float | None]:
    rows: dict[str, float | None] = {
        "error of the force, every row in motion": found.force_error,
        "expected by the fit": found.model.expected,
        "the fit's own, on its record": found.model.known.get("relative_force_error"),
        "the fit's, on parts left out of its record": found.model.known.get("cross_validated_error"),
        "error against friction alone": found.friction_error,
        "error of the force, rows at rest too": found.all_rows_error,
        "error of a constant force": found.constant_error,
    }
    if found.beyond and found.beyond.rows:
        rows["error of the force, beyond what was fitted"] = found.beyond.error
        rows["error of the force, within it"] = found.beyond.within
    return {name: x for name, x in rows.items() if x is not None}


def by_machine(found: Validated, title: str) -> Document:
    """A machine's motion beside a record."""
    rows: list[list[Cell]] = [
        [name, Amount(e["rms"], e["unit"]), Amount(e["largest"], e["unit"]), Share(e["relative"], _PLACES)]
        for name, e in found.errors.items()
    ]
    off = [f"{name} by {percent(e['relative'], _PLACES)} of its changes" for name, e in found.errors.items()]
    return Document(
        title,
        f"off: {'; '.join(off)}",
        [f"{found.status}: {len(found.time)} rows"],
        [
            _table(rows, ["of", "rms error", "largest", "rms over changes"]),
            *_overlay("validation", found.time, found.traces, ("measured", "simulated")),
        ],
    )


def _table(rows: list[list[Cell]], head: list[str]) -> Chapter:
    return Chapter("errors", "Errors", (), [Table(head, rows)])


def write(document: Document, folder: Path, name: str, command: str) -> list[str]:
    """Write the page under a name; its path."""
    with together(folder, last=name) as place:
        page.write(document, place, command, name, pictures=False)
    return [str(folder / name)]


def _overlay(name: str, time: Array, traces: Traces, words: tuple[str, str]) -> list[Chapter]:
    """Each trace measured and otherwise, the whole record and the part in which they differ most; and the residuals.

    Args:
        name: of the figures.
        time: s, rising or with files behind each other.
        words: what the two lines are called.
    """
    time = _behind(time)
    shown = f"{words[0]}, {words[1]}, and the difference."
    figures = [
        Figure(name, f"The whole record: {shown}", lambda: _draw(time, traces, words, slice(None))),
        Figure(
            f"{name}_zoom",
            f"The tenth of it in which they differ most: {shown}",
            lambda: _draw(time, traces, words, _worst(time, traces)),
        ),
    ]
    return [Chapter("overlay", f"{words[0].capitalize()} and {words[1]}", figures=figures, on=PAGE)]


def _draw(time: Array, traces: Traces, words: tuple[str, str], rows: slice) -> Drawn:
    layout = [[row] for label in traces for row in (label, f"{label} residual")]
    made, axes = plots.figure(layout, 1.7 * len(layout) + 0.4)
    for label, (unit, measured, other) in traces.items():
        missed = (measured - other)[rows]
        of_y = scale([Quantity(label, unit, "", x[rows]) for x in (measured, other)])
        of_missed = scale([Quantity("residual", unit, "", missed)])
        for i, x, word in ((2, measured, words[0]), (1, other, words[1])):
            plots.line(axes[label], i, *plots.in_time(time[rows], of_y.of(x[rows])), word, linewidth=0.9)
        axes[label].set_ylabel(of_y.label)
        left = axes[f"{label} residual"]
        left.plot(*plots.in_time(time[rows], of_missed.of(missed)), color=plots.COLOURS[2], linewidth=0.7)
        left.set_ylabel(of_missed.label)
    axes[layout[-1][0]].set_xlabel("t (s)")
    plots.legend(made, axes[next(iter(traces))])
    return made


def _behind(time: Array) -> Array:
    steps = np.diff(time)
    return time if np.all(steps >= 0) else np.concatenate([[0.0], np.cumsum(np.maximum(steps, 0.0))])


def _worst(time: Array, traces: Traces) -> slice:
    _, measured, other = next(iter(traces.values()))
    length = max(int(_ZOOM * len(time)), min(len(time), 20))
    sums = np.concatenate([[0.0], np.cumsum((measured - other) ** 2)])
    first = int(np.argmax(sums[length:] - sums[:-length])) if length < len(time) else 0
    return slice(first, first + length)
