"""`stribeck design` on machines that it has not seen, against long simulations by SciPy on equations written apart: the
verdict of the file, from other starts, along a range and on both sides of every boundary named, 5 % away; and the factor by
which compensation lowers the error after a reversal.

The equations and the judgement of the verdicts' machines stand here, the equations of the factors are
tests/machine/independent.py. Takes minutes.
"""

from __future__ import annotations

import json
import math
import sys
import time
from copy import deepcopy
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
from measure import machine, options, write
from scipy.integrate import odeint

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

import stribeck  # noqa: E402
from stribeck.arrays import Array  # noqa: E402
from stribeck.loops.judge import IRREGULAR, judge  # noqa: E402
from stribeck.loops.loop import loop_of  # noqa: E402
from tests.machine.independent import solve  # noqa: E402

AWAY = 0.05
POINTS = 10  # of each machine
CHUNK = 25  # slowest time constants between two looks of the judgement apart
ROWS = 250  # of a chunk
REST = 1e-6  # of its travel, or of the file's move: rest of a body without an encoder
LONGEST, LONGEST_SAMPLED = 40_000, 1_500  # slowest time constants that are simulated, at rest
MOVING = 1_500  # the same of what moves on, alike or not
BY_CHANCE = 100  # slowest time constants of swings before rest, from which on an irregular cycle may rest by chance
Data = dict[str, Any]


def axis(random: np.random.Generator, controller: Data, contact: Data | None = None) -> Data:
    """A mass on a guide under a controller."""
    mass, level = 10 ** random.uniform(-0.3, 0.7), 10 ** random.uniform(0, 1)
    sigma_0 = 10 ** random.uniform(3.7, 4.7)
    law = {
        "name": "lugre",
        "parameters": {
            "sigma_0": sigma_0, "sigma_1": float(2 * random.uniform(0.3, 0.8) * np.sqrt(sigma_0 * mass)),
            "sigma_2": float(random.uniform(0.3, 3) * mass), "F_c": level, "F_s": level * random.uniform(1.2, 1.6),
            "v_s": 10 ** random.uniform(-2.5, -1.7),
        },
    }  # fmt: skip
    own = {
        "on": "a",
        "measures": "a",
        "signal": {"kind": "step", "time": 0.0, "value": random.uniform(0.5, 1.5)},
        **controller,
    }
    return {
        "schema": 2, "name": "attack", "bodies": {"a": {"mass": mass}},
        "contacts": {"guide": {"from": "a", "law": contact or law}}, "controllers": {"hold": own}, "solve": {"t_end": 1.0},
        "output": {"step": 0.01},
    }  # fmt: skip


def machines(random: np.random.Generator, count: int) -> list[tuple[str, Data, str]]:
    """Machines, each with a number to vary: what integral, stiction, damping, delay and encoder do."""
    found = []
    for i in range(count):
        kind = ("integral", "stiction", "damping", "delay", "encoder")[i % 5]
        w, damping = 10 ** random.uniform(0.3, 1.0), random.uniform(0.7, 1.2)
        data = axis(random, {"kind": "pid"})
        m, own = data["bodies"]["a"]["mass"], data["controllers"]["hold"]
        law = data["contacts"]["guide"]["law"]["parameters"]
        own |= {"K_p": m * w**2, "K_d": 2 * damping * w * m}
        own["signal"]["value"] = float(random.uniform(8, 20) * law["F_s"] / own["K_p"])  # enough to break away
        routh = own["K_p"] * (own["K_d"] + law["sigma_2"]) / m
        if kind == "delay":
            period = 0.05 / w
            own |= {"sampling": {"period": period, "delay": period}, "limit": 1e3 * m * w**2}
            vary = f"controllers.hold.sampling.delay={period / 2}:{2 / w}"
        elif kind == "encoder":
            period = 0.02 / w
            own |= {"K_i": random.uniform(0.02, 0.3) * routh, "limit": 50 * law["F_s"]}
            own["sampling"] = {"period": period, "delay": period / 2, "resolution": own["signal"]["value"] / 5000}
            vary = f"controllers.hold.K_d={0.3 * own['K_d']}:{10 * own['K_d']}"
        elif kind == "integral":
            own |= {"K_i": 0.3 * routh}
            vary = f"controllers.hold.K_i={0.03 * routh}:{3 * routh}"
        elif kind == "stiction":
            own |= {"K_i": 0.25 * routh}
            law["F_s"] = 1.3 * law["F_c"]
            vary = f"contacts.guide.law.parameters.F_s={law['F_c']}:{2 * law['F_c']}"
        else:
            own |= {"K_i": 0.2 * routh}
            vary = f"controllers.hold.K_d={0.3 * own['K_d']}:{30 * own['K_d']}"
        found.append((kind, data, vary))
    return found


