"""Predicts the force, separately from identification. Block cross-validation chooses the model.

Candidates are the chosen forms or the law alone. Identification leaves out rows (filtered, thinned, about reversals) that
bias estimates. A prediction needs all rows, so its coefficients and shapes are fitted again to all measured rows in motion.
Only rows beside a rest stay out: the motion's filter has mixed them with the rest.

Each stretch of the record is left out in turn, and the choice is repeated on the others. The candidate with the least
held-out error is used. Forms of the record itself (time, filter) are chosen, so that they do not bias the rest, but not
used in predictions.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.core.choice import Selection
from stribeck.identify.core.states import Kept
from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log
from stribeck.identify.models.curves import SteadyCurve
from stribeck.identify.models.forms import Anchor, Key, effect, forms
from stribeck.identify.models.record import FEWEST_BLOCKS, MOST_ROWS, LawColumns, Record, beside_rest, body_columns
from stribeck.identify.models.steady import SteadyLibrary, optimum

EXPECTED = 1.2  # times the cross-validated error: found for other motions of the same machine in calibration records


@dataclass(frozen=True)
class Predictor:
    """A model of the force along any record of the machine.

    Attributes:
        at: the constants of the forms; its curve is the law.
        shape, law, body, forms: shapes and coefficients.
        error: cross-validated, norm(residual)/norm(force) over the rows that slide.
    """

    at: Anchor
    shape: Mapping[str, float]
    law: Mapping[str, float]
    body: Mapping[str, float]
    forms: Mapping[Key, float]
    error: float

    def parts(self, log: Log) -> tuple[Array, Array]:
        """Friction and the rest of the force along a log; at rest friction is 0."""
        rest = at_rest(log)
        v, curve = log.velocity, self.at.curve
        columns = body_columns(log, list(self.body))
        friction = curve.force(v, self.shape, self.law) + self.body.get("sigma_2", 0.0) * v
        beside = sum((c * columns[n] for n, c in self.body.items() if n != "sigma_2"), np.zeros(len(log)))
        carried = {k: c for k, c in self.forms.items() if not effect(k[0])[0].of_record}
        form_columns = forms(log, self.at) if carried else {}
        for key, c in carried.items():
            if key in form_columns and effect(key[0])[0].beside:
                beside = beside + c * form_columns[key]()
            elif key in form_columns:
                friction = friction + c * form_columns[key]()
        return np.where(rest, 0.0, friction), np.asarray(beside)

    def force(self, log: Log) -> Array:
        """The force along a log."""
        friction, beside = self.parts(log)
        return friction + beside

    def to_json(self) -> dict[str, object]:
        """The predictor as stored in fit.json."""
        curve = self.at.curve
        return {
            "curve": {"law": curve.law, "given": curve.given, "free": list(curve.free)},
            "at": {f.name: getattr(self.at, f.name) for f in fields(Anchor) if f.name != "curve"},
            "shape": dict(self.shape), "law": dict(self.law), "body": dict(self.body),
            "forms": [(form, column, c) for (form, column), c in self.forms.items()],
            "error": self.error,
        }  # fmt: skip


def of_json(saved: Kept) -> Predictor:
    """The predictor from fit.json."""
    curve = SteadyCurve(saved["curve"]["law"], saved["curve"]["given"], saved["curve"]["free"])
    lists = {n: tuple(x) for n, x in saved["at"].items() if isinstance(x, list)}
    named = {(form, column): c for form, column, c in saved["forms"]}
    anchor = Anchor(curve, **{**saved["at"], **lists})
    return Predictor(anchor, saved["shape"], saved["law"], saved["body"], named, saved["error"])


def predictor(choice: Selection[SteadyLibrary], log: Log, slowest: float) -> Predictor:
    """The candidate that predicts held-out stretches of the choice's record best.

    Args:
        slowest: the slowest sliding that the fit has seen, m/s; the error is of the rows that are as fast.
    """
    rest = at_rest(log)
    moving = np.flatnonzero(~(rest | beside_rest(rest, log)))
    if not len(moving):
        moving = np.arange(len(log))
    count = len(choice.library.gram)
    fold_of_block = np.arange(count) * min(FEWEST_BLOCKS, count) // count
    fold = fold_of_block[_block_of(choice.library.record, log)[moving]]
    candidates = (True,) if choice.alone else (False, True)
    left, slides = np.zeros((2, len(candidates))), abs(log.velocity) >= slowest
    for f in range(int(fold_of_block.max()) + 1):
        inside, others = moving[fold == f], moving[fold != f]
        if not len(inside) or not len(others):
            continue
        for k, alone in enumerate(candidates):
            candidate = _candidate(choice, (fold_of_block != f).astype(float), log, others, alone)
            with np.errstate(over="ignore"):  # a candidate may diverge on a stretch that it has not seen
                squares = (log.force - candidate.force(log))[inside] ** 2
                left[:, k] += np.sum(squares), np.sum(squares[slides[inside]])
    best = int(np.argmin(left[0]))
    error = float(np.sqrt(left[1, best]) / max(np.linalg.norm(log.force[moving[slides[moving]]]), 1e-300))
    return replace(_candidate(choice, np.ones(count), log, moving, candidates[best]), error=error)


def _block_of(record: Record, log: Log) -> NDArray[np.intp]:
    """The block of each row of the whole record: that of the last compared row before it in its file."""
    out, file = np.zeros(len(log), np.intp), log.file_of_rows
    for each in np.unique(record.file):
        rows, compared = np.flatnonzero(file == each), np.flatnonzero(record.file == each)
        compared = compared[np.argsort(record.log.time[record.at[compared]], kind="stable")]
        place = np.searchsorted(record.log.time[record.at[compared]], log.time[rows], side="right") - 1
        out[rows] = record.block[compared][np.maximum(place, 0)]
    return out


def _candidate(
    choice: Selection[SteadyLibrary], weight: Array, seen: Log, rows: NDArray[np.intp], alone: bool
) -> Predictor:
    """The predictor chosen on a weighting of the blocks and fitted to some rows of the log."""
    n, i, x, _ = choice.choose(weight, alone=alone or choice.alone)
    lib, curve = choice.libraries[n], choice.libraries[n].curve
    model, given = lib.models[i], lib.record.given
    keys = list(lib.of_forms(model, x))
    rows = rows[:: max(1, len(rows) // MOST_ROWS)]
    columns = forms(seen, lib.at) if keys else {}
    body = body_columns(seen, [*lib.body, *given])
    beside = [*(body[m][rows] for m in lib.body), *(columns[k]()[rows] for k in keys)]
    rest = np.column_stack([np.empty((len(rows), 0)), *beside])
    force = seen.force - sum((c * body[m] for m, c in given.items()), np.zeros(len(seen)))
    law = LawColumns(curve, seen.velocity[rows], np.asarray)
    shape, y, _ = optimum(law, lib.shape(model, x), rest, force[rows])
    names = [*curve.names, *lib.body, *keys]
    coefficients = dict(zip(names, y.tolist(), strict=True))
    of_body = {m: coefficients[m] for m in lib.body} | {m: c for m, c in given.items() if m in body}
    return Predictor(
        lib.at,
        shape,
        {m: coefficients[m] for m in curve.names},
        of_body,
        {k: coefficients[k] for k in keys},
        float("nan"),
    )
