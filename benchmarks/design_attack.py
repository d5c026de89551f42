"""`stribeck design` on machines that it has not seen, against long simulations on equations written apart: the verdict of
the file, from other starts, along a range and on both sides of every reported boundary, 5 % away; and the factor by which
compensation lowers the error after a reversal.

The verdicts' machines are simulated by design_attack.c and judged here. The factors are found by SciPy on the equations of
tests/reference/apart.py, which also verify design_attack.c on the first seconds of each machine.
"""

from __future__ import annotations

import ctypes
import json
import math
import time
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
from measure import Given, compiled, run, say

import stribeck
from stribeck.arrays import Array
from stribeck.loops.judge import IRREGULAR, judge
from stribeck.loops.loop import loop_of
from tests.machine.machines import edited, law, machine
from tests.reference.apart import solve

AWAY = 0.05
POINTS = 10  # of each machine
CHUNK = 25  # slowest time constants between two looks of the judgment apart
ROWS = 250  # of a chunk
REST = 1e-6  # of its travel, or of the file's move: rest of a body without an encoder
LONGEST = 40_000  # slowest time constants that are simulated at most
MOVING = 5_000  # the same of irregular swings: whether and when they come to rest later is chance
BY_CHANCE = 100  # slowest time constants of swings before rest, from which on an irregular cycle may rest by chance
FIELDS = dict.fromkeys(
    ("m", "sigma_0", "sigma_1", "sigma_2", "F_c", "F_s", "v_s", "K_p", "K_i", "K_d", "r", "limit", "period", "delay",
     "resolution", "t", "x", "low", "high", "h", "u", "total", "last", "taken", "act", "asked", "first", "count"), 1,
) | {"x": 4, "act": 256, "asked": 256}  # fmt: skip
Data = dict[str, Any]


def axis(random: np.random.Generator) -> Data:
    """A mass on a guide under a controller."""
    mass, level, sigma_0 = 10 ** random.uniform(-0.3, 0.7), 10 ** random.uniform(0, 1), 10 ** random.uniform(3.7, 4.7)
    guide = law(
        "lugre", sigma_0=sigma_0, sigma_1=float(2 * random.uniform(0.3, 0.8) * np.sqrt(sigma_0 * mass)),
        sigma_2=float(random.uniform(0.3, 3) * mass), F_c=level, F_s=level * random.uniform(1.2, 1.6),
        v_s=10 ** random.uniform(-2.5, -1.7),
    )  # fmt: skip
    signal = {"kind": "step", "time": 0.0, "value": random.uniform(0.5, 1.5)}
    hold = {"kind": "pid", "on": "a", "measures": "a", "signal": signal}
    contacts, controllers = {"guide": {"from": "a", "law": guide}}, {"hold": hold}
    return machine({"a": {"mass": mass}}, 1.0, 100, energy=False, contacts=contacts, controllers=controllers)


def machines(random: np.random.Generator, count: int) -> list[tuple[str, Data, str]]:
    """Machines, each with a number to vary: what integral, stiction, damping, delay and encoder do."""
    results = []
    for i in range(count):
        kind = ("integral", "stiction", "damping", "delay", "encoder")[i % 5]
        w, damping = 10 ** random.uniform(0.3, 1.0), random.uniform(0.7, 1.2)
        data = axis(random)
        m, own = data["bodies"]["a"]["mass"], data["controllers"]["hold"]
        friction = data["contacts"]["guide"]["law"]["parameters"]
        own |= {"K_p": m * w**2, "K_d": 2 * damping * w * m}
        own["signal"]["value"] = float(random.uniform(8, 20) * friction["F_s"] / own["K_p"])  # enough to break away
        routh = own["K_p"] * (own["K_d"] + friction["sigma_2"]) / m
        if kind == "delay":
            period = 0.05 / w
            own |= {"sampling": {"period": period, "delay": period}, "limit": 1e3 * m * w**2}
            vary = f"controllers.hold.sampling.delay={period / 2}:{2 / w}"
        elif kind == "encoder":
            period = 0.02 / w
            own |= {"K_i": random.uniform(0.02, 0.3) * routh, "limit": 50 * friction["F_s"]}
            own["sampling"] = {"period": period, "delay": period / 2, "resolution": own["signal"]["value"] / 5000}
            vary = f"controllers.hold.K_d={0.3 * own['K_d']}:{10 * own['K_d']}"
        elif kind == "integral":
            own |= {"K_i": 0.3 * routh}
            vary = f"controllers.hold.K_i={0.03 * routh}:{3 * routh}"
        elif kind == "stiction":
            own |= {"K_i": 0.25 * routh}
            friction["F_s"] = 1.3 * friction["F_c"]
            vary = f"contacts.guide.law.parameters.F_s={friction['F_c']}:{2 * friction['F_c']}"
        else:
            own |= {"K_i": 0.2 * routh}
            vary = f"controllers.hold.K_d={0.3 * own['K_d']}:{30 * own['K_d']}"
        results.append((kind, data, vary))
    return results


