"""Cycles of held speeds that draw energy: the counterexamples of passivity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.laws.base import Law
from stribeck.properties import replay
from stribeck.properties.plain import Json
from stribeck.properties.storage import Storage, own_speeds

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
_PANELS = 400
_SLOW = 0.02  # share of its mean below which dz/dt ends a window: the time would grow without limit
_SAFE = 1e-9  # net energy drawn as a share of what flows, below which rounding could have made it


@dataclass(frozen=True)
class Cycle:
    """z goes from ``start`` through a closed path; each piece holds a speed. Energies are put in, J."""

    start: float
    speeds: tuple[float, ...]
    turns: tuple[float, ...]  # z at the end of each piece
    durations: tuple[float, ...]
    energies: tuple[float, ...]

    @property
    def drawn(self) -> float:
        """Net energy drawn, J."""
        return -sum(self.energies)

    @property
    def time(self) -> float:
        """How long it takes, s."""
        return sum(self.durations)

    def evidence(self) -> dict[str, Json]:
        """Numbers for people."""
        return {
            "energy_drawn": self.drawn, "time": self.time, "z_start": self.start,
            "programme": [
                {"v": v, "duration": d, "z_end": z, "energy_in": e}
                for v, d, z, e in zip(self.speeds, self.durations, self.turns, self.energies, strict=True)
            ],
        }  # fmt: skip


def integrate(law: Law, v: float, a: float, b: float) -> tuple[float, float]:
    """Time and energy put in while a held speed takes z from a to b."""
    edges = np.linspace(a, b, _PANELS + 1)
    half = 0.5 * np.diff(edges)
    z = (0.5 * (edges[1:] + edges[:-1]))[:, None] + half[:, None] * _NODES
    slowness = 1 / law.rate(v, z)
    weights = half[:, None] * _WEIGHTS
    return float((weights * slowness).sum()), float((weights * slowness * law.force(v, z) * v).sum())


def find(law: Law, storage: Storage) -> Cycle | None:
    """A short cycle that draws energy; None where none was found."""
    at = abs(storage.worst[1]) if law.symmetric else storage.worst[1]
    candidates = [best(storage, storage, *_candidates(storage, at), points) for points in _windows(storage, at)]
    found = [c for c in candidates if c is not None]
    if not found:
        return None
    _, up, down, low, high = min(found)
    if law.symmetric and low + high < 0:  # the same cycle for positive z is easier to read
        up, down, low, high = -down, -up, -high, -low
    return _closed(law, up, down, low, high)


def unwinding(law: Law, storage: Storage, high: float, sign: int) -> Cycle | None:
    """A run from z = high that draws more than a million times the energy that a spring would keep there, or the most
    that was found; None where none draws any."""
    side = 1 if high > 0 else -1
    wanted = 1e6 * abs(float(law.force(0.0, high)) * high)
    speeds = abs(storage.v)
    found: Cycle | None = None
    for share in (1e-1, 1e-3, 1e-5, 1e-7):
        for speed in sign * np.geomspace(speeds[speeds > 0].min(), speeds.max(), 120):
            low = high * (1 - share)
            if side * law.rate(speed, low) < 0 and side * law.rate(speed, high) < 0:
                time, energy = integrate(law, float(speed), high, low)
                if np.isfinite(time) and np.isfinite(energy) and (found is None or energy < found.energies[0]):
                    found = Cycle(high, (float(speed),), (low,), (time,), (energy,))
                if energy < -wanted:
                    return found
    return found if found is not None and found.drawn > 0 else None


def _windows(storage: Storage, at: float) -> list[Array]:
    """Grids of z in which to look for a cycle: over all of the range, the natural length, and around the worst place."""
    r = storage.largest * (1 - 1e-9)
    wide = [np.linspace(-x, x, 101) for x in {r, min(r, 1.5 * storage.law.scales(storage.law.p).length)}]
    near = [at + share * abs(at) * np.linspace(-1, 1, 81) for share in (0.5, 0.05, 0.003)]
    edge = at + (storage.largest - abs(at)) * np.copysign(1, at) * np.linspace(-3, 0.9, 81)
    return [*wide, *(np.clip(np.sort(x), -r, r) for x in (*near, edge))]


def _candidates(storage: Storage, at: float) -> tuple[Array, Array]:
    own = own_speeds(storage.law)
    top = storage.v_max if storage.v_max is not None else own[-1] * 1e6
    u = np.logspace(np.log10(min(own[0] * 1e-3, top * 1e-3)), np.log10(top), 40)
    u[-1] = top
    _, _, v_low, v_high = storage.extremes(np.array([at]))
    speeds = np.concatenate([-u, [0.0], u])
    return np.append(speeds, v_high), np.append(speeds, v_low)


def best(
    rising: Storage, falling: Storage, ups: Array, downs: Array, z: Array
) -> tuple[float, float, float, float, float] | None:
    """The best (cost, v_up, v_down, low, high): much energy for what flows, neither slow nor fast.

    ``rising`` and ``falling`` hold the laws on the two ways, which are two where the level differs.
    """
    z = np.unique(z)
    dz, fastest = np.gradient(z), own_speeds(rising.law)[-1]
    f_up, e_up = rising.slopes(ups[:, None], z)
    f_down, e_down = falling.slopes(downs[:, None], z)
    both = (f_up > 0)[:, None, :] & (f_down < 0)[None, :, :]
    gain = np.where(both, e_down[None, :, :] - e_up[:, None, :], -np.inf) * dz
    low, high, total = _largest_sums(gain)
    rows, columns = np.nonzero((total > 0) & (high - low >= 2))
    found_best = None
    for i, j in zip(rows, columns, strict=True):
        found = _window(f_up[i], -f_down[j], int(low[i, j]), int(high[i, j]))
        if found is None:
            continue
        w = slice(found[0], found[1] + 1)
        share = float(gain[i, j, w].sum() / ((abs(e_up[i, w]) + abs(e_down[j, w])) * dz[w]).sum())
        if share > _SAFE:
            time = float((dz[w] / f_up[i, w] - dz[w] / f_down[j, w]).sum())
            fast = max(abs(ups[i]), abs(downs[j])) / fastest
            cost = _cost(share, time, fast, (z[found[1]] - z[found[0]]) / rising.largest)
            if found_best is None or cost < found_best[0]:
                found_best = (cost, float(ups[i]), float(downs[j]), float(z[found[0]]), float(z[found[1]]))
    return found_best


def _cost(share: float, time: float, fast: float, part: float) -> float:
    """How far a cycle is from one that is easy to believe: energy of a visible share, seconds, common speeds."""
    decades = 2 * max(0.0, float(np.log10(0.3 / share))) + max(0.0, float(np.log10(time)))
    return (
        decades + max(0.0, float(np.log10(fast))) + 0.2 * abs(float(np.log10(time))) + 0.5 * float(np.log10(2 / part))
    )


def _window(up: Array, down: Array, low: int, high: int) -> tuple[int, int] | None:
    """The part of a window in which neither way stalls."""
    a, b = up[low : high + 1], down[low : high + 1]
    keep = (a >= _SLOW * a.mean()) & (b >= _SLOW * b.mean())
    if not keep.all():
        low, high = _longest(keep, low)
    return (low, high) if high - low >= 2 else None


def _largest_sums(gain: Array) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Along the last axis, the interval with the largest sum, and that sum (Kadane)."""
    shape = gain.shape[:-1]
    best, low, high = np.full(shape, -np.inf), np.zeros(shape, int), np.zeros(shape, int)
    total, start = np.full(shape, -np.inf), np.zeros(shape, int)
    for k in range(gain.shape[-1]):
        fresh = ~(total > 0)
        total = np.where(fresh, gain[..., k], total + gain[..., k])
        start = np.where(fresh, k, start)
        better = total > best
        best, low, high = np.where(better, total, best), np.where(better, start, low), np.where(better, k, high)
    return low, high, best


