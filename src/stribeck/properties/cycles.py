"""Counterexamples of passivity: cycles of constant speeds that draw energy, at a constant or swinging level."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array, distinct
from stribeck.laws.base import Law
from stribeck.properties import damped, enclosed, replay
from stribeck.properties.model import Model
from stribeck.properties.plain import Json
from stribeck.properties.storage import Storage, own_speeds
from stribeck.properties.verdicts import Verdict

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)  # on each panel; for smooth dz/dt the error is rounding
_PANELS = 400  # of a path on which dz/dt may fall to _SLOW of its mean
_SLOW = 0.02  # of its mean: a smaller dz/dt ends a window, as the time would grow without limit
_SAFE = 1e-9  # net energy over exchanged energy: a smaller share could be rounding
_REPEATS = 100  # most cycles in a run, to draw more energy than the first winding up costs
_SWING_SPEEDS = 70  # of each sign, over 13 decades or more: 5 a decade, as in Storage
# Distances at which a cycle turns, over the deflection of least loss with falling damping.
_AROUND = (0.3, 0.1, 0.03)
_NEAR = (0.9, 0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-5)  # of the highest deflection: distances below it at which a cycle turns


Piece = tuple[Law, float, float, float]  # a law, a constant speed (m/s), and z at the start and at the end (m)


def rows(pieces: Sequence[Piece], *constants: str) -> list[dict[str, float]]:
    """A motion in pieces for the report, a row each, with these constants of its law."""
    listed = []
    for law, v, a, b in pieces:
        duration, energy = integrate(law, v, a, b)
        level = {n: law.p.numbers[n] for n in constants if n in law.values}
        listed.append({"v": v, **level, "duration": duration, "z_end": b, "energy_in": energy})
    return listed


def evidence(pieces: Sequence[Piece]) -> dict[str, Json]:
    """A motion that draws energy, for the report."""
    program = rows(pieces)
    drawn, time = -sum(row["energy_in"] for row in program), sum(row["duration"] for row in program)
    return {"energy_drawn": drawn, "time": time, "z_start": pieces[0][2], "program": program}


def integrate(law: Law, v: float, a: float, b: float) -> tuple[float, float]:
    """The duration, and the energy supplied, while a constant speed takes z from a to b."""
    edges = np.linspace(a, b, _PANELS + 1)
    half = 0.5 * np.diff(edges)
    z = (0.5 * (edges[1:] + edges[:-1]))[:, None] + half[:, None] * _NODES
    slowness = 1 / law.rate(v, z)
    weights = half[:, None] * _WEIGHTS
    return float((weights * slowness).sum()), float((weights * slowness * law.force(v, z) * v).sum())


def find(law: Law, storage: Storage) -> list[Piece] | None:
    """A short cycle that draws energy, or None."""
    deflection = abs(storage.worst[1]) if law.symmetric else storage.worst[1]
    candidates = [
        best(storage, storage, *_candidates(storage, deflection), points) for points in _windows(storage, deflection)
    ]
    feasible = [c for c in candidates if c is not None]
    if not feasible:
        return None
    _, up, down, low, high = min(feasible)
    if law.symmetric and low + high < 0:  # the mirrored cycle with positive z is easier to read
        up, down, low, high = -down, -up, -high, -low
    return _closed(law, up, down, low, high)


def unwinding(law: Law, storage: Storage, high: float, sign: int) -> list[Piece] | None:
    """A run from z = high that draws energy, or None.

    It draws more than a million times the energy that a spring would store there, or the largest energy of the search.
    """
    side = 1 if high > 0 else -1
    wanted = 1e6 * abs(float(law.force(0.0, high)) * high)
    speeds = abs(storage.v)
    most, best = 0.0, None
    for share in (1e-1, 1e-3, 1e-5, 1e-7):
        for speed in sign * np.geomspace(speeds[speeds > 0].min(), speeds.max(), 120):
            low = high * (1 - share)
            if side * law.rate(speed, low) < 0 and side * law.rate(speed, high) < 0:
                duration, energy = integrate(law, speed, high, low)
                if np.isfinite(energy) and np.isfinite(duration) and -energy > most:
                    most, best = -energy, [(law, float(speed), high, low)]
                if -energy > wanted:
                    return best
    return best


def _windows(storage: Storage, deflection: float) -> list[Array]:
    """Grids of z for the search: over the whole range, the natural length, and around the worst place."""
    r = storage.largest * (1 - 1e-9)
    wide = [np.linspace(-x, x, 101) for x in {r, min(r, 1.5 * storage.law.scales(storage.law.p).length)}]
    near = [deflection + share * abs(deflection) * np.linspace(-1, 1, 81) for share in (0.5, 0.05, 0.003)]
    edge = deflection + (storage.largest - abs(deflection)) * np.copysign(1, deflection) * np.linspace(-3, 0.9, 81)
    return [*wide, *(np.clip(np.sort(x), -r, r) for x in (*near, edge))]


def _candidates(storage: Storage, deflection: float) -> tuple[Array, Array]:
    law_speeds = own_speeds(storage.law)
    top = storage.v_max if storage.v_max is not None else law_speeds[-1] * 1e6
    u = np.logspace(np.log10(min(law_speeds[0] * 1e-3, top * 1e-3)), np.log10(top), 40)
    u[-1] = top
    _, _, v_low, v_high = storage.extremes(np.array([deflection]))
    speeds = np.concatenate([-u, [0.0], u])
    return np.append(speeds, v_high), np.append(speeds, v_low)


def best(
    rising: Storage, falling: Storage, ups: Array, downs: Array, z: Array
) -> tuple[float, float, float, float, float] | None:
    """The best (cost, v_up, v_down, low, high): a large share of energy drawn at moderate speed.

    ``rising`` and ``falling`` are the laws on both paths, which differ if the level does.
    """
    z = distinct(z)
    dz, fastest = np.gradient(z), own_speeds(rising.law)[-1]
    ups, f_up, e_up = _moving(rising, ups, z, 1)
    downs, f_down, e_down = _moving(falling, downs, z, -1)
    both = (f_up > 0)[:, None, :] & (f_down < 0)[None, :, :]
    gain = np.where(both, e_down[None, :, :] - e_up[:, None, :], -np.inf) * dz
    low, high, total = _largest_sums(gain)
    rows, columns = np.nonzero((total > 0) & (high - low >= 2))
    cheapest = None
    for i, j in zip(rows, columns, strict=True):
        window = _window(f_up[i], -f_down[j], int(low[i, j]), int(high[i, j]))
        if window is None:
            continue
        w = slice(window[0], window[1] + 1)
        share = float(gain[i, j, w].sum() / ((abs(e_up[i, w]) + abs(e_down[j, w])) * dz[w]).sum())
        if share > _SAFE:
            time = float((dz[w] / f_up[i, w] - dz[w] / f_down[j, w]).sum())
            fast = max(abs(ups[i]), abs(downs[j])) / fastest
            cost = _cost(share, time, fast, (z[window[1]] - z[window[0]]) / rising.largest)
            if cheapest is None or cost < cheapest[0]:
                cheapest = (cost, float(ups[i]), float(downs[j]), float(z[window[0]]), float(z[window[1]]))
    return cheapest


def _moving(storage: Storage, speeds: Array, z: Array, side: int) -> tuple[Array, Array, Array]:
    """The speeds that move z up (down) somewhere, with dz/dt and the energy per meter."""
    f, energy = storage.slopes(speeds[:, None], z)
    moving = (side * f > 0).any(axis=1)
    return speeds[moving], f[moving], energy[moving]


def _cost(share: float, time: float, fast: float, part: float) -> float:
    """The distance of a cycle from a convincing one: a visible share of energy, seconds, common speeds."""
    decades = 2 * max(0.0, float(np.log10(0.3 / share))) + max(0.0, float(np.log10(time)))
    return (
        decades + max(0.0, float(np.log10(fast))) + 0.2 * abs(float(np.log10(time))) + 0.5 * float(np.log10(2 / part))
    )


def _window(up: Array, down: Array, low: int, high: int) -> tuple[int, int] | None:
    """The part of a window in which z stalls on neither path."""
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


def _closed(law: Law, up: float, down: float, low: float, high: float) -> list[Piece]:
    """The cycle between two deflections.

    It begins at 0 if it passes 0, or else with the quicker path. After a long path, a short one would be lost in the
    rounding of time.
    """
    t_up, t_down = integrate(law, up, low, high)[0], integrate(law, down, high, low)[0]
    if low <= 0 <= high and 1e-3 < t_up / t_down < 1e3:
        start, path = 0.0, [(up, high), (down, low), (up, 0.0)]
    elif t_down < t_up:
        start, path = high, [(down, low), (up, high)]
    else:
        start, path = low, [(up, high), (down, low)]
    starts = [start, *(end for _, end in path)]
    return [(law, v, z, end) for z, (v, end) in zip(starts, path, strict=False) if end != z]


def scenario(law: Law, found: Mapping[str, Json]) -> dict[str, Json] | None:
    """A motion from its evidence as a scenario: E_in at its end is minus the energy drawn."""
    speeds, durations = ([row[name] for row in found["program"]] for name in ("v", "duration"))
    drive, end = replay.velocity_drive(speeds, durations)
    plant = {"initial": {"z": found["z_start"]}} if found["z_start"] else {}
    return replay.scenario_of(law, "passive", drive, end, plant, energy=True)


# -- while the level swings ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Swing:
    """A cycle in which z rises from ``low`` to ``high`` under one law and falls back under another.

    Attributes:
        rising, falling: the laws, which differ in their constants.
        v_up, v_down: the constant speeds, m/s.
        low, high: deflections at which z turns, m.
    """

    rising: Law
    falling: Law
    v_up: float
    v_down: float
    low: float
    high: float

    def pieces(self) -> list[Piece]:
        """The winding up from z = 0, and one cycle."""
        start = [(self.rising, self.v_up, 0.0, self.low)] if self.low > 0 else []
        return [*start, (self.rising, self.v_up, self.low, self.high), (self.falling, self.v_down, self.high, self.low)]

    def drawn(self) -> tuple[float, float] | None:
        """Bounds of the energy that one cycle draws, J, by interval arithmetic; None if they do not confirm it."""
        bounds = enclosed.program([(Model(law), v, a, b) for law, v, a, b in self.pieces()[-2:]])
        return (-bounds[1], -bounds[0]) if bounds is not None and bounds[1] < 0 else None

    def evidence(self) -> dict[str, Json]:
        """Values for the report."""
        program = rows(self.pieces(), "F_c", "F_s")
        up, down = program[-2:]
        drawn = -(up["energy_in"] + down["energy_in"])
        return {
            "energy_drawn_per_cycle": drawn,
            "time_per_cycle": up["duration"] + down["duration"],
            "program": program,
        }

    def machine(self, nominal: Law) -> dict[str, Json] | None:
        """A machine file with a belt of given velocity and a contact of given level, or None if a file cannot hold the law.

        E_in falls with every cycle, and is below 0 at the end.
        """
        table = replay.law_table(nominal)
        if table is None:
            return None
        found, laws = self.evidence(), [law for law, *_ in self.pieces()]
        steps = found["program"]
        cost, drawn = sum(row["energy_in"] for row in steps[:-2]), found["energy_drawn_per_cycle"]
        repeats = min(max(1, math.ceil(1.2 * cost / drawn + 1)), _REPEATS)
        order = [*range(len(steps) - 2), *[len(steps) - 2, len(steps) - 1] * repeats]
        held = [(laws[i], steps[i]["v"], steps[i]["duration"]) for i in order]
        if not all(duration > 0 for *_, duration in held):
            return None
        durations = [duration for *_, duration in held]
        factors = {
            name: {
                "signal": replay.held([law.p.numbers[name] / nominal.p.numbers[name] for law, *_ in held], durations)
            }
            for name in nominal.values
            if nominal.values[name] and any(law.p.numbers[name] != nominal.p.numbers[name] for law, *_ in held)
        }
        contact = {"from": "belt", "law": table, "factors": factors}
        velocity = replay.held([v for _, v, _ in held], durations)
        return {
            "schema": 2, "name": "energy_drawn",
            "bodies": {"belt": {"velocity": {"signal": velocity}}},
            "contacts": {"contact": contact},
            **replay.run_of(velocity["t"][-1], energy=True),
        }  # fmt: skip


def add_run(
    verdict: Verdict, tables: dict[str, Json] | None, z: str = "z", near: tuple[float, float] | None = None
) -> None:
    """Add a scenario to a counterexample if its simulation draws energy.

    Args:
        verdict: the counterexample.
        tables: of the scenario; None if a file cannot hold it.
        z: the column of the deflection.
        near: if given, z at the end and the largest difference from it, m.
    """
    solution = replay.run(tables)
    if solution is None or not solution.final["E_in"] < 0:
        return
    if near is None or abs(solution.final[z] - near[0]) <= near[1]:
        verdict.scenario = tables
        final = {name: solution.final[name] for name in ("E_in", z)}
        verdict.evidence |= {"energy_drawn": -final["E_in"], "replay": final}


def find_swings(low: Law, high: Law, v_max: float | None = None) -> Iterator[Swing]:
    """Cycles between two levels that draw energy, the most convincing first."""
    stores = [Storage(law, v_max, float(law.z_bound(law.p))) for law in (high, low)]
    top = max(store.largest for store in stores)
    rated, dips = [], _dips(low, v_max)
    for rising, falling in (stores, stores[::-1]):
        reach = min(rising.largest, top) * (1 - 1e-9)
        speeds = np.concatenate([_swing_speeds(rising.law, falling.law, v_max), *([-v, v] for v, _ in dips)])
        grids = [np.linspace(reach * (1 - share), reach, 61) for share in _NEAR]
        for _, middle in (x for x in dips if x[1] < reach):
            grids += [np.linspace(middle * (1 - width), min(middle * (1 + width), reach), 61) for width in _AROUND]
        for grid in grids:
            cycle = best(rising, falling, speeds, speeds, grid)
            if cycle is not None:
                rated.append((cycle[0], Swing(rising.law, falling.law, *cycle[1:])))
    for _, swing in sorted(rated, key=lambda x: x[0]):
        yield swing


def _dips(law: Law, v_max: float | None) -> list[tuple[float, float]]:
    """The speed, and the deflection sigma_1(v) v/(2 sigma_0), of the least power loss with falling damping."""
    p = law.p
    if law.values.get("v_d") is None:
        return []
    v = np.minimum(np.geomspace(1e-3, 3, 400) * p.v_d, v_max or np.inf)
    damping = p.sigma_1 * np.exp(-((v / p.v_d) ** 2))
    q = damped.unwinding(law, v, float(law.z_bound(p)))
    worst = int(np.argmax(damping**2 * q / (damping + p.sigma_2)))
    return [(float(v[worst]), float(damping[worst] * v[worst] / (2 * p.sigma_0)))]


def _swing_speeds(a: Law, b: Law, v_max: float | None) -> Array:
    law_speeds = sorted(own_speeds(a) + own_speeds(b))
    top = v_max if v_max is not None else law_speeds[-1] * 1e10
    u = np.geomspace(min(law_speeds[0] * 1e-3, top * 1e-3), top, _SWING_SPEEDS)
    u[-1] = top
    return np.concatenate([-u[::-1], u])