class Apart(ctypes.Structure):
    """The machine's motion from a start, by design_attack.c; the fields are those of its Loop."""

    _fields_: ClassVar[Any] = [(name, n * ctypes.c_double if n > 1 else ctypes.c_double) for name, n in FIELDS.items()]

    def __init__(self, data: Data, y: float = 0.0, v: float = 0.0) -> None:
        own, law = data["controllers"]["hold"], data["contacts"]["guide"]["law"]["parameters"]
        gains = {name: own.get(name, 0.0) for name in ("K_p", "K_i", "K_d")}
        limit, mass, target = own.get("limit", math.inf), data["bodies"]["a"]["mass"], own["signal"]["value"]
        super().__init__(**law, **gains, **own.get("sampling", {}), m=mass, r=target, limit=limit, h=1e-6)
        self.x[0], self.x[1] = y, v

    def on(self, seconds: float) -> tuple[Array, float]:
        """The positions over the next seconds, and the mean output in the second half of these less that in the first; of a
        continuous controller, the mean of its integral part."""
        rows = int(seconds / self.period) + 2 if self.period else ROWS + 1
        y, u = np.zeros(rows), np.zeros(rows)
        columns = (ctypes.c_void_p(x.ctypes.data) for x in (y, u))
        written = solver().march(ctypes.byref(self), ctypes.c_double(seconds), rows, *columns)
        half = written // 2
        return y[:written], float(u[half:written].mean() - u[:half].mean())


@cache
def solver() -> ctypes.CDLL:
    """The compiled design_attack.c."""
    return compiled(Path(__file__).with_suffix(".c"), "-O3")


def against_scipy(data: Data, seconds: float) -> float:
    """The largest difference of the two simulators apart, as a share of the travel."""
    sampling = data["controllers"]["hold"].get("sampling", {"period": seconds / ROWS})
    data = edited(data, {"solve.t_end": seconds, "output.step": sampling["period"]})
    y, result = Apart(data).on(seconds)[0], solve(data, 1e-9)["a.y"]
    count = min(len(y), len(result))
    return float(np.abs(y[:count] - result[:count]).max() / np.ptp(result))