def changed(data: Data, path: str, value: float) -> Data:
    """The machine with one number replaced."""
    data = deepcopy(data)
    *words, last = path.split(".")
    place: Any = data
    for word in words:
        place = place[word]
    if last not in place and "parameters" in place:
        place = place["parameters"]
    place[last] = value
    return data


class Apart:
    """The machine's motion from a start: mass, LuGre, PID, written here in plain floats and solved by SciPy's LSODA."""

    how: ClassVar[dict[str, Any]] = {"rtol": 1e-8, "atol": [1e-11, 1e-11, 1e-13, 1e-11], "mxstep": 1_000_000}

    def __init__(self, data: Data, y: float = 0.0, v: float = 0.0) -> None:
        self.m, self.c = data["bodies"]["a"]["mass"], data["controllers"]["hold"]
        self.p = data["contacts"]["guide"]["law"]["parameters"]
        self.r, self.limit = self.c["signal"]["value"], self.c.get("limit", math.inf)
        self.x, self.t, self.u = np.array([y, v, 0.0, 0.0]), 0.0, 0.0
        self.last: float | None = None
        self.total, self.taken, self.asked = 0.0, 0, list[tuple[float, float]]()

    def rates(self, x: Array, _: float, u: float | None = None) -> list[float]:
        """Of position, speed, deflection and the error's integral, under a held output or the controller's own."""
        p, c = self.p, self.c
        y, v, z, total = x
        if u is None:
            u = -c["K_p"] * (y - self.r) - c.get("K_i", 0.0) * total - c["K_d"] * v
        g = p["F_c"] + (p["F_s"] - p["F_c"]) * math.exp(-min((v / p["v_s"]) ** 2, 700.0))
        dz = v - p["sigma_0"] * abs(v) / g * z
        return [v, (u - p["sigma_0"] * z - p["sigma_1"] * dz - p["sigma_2"] * v) / self.m, dz, y - self.r]

    def on(self, seconds: float) -> tuple[Array, float]:
        """The positions over the next seconds, and the mean output in the second half of these less that in the first."""
        if "sampling" in self.c:
            return self._sampled(seconds)
        x = odeint(self.rates, self.x, np.linspace(0.0, seconds, ROWS + 1), **self.how)
        self.x, self.t = x[-1], self.t + seconds
        total = x[:, 3]
        return x[:, 0], float(self.c.get("K_i", 0.0) * (total[ROWS // 2 :].mean() - total[: ROWS // 2].mean()))

    def _sampled(self, seconds: float) -> tuple[Array, float]:
        T, delay, end = self.c["sampling"]["period"], self.c["sampling"]["delay"], self.t + seconds
        found, outputs = [], []
        while self.t < end and abs(self.x[0]) < 1e8:
            sample, act = self.taken * T, self.asked[0][0] if self.asked else math.inf
            to = min(sample, act)
            if to > self.t:
                self.x = odeint(self.rates, self.x, [self.t, to], (self.u,), **self.how)[-1]
                self.t = to
            if sample <= act:
                self.asked.append((self.t + delay, self._output(T)))
                self.taken += 1
                found.append(self.x[0])
                outputs.append(self.asked[-1][1])
            else:
                self.u = self.asked.pop(0)[1]
        half = len(outputs) // 2
        return np.array(found), float(np.mean(outputs[half:]) - np.mean(outputs[:half]))

    def _output(self, T: float) -> float:
        c, step, y = self.c, self.c["sampling"].get("resolution", 0.0), float(self.x[0])
        y = step * round(y / step) if step else y
        v, self.last = 0.0 if self.last is None else (y - self.last) / T, y
        push = -c.get("K_i", 0.0) * (y - self.r)
        u = -c["K_p"] * (y - self.r) - c.get("K_i", 0.0) * self.total - c["K_d"] * v
        if not (abs(u) > self.limit and push * u > 0):
            self.total += T * (y - self.r)
        return float(np.clip(u, -self.limit, self.limit))


def verdict(data: Data, slowest: float, start: tuple[float, float] = (0.0, 0.0)) -> tuple[str, float, float]:
    """What the independent solution goes on doing: its word, its peak to peak at the end, and until when it moved.

    It rests when it has not moved for half of all the time that was simulated and friction holds an output that has stopped;
    it hunts when sixteen stretches in a row swing alike; otherwise it is simulated on.
    """
    motion, c = Apart(data, *start), data["controllers"]["hold"]
    F_s, move = data["contacts"]["guide"]["law"]["parameters"]["F_s"], abs(start[0] - c["signal"]["value"])
    resolution = c.get("sampling", {}).get("resolution", 0.0)
    longest = (LONGEST_SAMPLED if "sampling" in c else LONGEST) * slowest
    low, high, swings, moved = start[0], start[0], list[float](), 0.0
    stretch = CHUNK * slowest
    while motion.t < longest:
        y, charged = motion.on(stretch)
        if not np.isfinite(y).all() or np.abs(y - c["signal"]["value"]).max() > 1e3 * max(move, 1e-3):
            return "unstable", math.inf, motion.t
        low, high = min(low, float(y.min())), max(high, float(y.max()))
        rest, swing = max(REST * max(high - low, c["signal"]["value"]), resolution), float(np.ptp(y))
        if swing > rest:
            moved, stretch = motion.t, CHUNK * slowest
            swings.append(swing)
            far = swings[-16:]
            drifts = abs(y[-1] - y[0]) > 0.5 * swing  # an integral that relaxes through its bristles
            if len(far) == 16 and not drifts and motion.t > 400 * slowest and max(far) < 1.02 * min(far) + 0.2 * rest:
                limit = c.get("limit", math.inf)
                return ("unstable" if swing > 0.1 * limit / c["K_p"] else "hunting"), swing, motion.t
            if motion.t > MOVING * slowest and not drifts:
                return ("unstable" if far[-1] > 2 * far[0] else "hunting"), swing, motion.t
            continue
        swings = []
        if motion.t > 2 * moved + 200 * slowest and abs(charged) * longest / stretch < 0.5 * F_s:
            return "quiet", swing, moved
        stretch = min(1.5 * stretch, 1e3 * slowest)
    return ("quiet" if not swings else "hunting"), swing, moved


def same(expected: str, found: str, strict: bool) -> bool:
    """Quiet against what moves: hunting and unstable both oscillate, and a limit decides which it is called; ``strict`` where
    the boundary is one between these two."""
    moves = {"hunting", "unstable"}
    return expected == found or (not strict and expected in moves and found in moves)


class Asked(NamedTuple):
    """A judgement that is checked: where it stands, of what machine and start, its word, and whether hunting and unstable
    count as different."""

    at: str
    data: Data
    said: str
    start: tuple[float, float] = (0.0, 0.0)
    strict: bool = False


def verdicts(kind: str, data: Data, vary: str, random: np.random.Generator) -> list[Data]:
    """Rows: the file's own verdict, three starts, both sides of each boundary named, and points of the range."""
    found = stribeck.design(stribeck.Scenario(data), vary=[vary])
    line, rest = found.lines[0], data["controllers"]["hold"]["signal"]["value"]
    asked = [Asked("file", data, found.verdict)]
    for i in random.choice(len(found.starts), 3, replace=False):
        begun = found.starts[i]
        at = f"start {begun.off:.3g} {begun.speed:.3g}"
        asked.append(Asked(at, data, begun.judgement.verdict, (rest + begun.off, begun.speed)))
    sides = [(b, 1 - AWAY, b.below) for b in line.boundaries] + [(b, 1 + AWAY, b.above) for b in line.boundaries]
    for b, share, said in sides[: POINTS - len(asked)]:
        x = share * b.value
        if line.turned.low <= x <= line.turned.high:
            strict = {b.below, b.above} == {"hunting", "unstable"}
            asked.append(Asked(f"{b.path} = {x:.6g}", changed(data, b.path, x), said, strict=strict))
    clear = [i for i, x in enumerate(line.values) if not any(m.low <= x <= m.high for m in line.mixed)]
    for i in random.permutation(clear)[: POINTS - len(asked)]:
        x, path = float(line.values[i]), line.turned.path
        asked.append(Asked(f"{path} = {x:.6g}", changed(data, path, x), line.found[i].verdict))
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
        print(json.dumps(rows[-1]), flush=True)
    return rows


def by_chance(each: Asked, got: str, moved: float) -> bool:
    """Whether an irregular cycle came to rest in the end, and the judgement says that it may.

    Behind an encoder, such a cycle rests where a swing happens to end within friction's reach: a gain that differs by 1e-9
    moves that by hundreds of seconds, so that no simulation can tell when.
    """
    data = changed(each.data, "bodies.a.initial", {"y": each.start[0], "v": each.start[1]})
    return got == "quiet" and moved > BY_CHANCE and judge(loop_of(stribeck.Scenario(data)))[0].note == IRREGULAR


def reversal(data: Data) -> float:
    """The largest error within an eighth of a period after the reversals of the machine's sine, but its first wave."""
    T = 1 / data["controllers"]["hold"]["signal"]["frequency"]
    data = deepcopy(data)
    data["solve"]["t_end"], data["output"]["step"] = 4 * T, T / 1000
    found = solve(data, 1e-9)
    t, e = np.asarray(found["t"]), np.asarray(found["hold.r"]) - np.asarray(found["a.y"])
    near = ((t / T - 0.25) % 0.5 <= 0.125) & (t >= T)
    return float(np.abs(e[near]).max())


def compensation(random: np.random.Generator, sampled: bool = False) -> list[Data]:
    """The factor by which each compensation lowers the error after a reversal: stated, and found."""
    data = axis(random, {"kind": "pid"})
    m, w = data["bodies"]["a"]["mass"], 10 ** random.uniform(0.8, 1.3)
    frequency = w / 2 / np.pi / 15
    own = data["controllers"]["hold"] | {"K_p": m * w**2, "K_d": 1.6 * w * m}
    own["signal"] = {"kind": "sine", "amplitude": 0.05, "frequency": float(frequency)}
    data["controllers"]["hold"] = own
    data["solve"]["t_end"] = float(2 / frequency)  # the standard sine is then the file's
    if sampled:
        period = 0.02 / w
        own["sampling"] = {"period": period, "delay": 0.5 * period, "resolution": 1e-7}
    found = stribeck.design(stribeck.Scenario(data), compensate=True)
    rows, before = [], reversal(data)
    for c in found.compensations:
        table = c.loop.scenario.data["controllers"]["hold"].get("compensation")
        other = deepcopy(data)
        if c.dither is not None:
            other["controllers"]["hold"]["dither"] = {n: c.dither[n] for n in ("kind", "amplitude", "frequency")}
        elif table is not None:
            other["controllers"]["hold"]["compensation"] = {**deepcopy(table), "share": c.share}
        else:
            continue
        said = found.compensations[0].reversal_error / c.reversal_error
        got = before / reversal(other)
        rows.append(
            {"kind": c.kind, "share": c.share, "said": said, "found": got, "agrees": bool(abs(got / said - 1) <= 0.2)}
        )
        print(json.dumps(rows[-1]), flush=True)
    return rows


def main() -> None:
    """Run both, print rows as they come, and write them."""
    given = options(__doc__, "design_attack", machines=(20, 1), axes=(3, 1), seed=1)
    random, begun = np.random.default_rng(given.seed), time.process_time()
    rows: list[Data] = []
    factors: list[Data] = []

    def keep() -> None:
        about = {"machine": machine(), "seed": given.seed, "seconds": round(time.process_time() - begun)}
        write(given.out, {**about, "verdicts": rows, "factors": factors})

    for i in range(given.axes):
        factors += compensation(random, sampled=bool(i % 2))
        keep()
    for kind, data, vary in machines(random, given.machines):
        rows += verdicts(kind, data, vary, random)
        keep()
    chance = sum(r.get("chance", False) for r in rows)
    print(f"{sum(r['agrees'] for r in rows)} of {len(rows)} verdicts agree, {chance} are decided by chance; "
          f"{sum(r['agrees'] for r in factors)} of {len(factors)} factors within 20 %")  # fmt: skip


if __name__ == "__main__":
    main()