def _longest(keep: NDArray[np.bool_], offset: int) -> tuple[int, int]:
    best, start = (0, 0), 0
    for k, ok in enumerate(np.append(keep, False)):
        if not ok:
            if k - 1 - start > best[1] - best[0]:
                best = (start, k - 1)
            start = k + 1
    return best[0] + offset, best[1] + offset


def _closed(law: Law, up: float, down: float, low: float, high: float) -> Cycle:
    """The cycle between two deflections as pieces: from 0 where it passes it, else with the quicker way first, so that
    a short way after a long one does not drown in the rounding of the time."""
    t_up, t_down = integrate(law, up, low, high)[0], integrate(law, down, high, low)[0]
    if low <= 0 <= high and 1e-3 < t_up / t_down < 1e3:
        start, path = 0.0, [(up, high), (down, low), (up, 0.0)]
    elif t_down < t_up:
        start, path = high, [(down, low), (up, high)]
    else:
        start, path = low, [(up, high), (down, low)]
    pieces, z = [], start
    for v, end in path:
        if end != z:
            pieces.append((v, end, *integrate(law, v, z, end)))
            z = end
    speeds, turns, durations, energies = zip(*pieces, strict=True)
    return Cycle(start, speeds, turns, durations, energies)


def scenario(law: Law, cycle: Cycle) -> dict[str, Json] | None:
    """The cycle as a scenario: E_in at its end is minus the energy drawn."""
    drive, end = replay.velocity_drive(cycle.speeds, cycle.durations)
    plant = {"initial": {"z": cycle.start}} if cycle.start else {}
    return replay.scenario_of(law, "passive", drive, end, plant, energy=True)