def verdict(data: Data, slowest: float, start: tuple[float, float] = (0.0, 0.0)) -> tuple[str, float, float]:
    """What the independent solution goes on doing: its word, its peak to peak at the end, and until when it moved.

    It rests when it has not moved for half of all the time that was simulated and friction holds an output that has stopped;
    it hunts when sixteen stretches in a row swing alike; otherwise it is simulated on.
    """
    motion, c = Apart(data, *start), data["controllers"]["hold"]
    F_s, move = data["contacts"]["guide"]["law"]["parameters"]["F_s"], abs(start[0] - c["signal"]["value"])
    resolution = c.get("sampling", {}).get("resolution", 0.0)
    longest = LONGEST * slowest
    low, high, swings, moved = start[0], start[0], list[float](), 0.0
    stretch = CHUNK * slowest
    while motion.t < longest:
        y, charged = motion.on(stretch)
        if not np.isfinite(y).all() or np.abs(y - c["signal"]["value"]).max() > 1e3 * max(move, 1e-3):
            return "unstable", math.inf, motion.t
        low, high, swing = min(low, motion.low), max(high, motion.high), motion.high - motion.low
        rest = max(REST * max(high - low, c["signal"]["value"]), resolution)
        if swing > rest:
            moved, stretch = motion.t, CHUNK * slowest
            swings.append(swing)
            far = swings[-16:]
            drifts = abs(y[-1] - y[0]) > 0.5 * swing  # an integral that relaxes through its bristles
            if len(far) == 16 and not drifts and motion.t > 400 * slowest and max(far) < 1.02 * min(far) + 0.2 * rest:
                limit = c.get("limit", math.inf)
                return ("unstable" if swing > 0.1 * limit / c["K_p"] else "hunting"), swing, motion.t
            if motion.t > MOVING * slowest and not drifts:
                break
            continue
        swings = []
        if motion.t > 2 * moved + 200 * slowest and abs(charged) * longest / stretch < 0.5 * F_s:
            return "quiet", swing, moved
        stretch = min(1.5 * stretch, 1e3 * slowest)
    if not swings:
        return "quiet", swing, moved
    return ("unstable" if swings[-1] > 2 * swings[-16:][0] else "hunting"), swing, motion.t


def same(expected: str, found: str, strict: bool) -> bool:
    """Quiet against what moves: hunting and unstable both oscillate, and a limit decides which it is called; ``strict`` where
    the boundary is one between these two."""
    moves = {"hunting", "unstable"}
    return expected == found or (not strict and expected in moves and found in moves)


class Asked(NamedTuple):
    """A judgment that is checked: where it stands, of what machine and start, its word, and whether hunting and unstable
    count as different."""

    at: str
    data: Data
    said: str
    start: tuple[float, float] = (0.0, 0.0)
    strict: bool = False


def verdicts(kind: str, data: Data, vary: str, random: np.random.Generator) -> list[Data]:
    """Rows: the file's own verdict, three starts, both sides of each boundary named, and points of the range."""
    result = stribeck.design(stribeck.Scenario(data), vary=[vary])
    line, rest = result.lines[0], data["controllers"]["hold"]["signal"]["value"]
    asked = [Asked("file", data, result.verdict)]
    for i in random.choice(len(result.starts), 3, replace=False):
        begun = result.starts[i]
        at = f"start {begun.off:.3g} {begun.speed:.3g}"
        asked.append(Asked(at, data, begun.judgment.verdict, (rest + begun.off, begun.speed)))
    sides = [(b, 1 - AWAY, b.below) for b in line.boundaries] + [(b, 1 + AWAY, b.above) for b in line.boundaries]
    for b, share, text in sides[: POINTS - len(asked)]:
        x = share * b.value
        if line.turned.low <= x <= line.turned.high:
            strict = {b.below, b.above} == {"hunting", "unstable"}
            asked.append(Asked(f"{b.path} = {x:.6g}", edited(data, {b.path: x}), text, strict=strict))
    clear = [i for i, x in enumerate(line.values) if not any(m.low <= x <= m.high for m in line.mixed)]
    for i in random.permutation(clear)[: POINTS - len(asked)]:
        x, path = float(line.values[i]), line.turned.path
        asked.append(Asked(f"{path} = {x:.6g}", edited(data, {path: x}), line.judgments[i].verdict))
    rows = []
    for each in asked:
        begun_at, slowest = time.process_time(), loop_of(stribeck.Scenario(each.data)).slowest
        got, size, moved = verdict(each.data, slowest, each.start)
        rows.append(
            {"kind": kind, "at": each.at, "said": each.said, "found": got, "agrees": same(each.said, got, each.strict),
             "peak_to_peak": size if math.isfinite(size) else None, "seconds": round(time.process_time() - begun_at, 1)}
        )  # fmt: skip
        if not rows[-1]["agrees"]:
            rows[-1] |= {"machine": each.data, "start": each.start, "chance": by_chance(each, got, moved / slowest)}
        say(json.dumps(rows[-1]))
    return rows


