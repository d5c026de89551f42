"""Beam search for the best sets of forms: every form is tried at every node of the shapes by Schur complements."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import accumulate

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.core.library import DEAD, IMPOSSIBLE, RIDGE, Model, ModelLibrary

BEAM, KEPT = 6, 250  # sets of forms kept at each depth, and models of all depths
MOST = 4  # forms of a model: six helped 3 and ruined 2 of 17 measured records
HARDLY = 1e-3  # of a column's square: a smaller part independent of the model cannot be separated from it
COST = 0.04  # fall of the log squared residual per column that pays in the beam: BIC with some 200 independent rows

Met = dict[tuple[int, frozenset[str]], tuple[float, tuple[str, ...]]]  # squared residual and forms, by node and set


def search_forms(lib: ModelLibrary) -> None:
    """Beam search: every form is added to each set of the beam at every node, and the best models are kept."""
    total, met, allowed = lib.gram.sum(0), Met(), {g: lib.allowed(g) for g in lib.groups}
    beam: list[tuple[str, ...]] = [()]
    for depth in range(MOST + 1):
        tried: dict[frozenset[str], tuple[float, tuple[str, ...]]] = {}
        for chosen in beam:
            _try_beside(lib, total, chosen, allowed if depth < MOST else {}, met, tried)
        beam = [c for _, c in sorted(tried.values(), key=lambda e: e[0])[:BEAM]]
    taken: list[Model] = []
    many = [0] * (MOST + 1)
    for (s, _), (_, chosen) in sorted(met.items(), key=lambda e: e[1][0]):
        if many[len(chosen)] < KEPT // (MOST + 1):
            taken.append((s, chosen))
            many[len(chosen)] += 1
    lib.keep(taken)


def _try_beside(
    lib: ModelLibrary, total: Array, chosen: tuple[str, ...], allowed: Mapping[str, Array], met: Met,
    tried: dict[frozenset[str], tuple[float, tuple[str, ...]]],
) -> None:  # fmt: skip
    """The squared residual of one set of forms at all nodes, and of this set with each other form that is allowed added."""
    nodes = range(len(lib.starts))
    a_i = np.array([lib.index((s, chosen)) for s in nodes])
    rest = {g: lib.groups[g] for g in allowed if g not in chosen}
    b_i = np.array([i for members in rest.values() for i in members], dtype=int)
    a = total[a_i[:, :, None], a_i[:, None, :]]
    d = np.sqrt(np.maximum(np.einsum("mii->mi", a), 1e-300))
    to_force = total[a_i, 0]
    b = np.concatenate([total[a_i[:, :, None], b_i[None, None]], to_force[:, :, None]], axis=2) / d[:, :, None]
    y = np.linalg.solve(a / d[:, :, None] / d[:, None, :] + RIDGE * np.eye(a_i.shape[1]), b)
    force, diag = total[0, 0], np.diag(total)[b_i]
    sse = np.maximum(force - np.einsum("mi,mi->m", b[:, :, -1], y[:, :, -1]), 1e-12 * force)
    left = diag - np.einsum("mij,mij->mj", b[:, :, :-1], y[:, :, :-1])
    share = total[b_i, 0] - np.einsum("mi,mij->mj", b[:, :, -1], y[:, :, :-1])
    fault = lib.fault(y[:, :, -1] / d)
    for s in nodes:
        met[s, frozenset(chosen)] = (float(sse[s] * fault[s]), chosen)
    for (g, members), end in zip(rest.items(), accumulate(map(len, rest.values())), strict=True):
        w = np.arange(end - len(members), end)
        ok = np.all(left[:, w] / diag[w] > HARDLY, axis=1) & allowed[g]
        of_form = total[b_i[w][:, None], b_i[w]] - np.einsum("mip,miq->mpq", b[:, :, w], y[:, :, w])
        of_form[:, range(len(w)), range(len(w))] += DEAD * diag[w]
        gain = np.einsum("mp,mp->m", share[:, w], np.linalg.solve(of_form, share[:, w, None])[..., 0])
        after = np.where(ok, np.maximum(sse - gain, 1e-12 * force) * np.where(fault >= IMPOSSIBLE, fault, 1.0), np.inf)
        new, key = (*chosen, g), frozenset((*chosen, g))
        cost = float(np.log(after.min())) + COST * sum(len(lib.groups[h]) for h in new)
        if np.isfinite(cost) and (key not in tried or cost < tried[key][0]):
            tried[key] = cost, new
        for s in np.argsort(after)[:3].tolist():
            if np.isfinite(after[s]):
                met.setdefault((s, key), (float(after[s]), new))
