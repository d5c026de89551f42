"""`stribeck design` on machines that it has not seen, against long simulations by SciPy on equations written apart: the
verdict on both sides of every boundary that it names, 5 % away, and the factor by which compensation lowers the error after
a reversal.

    python benchmarks/design_attack.py [--machines N] [--seed S] [--out FILE]

The equations of the boundaries' machines stand here, those of the factors are tests/machine/independent.py; what counts as rest
is judged here anew. Takes minutes.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
from measure import RESULTS, machine
from scipy.integrate import odeint

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

import stribeck  # noqa: E402
from stribeck.arrays import Array  # noqa: E402
from stribeck.loops.loop import loop_of  # noqa: E402
from tests.machine.independent import solve  # noqa: E402

AWAY = 0.05
CONSTANTS_OF_TIME = 200  # simulated after the signals rest; twice that where it is not decided
ROWS = 6000
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
    """Machines, each with a number to vary: what delay, integral, stiction and gain do."""
    found = []
    for i in range(count):
        kind = ("integral", "stiction", "damping", "delay")[i % 4]
        w, damping = 10 ** random.uniform(0.3, 1.0), random.uniform(0.7, 1.2)
        data = axis(random, {"kind": "pid"})
        m = data["bodies"]["a"]["mass"]
        own = data["controllers"]["hold"]
        own |= {"K_p": m * w**2, "K_d": 2 * damping * w * m}
        F_s = data["contacts"]["guide"]["law"]["parameters"]["F_s"]
        own["signal"]["value"] = float(random.uniform(8, 20) * F_s / own["K_p"])  # enough to break away
        viscous = data["contacts"]["guide"]["law"]["parameters"]["sigma_2"]
        routh = own["K_p"] * (own["K_d"] + viscous) / m
        if kind == "delay":
            period = 0.05 / w
            own |= {"sampling": {"period": period, "delay": period}, "limit": 1e3 * m * w**2}
            vary = f"controllers.hold.sampling.delay={period / 2}:{2 / w}"
        elif kind == "integral":
            own |= {"K_i": 0.3 * routh}
            vary = f"controllers.hold.K_i={0.3 * routh}:{3 * routh}"
        elif kind == "stiction":
            own |= {"K_i": 0.25 * routh}
            F_c = data["contacts"]["guide"]["law"]["parameters"]["F_c"]
            data["contacts"]["guide"]["law"]["parameters"]["F_s"] = 1.3 * F_c
            vary = f"contacts.guide.law.parameters.F_s={F_c}:{2 * F_c}"
        else:
            own |= {"K_i": 0.2 * routh}
            vary = f"controllers.hold.K_d={own['K_d']}:{30 * own['K_d']}"
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


def follow(data: Data, end: float) -> Array:
    """The body's position at ROWS times: mass, LuGre, PID, written here in plain floats and solved by SciPy's LSODA."""
    m, c = data["bodies"]["a"]["mass"], data["controllers"]["hold"]
    p = data["contacts"]["guide"]["law"]["parameters"]
    s0, s1, s2, F_c, F_s, v_s = (p[n] for n in ("sigma_0", "sigma_1", "sigma_2", "F_c", "F_s", "v_s"))
    r, K_p, K_i, K_d, limit = (
        c["signal"]["value"],
        c["K_p"],
        c.get("K_i", 0.0),
        c.get("K_d", 0.0),
        c.get("limit", math.inf),
    )

    def rates(x: Array, t: float, u: float | None = None) -> list[float]:
        y, v, z, total = x
        if u is None:
            u = -K_p * (y - r) - K_i * total - K_d * v
        dz = v - s0 * abs(v) / (F_c + (F_s - F_c) * math.exp(-min((v / v_s) ** 2, 700.0))) * z
        return [v, (u - s0 * z - s1 * dz - s2 * v) / m, dz, y - r]

    t = np.linspace(0.0, end, ROWS + 1)
    how = {"rtol": 1e-9, "atol": [1e-10, 1e-10, 1e-13, 1e-10], "mxstep": 100000}
    if "sampling" not in c:
        return np.asarray(odeint(rates, [0.0] * 4, t, **how)[:, 0])
    period, delay = c["sampling"]["period"], c["sampling"]["delay"]
    instants = sorted([(k * period, 0, k) for k in range(int(end / period) + 1)]
                      + [(k * period + delay, 1, k) for k in range(int(end / period) + 1)])  # fmt: skip
    x, now, u, last, asked, found = np.zeros(4), 0.0, 0.0, None, {}, [(0.0, 0.0)]
    for at, acts, k in instants:
        if at > now:
            x = odeint(rates, x, [now, at], (u,), **how)[-1]
            now = at
            found.append((now, float(x[0])))
        if acts:
            u = asked.pop(k)
        else:
            v = 0.0 if last is None else (x[0] - last) / period
            last = float(x[0])
            asked[k] = float(np.clip(-K_p * (x[0] - r) - K_d * v, -limit, limit))
        if abs(x[0]) > 1e8:
            break
    times, y = np.array(found).T
    return np.asarray(np.interp(t[t <= times[-1]], times, y))


def verdict(data: Data, slowest: float, windows: int = 1) -> tuple[str, float]:
    """What the independent solution does in the second half of its time: its word and its peak to peak."""
    y = follow(data, CONSTANTS_OF_TIME * slowest * windows)
    if not np.isfinite(y).all() or np.abs(y).max() > 1e6:
        return "unstable", float("inf")
    late = y[len(y) // 2 :]
    third = [float(np.ptp(part)) for part in np.array_split(late, 3)]
    if third[-1] <= 1e-6 * np.ptp(y):
        return "quiet", third[-1]
    if abs(late[-1] - late[0]) > 0.9 * np.abs(np.diff(late)).sum():
        return "creeping", third[-1]
    grows = third[2] > 1.1 * third[1] > 1.2 * third[0]
    return ("unstable" if grows else "hunting"), third[-1]


def same(expected: str, found: str, strict: bool) -> bool:
    """Quiet against what moves: hunting and unstable both oscillate, and a limit decides which it is called; ``strict`` where
    the boundary is one between these two."""
    moves = {"hunting", "unstable"}
    return expected == found or (not strict and expected in moves and found in moves)


def boundaries(kind: str, data: Data, vary: str) -> list[Data]:
    """Rows, one for each side of each boundary."""
    found = stribeck.design(stribeck.Scenario(data), vary=[vary])
    rows = []
    for line in found.lines:
        for b in line.boundaries:
            strict = {b.below, b.above} == {"hunting", "unstable"}
            for share, expected in ((1 - AWAY, b.below), (1 + AWAY, b.above)):
                if not line.turned.low <= share * b.value <= line.turned.high:
                    continue  # outside of the range that was asked for, where a number may not be allowed
                other = changed(data, b.path, share * b.value)
                slowest = loop_of(stribeck.Scenario(other)).slowest
                slowest = max(slowest, found.loop.slowest)
                got, size = verdict(other, slowest)
                windows = 1
                while (
                    not same(expected, got, strict) and windows < 8
                ):  # an integral may wind up for long before it breaks away
                    windows *= 4
                    got, size = verdict(other, slowest, windows)
                rows.append(
                    {"kind": kind, "path": b.path, "value": b.value, "at": share * b.value, "said": expected, "found": got,
                     "agrees": same(expected, got, strict), "sure": b.sure, "windows": windows,
                     "peak_to_peak": size if math.isfinite(size) else None}
                )  # fmt: skip
                print(json.dumps(rows[-1]), flush=True)
    if not rows:
        print(json.dumps({"kind": kind, "vary": vary, "none": [j.verdict for j in found.lines[0].found]}), flush=True)
    return rows


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
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--machines", type=int, default=12)
    parser.add_argument("--axes", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=RESULTS / "design_attack.json")
    options = parser.parse_args()
    random, begun = np.random.default_rng(options.seed), time.process_time()
    rows: list[Data] = []
    factors: list[Data] = []

    def keep() -> None:
        about = {"machine": machine(), "seed": options.seed, "seconds": round(time.process_time() - begun)}
        options.out.write_text(json.dumps({**about, "boundaries": rows, "factors": factors}, indent=1) + "\n")

    for i in range(options.axes):
        factors += compensation(random, sampled=bool(i % 2))
        keep()
    for kind, data, vary in machines(random, options.machines):
        rows += boundaries(kind, data, vary)
        keep()
    print(f"{sum(r['agrees'] for r in rows)} of {len(rows)} points 5 % away agree; "
          f"{sum(r['agrees'] for r in factors)} of {len(factors)} factors within 20 %")  # fmt: skip


if __name__ == "__main__":
    main()
