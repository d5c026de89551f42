"""Both uncertainties of a reported model.

    interval^2 = C^2 + A^2 + M^2        range^2 = interval^2 + B^2 + H^2                (half widths; no weight is tuned)

C is the covariance. A is the shift if the choice is repeated on resampled blocks. M is the shift if the motion is filtered at
a lower cut-off frequency, or the step that a search has left. B is the shift on resampled blocks with a random half of the
forms withheld. H is the shift by forms that the record does not show: as small as noise, or as large as what the model leaves
unexplained.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.stats import t as student

from stribeck.arrays import Array
from stribeck.identify.core.choice import Of, Selection, rows_together
from stribeck.identify.core.library import DEAD, RIDGE, Model, ModelLibrary
from stribeck.identify.core.states import Estimate, EstimateState, ends, state_of

DRAWS = 40  # replicates: a quantile of 95 % is then known to 15 %
SHARE = 0.5  # of the forms is withheld in a replicate: each form is missing in half of them
WORSE = 2.0  # largest ratio of a replicate's squared residual to the reported model's: a worse one is no model of the record
AGAIN, WITHHELD = 0.95, 0.9  # quantiles of the shifts, round numbers: of 40 draws the 38th and the 36th largest
BARTLETT = 4.0  # times the correlated rows: Bartlett's weights then keep nine tenths of the correlation
EXPLAINED = 0.25  # of the force's standard deviation: with a larger residual, nothing is identified


def judged(
    choice: Selection[Of], draws: int = DRAWS, trusted: bool = True, lower: Mapping[str, float] | None = None
) -> dict[str, Estimate]:
    """Every estimate of the reported model with interval, range and state.

    Args:
        draws: replicates.
        lower: other estimates, whose shift is M: with half the squared cut-off frequency, which doubles the filter's bias; or
            at the end of the step that a search has left.
        trusted: whether the model describes all measured columns; if not, nothing is identified.
    """
    lib, i = choice.library, choice.library.index(choice.model)
    value = lib.parameters(choice.model, choice.coefficients)
    base, by_ratio = np.array(list(value.values())), np.array([n in lib.by_ratio for n in value])
    slope, inverse = _slopes(choice, base), _inverse(lib.gram.sum(0)[np.ix_(i, i)], np.array(lib.natural)[i])
    within, between = _covariance(choice, slope, inverse), _of_other_files(choice, slope @ inverse)
    part: dict[str, Array] = {"C": np.maximum(within, between)}
    part["A"], part["B"], withheld = _redrawn(choice, base, by_ratio, draws)
    part["H"], hidden = _hidden(choice, slope, inverse)
    of_filter = None if lower is None else np.array([lower[n] for n in value])
    part["M"] = np.zeros(len(base)) if of_filter is None else abs(_moved(of_filter, base, by_ratio))
    interval = np.sqrt(part["C"] ** 2 + part["A"] ** 2 + part["M"] ** 2)
    wide = np.sqrt(interval**2 + part["B"] ** 2 + part["H"] ** 2)
    trusted &= missed(choice) <= EXPLAINED
    estimates = {}
    for q, (name, x_now) in enumerate(value.items()):
        both_ends = [ends(x_now, half[q], bool(by_ratio[q])) for half in (interval, wide)]
        state = state_of(both_ends[0], both_ends[1], *lib.level_of(name, value))
        hangs = state is EstimateState.MODEL_DEPENDENT
        if state is EstimateState.IDENTIFIED and not trusted:
            state = EstimateState.MODEL_DEPENDENT
        cause = (withheld if part["B"][q] > part["H"][q] else hidden)[q] if hangs else ""
        differ = bool(between[q] > within[q]) and state is EstimateState.NOT_IDENTIFIABLE
        estimates[name] = Estimate(
            x_now, both_ends[0], both_ends[1], state, depends_on=cause, parts={k: float(z[q]) for k, z in part.items()},
            files_differ=differ,
        )  # fmt: skip
    return lib.concluded(estimates)


def missed(choice: Selection[Of]) -> float:
    """The rms residual of the reported model, relative to the force's standard deviation."""
    lib, r = choice.library, choice.library.residual(choice.model, choice.coefficients)
    return float(np.sqrt(np.mean(r**2)) / max(lib.deviation, 1e-300))