def by_chance(each: Asked, got: str, moved: float) -> bool:
    """Whether an irregular cycle came to rest in the end, and the judgment says that it may.

    Behind an encoder, such a cycle rests where a swing happens to end within friction's reach: a gain that differs by 1e-9
    moves that by hundreds of seconds, so that no simulation can tell when.
    """
    data = edited(each.data, {"bodies.a.initial": {"y": each.start[0], "v": each.start[1]}})
    return got == "quiet" and moved > BY_CHANCE and judge(loop_of(stribeck.Scenario(data)))[0].note == IRREGULAR


def reversal(data: Data) -> float:
    """The largest error within an eighth of a period after the reversals of the machine's sine, but its first wave."""
    T = 1 / data["controllers"]["hold"]["signal"]["frequency"]
    solution = solve(edited(data, {"solve.t_end": 4 * T, "output.step": T / 1000}), 1e-9)
    t, e = np.asarray(solution["t"]), np.asarray(solution["hold.r"]) - np.asarray(solution["a.y"])
    near = ((t / T - 0.25) % 0.5 <= 0.125) & (t >= T)
    return float(np.abs(e[near]).max())


def compensation(random: np.random.Generator, sampled: bool = False) -> list[Data]:
    """The factor by which each compensation lowers the error after a reversal: stated, and found."""
    data = axis(random)
    m, w = data["bodies"]["a"]["mass"], 10 ** random.uniform(0.8, 1.3)
    frequency = w / 2 / np.pi / 15
    own = data["controllers"]["hold"] | {"K_p": m * w**2, "K_d": 1.6 * w * m}
    own["signal"] = {"kind": "sine", "amplitude": 0.05, "frequency": float(frequency)}
    data["controllers"]["hold"] = own
    data["solve"]["t_end"] = float(2 / frequency)  # the standard sine is then the file's
    if sampled:
        period = 0.02 / w
        own["sampling"] = {"period": period, "delay": 0.5 * period, "resolution": 1e-7}
    result = stribeck.design(stribeck.Scenario(data), compensate=True)
    rows, before = [], reversal(data)
    for c in result.compensations:
        table = c.loop.scenario.data["controllers"]["hold"].get("compensation")
        if c.dither is not None:
            given = {"controllers.hold.dither": {n: c.dither[n] for n in ("kind", "amplitude", "frequency")}}
        elif table is not None:
            given = {"controllers.hold.compensation": {**table, "share": c.share}}
        else:
            continue
        text = result.compensations[0].reversal_error / c.reversal_error
        got = before / reversal(edited(data, given))
        agrees = bool(abs(got / text - 1) <= 0.2)
        rows.append({"kind": c.kind, "share": c.share, "said": text, "found": got, "agrees": agrees})
        say(json.dumps(rows[-1]))
    return rows


def benchmark(given: Given) -> dict[str, Any]:
    """Run both; rows are said as they come."""
    random, begun = np.random.default_rng(given.seed), time.process_time()
    factors = [row for i in range(given.axes) for row in compensation(random, sampled=bool(i % 2))]
    rows: list[Data] = []
    differences: list[float] = []
    for kind, data, vary in machines(random, given.machines):
        differences.append(against_scipy(data, CHUNK * loop_of(stribeck.Scenario(data)).slowest))
        rows += verdicts(kind, data, vary, random)
    about = {"seed": given.seed, "seconds": round(time.process_time() - begun), "difference_to_scipy": differences}
    return {**about, "verdicts": rows, "factors": factors}


if __name__ == "__main__":
    run(benchmark, __doc__, "design_attack", machines=(20, 1), axes=(3, 1), seed=1)
