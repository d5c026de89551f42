"""Energy drawn while the level swings: cycles of held speeds and levels, as machines that ``run`` replays."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.laws.base import Law
from stribeck.properties import cycles, damped, enclosed, replay
from stribeck.properties.model import Model
from stribeck.properties.plain import Json
from stribeck.properties.storage import Storage, own_speeds

_REPEATS = 100  # cycles in a run, at most: so many until more is drawn than winding up cost
_SPEEDS = 70
_AROUND = (
    0.3,
    0.1,
    0.03,
)  # of the deflection where damping that falls with speed loses least: how far off a cycle turns
_NEAR = (0.9, 0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-5)  # of the highest deflection: how far below it a cycle may turn


@dataclass(frozen=True)
class Swing:
    """z rises under one law, at a held speed, from ``low`` to ``high`` and falls under another back to ``low``.

    Attributes:
        rising, falling: the laws: the same with other constants.
        v_up, v_down: the held speeds, m/s.
        low, high: where z turns, m.
    """

    rising: Law
    falling: Law
    v_up: float
    v_down: float
    low: float
    high: float

    def pieces(self) -> list[tuple[Law, float, float, float]]:
        """(law, speed, from, to): the winding up from z = 0, and one cycle."""
        start = [(self.rising, self.v_up, 0.0, self.low)] if self.low > 0 else []
        return [*start, (self.rising, self.v_up, self.low, self.high), (self.falling, self.v_down, self.high, self.low)]

    def drawn(self) -> tuple[float, float] | None:
        """Bounds of the energy that one cycle draws, J, by interval arithmetic; None where these do not confirm it."""
        bounds = enclosed.programme([(Model(law), v, a, b) for law, v, a, b in self.pieces()[-2:]])
        return (-bounds[1], -bounds[0]) if bounds is not None and bounds[1] < 0 else None

    def evidence(self) -> dict[str, Json]:
        """Numbers for people."""
        rows = []
        for law, v, a, b in self.pieces():
            time, energy = cycles.integrate(law, v, a, b)
            level: dict[str, float] = {n: law.p.numbers[n] for n in ("F_c", "F_s") if n in law.values}
            rows.append({"v": v, **level, "duration": time, "z_end": b, "energy_in": energy})
        up, down = rows[-2:]
        drawn = -(up["energy_in"] + down["energy_in"])
        return {"energy_drawn_per_cycle": drawn, "time_per_cycle": up["duration"] + down["duration"], "programme": rows}

    def machine(self, nominal: Law) -> dict[str, Json] | None:
        """A machine file: a belt whose velocity is given, and a contact whose level is. E_in falls with every cycle, and
        is below 0 at the end; None for a law that no file holds."""
        table = replay.law_table(nominal)
        if table is None:
            return None
        rows = self.evidence()["programme"]
        start, (up, down) = rows[:-2], rows[-2:]
        cost, drawn = sum(row["energy_in"] for row in start), -(up["energy_in"] + down["energy_in"])
        repeats = min(max(1, math.ceil(1.2 * cost / drawn + 1)), _REPEATS)
        laws = [law for law, *_ in self.pieces()]
        order = [*range(len(start)), *list(range(len(start), len(rows))) * repeats]
        held = [(laws[i], rows[i]["v"], rows[i]["duration"]) for i in order]
        if not all(duration > 0 for *_, duration in held):
            return None
        ends = np.cumsum([duration for *_, duration in held]).tolist()
        factors = {
            name: {"signal": _steps(ends, [law.p.numbers[name] / nominal.p.numbers[name] for law, *_ in held])}
            for name in nominal.values
            if nominal.values[name] and any(law.p.numbers[name] != nominal.p.numbers[name] for law, *_ in held)
        }
        contact = {"from": "belt", "law": table, "factors": factors}
        return {
            "schema": 2, "name": "energy_drawn",
            "bodies": {"belt": {"velocity": {"signal": _steps(ends, [v for _, v, _ in held])}}},
            "contacts": {"contact": contact},
            "solve": {"t_end": ends[-1], "rtol": 1e-11, "max_steps": 1_000_000},
            "output": {"step": ends[-1] / replay.ROWS, "energy": True},
        }  # fmt: skip


def _steps(ends: list[float], values: list[float]) -> dict[str, Json]:
    """Points of a signal that holds each value until its end."""
    t: list[float] = []
    value: list[float] = []
    now = 0.0
    for end, x in zip(ends, values, strict=True):
        t += [now, end]
        value += [x, x]
        now = end
    return {"kind": "points", "t": t, "value": value}


def find(low: Law, high: Law, v_max: float | None = None) -> Iterator[Swing]:
    """Cycles between two levels that draw energy, the most convincing first."""
    stores = [Storage(law, v_max, float(law.z_bound(law.p))) for law in (high, low)]
    top = max(store.largest for store in stores)
    found, dips = [], _dips(low, v_max)
    for rising, falling in (stores, stores[::-1]):
        reach = min(rising.largest, top) * (1 - 1e-9)
        speeds = np.concatenate([_speeds(rising.law, falling.law, v_max), *([-v, v] for v, _ in dips)])
        grids = [np.linspace(reach * (1 - share), reach, 61) for share in _NEAR]
        for _, middle in (x for x in dips if x[1] < reach):
            grids += [np.linspace(middle * (1 - width), min(middle * (1 + width), reach), 61) for width in _AROUND]
        for grid in grids:
            best = cycles.best(rising, falling, speeds, speeds, grid)
            if best is not None:
                found.append((best[0], Swing(rising.law, falling.law, *best[1:])))
    for _, swing in sorted(found, key=lambda x: x[0]):
        yield swing


def _dips(law: Law, v_max: float | None) -> list[tuple[float, float]]:
    """The speed and the deflection, sigma_1(v) v/(2 sigma_0), at which damping that falls with speed loses least power."""
    p = law.p
    if law.values.get("v_d") is None:
        return []
    v = np.minimum(np.geomspace(1e-3, 3, 400) * p.v_d, v_max or np.inf)
    damping = p.sigma_1 * np.exp(-((v / p.v_d) ** 2))
    q = damped.unwinding(law, v, float(law.z_bound(p)))
    worst = int(np.argmax(damping**2 * q / (damping + p.sigma_2)))
    return [(float(v[worst]), float(damping[worst] * v[worst] / (2 * p.sigma_0)))]


def _speeds(a: Law, b: Law, v_max: float | None) -> Array:
    own = sorted(own_speeds(a) + own_speeds(b))
    top = v_max if v_max is not None else own[-1] * 1e10
    u = np.geomspace(min(own[0] * 1e-3, top * 1e-3), top, _SPEEDS)
    u[-1] = top
    return np.concatenate([-u[::-1], u])