def _estimates(lib: ModelLibrary, model: Model, x: Array) -> Array:
    """All estimates of a model, in order."""
    return np.array(list(lib.parameters(model, x).values()))


def _slopes(choice: Selection[Of], base: Array) -> Array:
    """The derivatives of the estimates by the coefficients."""
    x = choice.coefficients
    steps = np.diag(1e-5 * np.maximum(abs(x), 1e-5))
    moved = [(_estimates(choice.library, choice.model, x + h) - base) / h.max() for h in steps]
    return np.array(moved).T


def _covariance(choice: Selection[Of], slope: Array, inverse: Array) -> Array:
    """C: the largest of several standard errors, times Student's t.

    They are the delete-a-block jackknife, Newey and West's error, and the posterior with a prior of one largest force. Known
    errors of the measured inputs are one more if present.
    """
    lib, model, x = choice.library, choice.model, choice.coefficients
    i = lib.index(model)
    natural = np.array(lib.natural)[i]
    total, r, j = lib.gram.sum(0), lib.residual(model, x), lib.columns[:, i]
    gram, rows = total[np.ix_(i, i)], len(r)
    blocks = _jackknife(lib.gram, i, natural, slope)
    moved = np.diag(gram) / natural
    prior = np.diag(np.maximum(moved, 1e-12 * np.max(moved)) * natural) / rows / lib.largest**2
    left = max(float(r @ r) / rows, 1e-12 * lib.largest**2)
    unseen = np.sqrt(np.diag(slope @ np.linalg.inv(gram / left + prior) @ slope.T))
    to_estimates = slope @ inverse
    known = sum((np.mean((d @ j @ to_estimates.T) ** 2, axis=0) for d in lib.drawn), np.zeros(len(slope)))
    both = np.max([blocks, newey_west(j, r, to_estimates), unseen, np.sqrt(known)], axis=0)
    return np.asarray(student.ppf(0.975, len(lib.gram) - 1) * both)


def _of_other_files(choice: Selection[Of], to_estimates: Array) -> Array:
    """C for another file, as the files differ; 0 with one file.

    It is the cluster-robust error of Liang and Zeger (Biometrika 73, 1986). A jackknife would fail where one file alone shows
    a number: without it, the others would give any value of it.
    """
    lib, i, x = choice.library, choice.library.index(choice.model), choice.coefficients
    files = np.array([lib.gram[lib.files == f].sum(0) for f in np.unique(lib.files)])
    if (n := len(files)) == 1:
        return np.zeros(len(to_estimates))
    pulls = (files[:, i, 0] - files[np.ix_(range(n), i, i)] @ x[: len(i)]) @ to_estimates.T
    return np.asarray(student.ppf(0.975, n - 1) * np.sqrt(n / (n - 1) * np.sum(pulls**2, axis=0)))


def _jackknife(gram: Array, i: list[int], natural: Array, slope: Array) -> Array:
    """Standard errors of the estimates by the jackknife: each part is left out once."""
    total, count = gram.sum(0), len(gram)
    left = [total - g for g in gram]
    left_out = np.array([slope @ (_inverse(g[np.ix_(i, i)], natural) @ g[i, 0]) for g in left])
    return np.asarray(np.sqrt((count - 1) / count * np.sum((left_out - left_out.mean(axis=0)) ** 2, axis=0)))


def _redrawn(choice: Selection[Of], base: Array, by_ratio: Array, draws: int) -> tuple[Array, Array, list[str]]:
    """A and B, and the form whose omission moves each estimate most."""
    lib, n, count = choice.library, choice.law, len(choice.library.gram)
    draw, again, moved = np.random.default_rng(0), list[Array](), list[Array]()
    good, which = list[bool](), list[set[str]]()
    for _ in range(draws):
        drawn = np.bincount(draw.integers(0, count, count), minlength=count).astype(float)
        withheld = {g for g in sorted(lib.groups) if draw.uniform() < SHARE}
        for shifts, without, alone in ((again, set[str](), choice.alone), (moved, withheld, False)):
            _, k, y, ratio = choice.choose(drawn, without, n, alone)
            shifts.append(_moved(_estimates(lib, lib.models[k], y), base, by_ratio))
        good.append(ratio <= WORSE)
        which.append(withheld)
    far = np.asarray(abs(np.array(moved)), float)
    a = np.quantile(abs(np.array(again)), AGAIN, axis=0) if choice.open else np.zeros(len(base))
    b = np.quantile(far[good], WITHHELD, axis=0) if any(good) else np.zeros(len(base))
    return np.asarray(a, float), np.asarray(b, float), _cause(choice, far, which)


def _moved(now: Array, base: Array, by_ratio: Array) -> Array:
    """The shift of estimates from a base; for shapes by the logarithm."""
    with np.errstate(all="ignore"):
        logs = base * np.log(np.maximum(now, 1e-12) / base)
    return np.where(by_ratio, logs, now - base)


def _cause(choice: Selection[Of], far: Array, which: list[set[str]]) -> list[str]:
    """The form of the reported model whose omission moves each estimate most.

    For a law alone, the form of its best extended model whose presence does.
    """
    chosen, sign = choice.model[1], 1.0
    if choice.alone:
        _, k, *_ = choice.choose(np.ones(len(choice.library.gram)), within=choice.law, alone=False)
        chosen, sign = choice.library.models[k][1], -1.0
    if not chosen:
        return [""] * far.shape[1]
    more = []
    for g in chosen:
        gone = np.array([g in each for each in which])
        apart = far[gone].mean(axis=0) - far[~gone].mean(axis=0) if gone.any() and not gone.all() else far[0] * 0
        more.append(sign * apart)
    return [chosen[int(i)] for i in np.argmax(np.array(more), axis=0)]


def _hidden(choice: Selection[Of], slope: Array, inverse: Array) -> tuple[Array, list[str]]:
    """H, and the hidden form that moves each estimate most."""
    lib, model, x = choice.library, choice.model, choice.coefficients
    j, r = lib.columns[:, lib.index(model)], lib.residual(model, x)
    noise = np.sqrt(max(float(r @ r) / len(r), 1e-12 * lib.largest**2))
    repeated = max(float(r[1:] @ r[:-1]) / len(r), 0.0)  # from row to row, as noise would not
    shifts, names = list[Array](), list[str]()
    for g, members in lib.groups.items():
        if g not in model[1]:
            column = lib.columns[:, members[0]]
            stands = inverse @ (j.T @ column)
            seen = float(np.sqrt(np.mean((column - j @ stands) ** 2)))
            shifts.append(slope @ stands * min(noise / max(seen, 1e-9), lib.largest_hidden(g, np.sqrt(repeated))))
            names.append(g)
    if not shifts:
        return np.zeros(len(slope)), [""] * len(slope)
    return np.sqrt(np.mean(np.square(shifts), axis=0)), [names[int(i)] for i in np.argmax(np.abs(shifts), axis=0)]


def newey_west(columns: Array, r: Array, to_estimates: Array) -> Array:
    """Standard errors of estimates with an autocorrelated residual."""
    n, score = len(r), columns * r[:, None]
    lags = int(min(max(BARTLETT * rows_together(r), BARTLETT), n // 6))
    meat = score.T @ score
    for lag in range(1, lags + 1):
        g = score[lag:].T @ score[:-lag]
        meat = meat + (1 - lag / (lags + 1)) * (g + g.T)
    of_freedom = n / max(n - columns.shape[1], 1)
    return np.asarray(np.sqrt(np.maximum(np.diag(to_estimates @ meat @ to_estimates.T) * of_freedom, 0)))


def _inverse(a: Array, natural: Array) -> Array:
    """The inverse of a Gram matrix; 0 for columns that are negligible relative to their ``natural`` mean squares."""
    d = np.sqrt(np.diag(a))
    moved = np.diag(a) / natural
    dead = moved <= DEAD * moved.max()
    d = np.where(dead, 1.0, d)
    scaled = np.linalg.inv(a / np.outer(d, d) + RIDGE * np.eye(len(a)))
    return np.asarray(np.where(dead[:, None] | dead, 0.0, scaled) / np.outer(d, d))
