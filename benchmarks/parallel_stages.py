"""One trajectory by a method whose stages do not wait for each other: what it gains over Rodas5P's eight dependent stages.

    python benchmarks/parallel_stages.py

The method is extrapolation of the linearly implicit Euler method (Deuflhard): n = 1 ... K substeps of h/n each, and of the K
results the combination of order K. The K chains are independent, and two of them fit in each lane of one vector of four:
7 substeps one after the other for K = 7, (7), (6, 1), (5, 2), (4, 3). Equations, Jacobian and linear algebra are the
generated ones of the lanes. It has no rows, events or breakpoints; Rodas5P's single run has them all, with two rows here.

Stick-slip of 40 s; for each method the loosest rtol of a scan at which the typical error of y (the median of five neighbours
of the scan, each the largest at its steps; of Rodas5P at rows, from dense output) is at most 1e-6 of the range; then processor
times by turns, Rodas5P's less that of a run of no length.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import statistics
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from measure import RESULTS, machine, timed
from numpy.typing import NDArray
from problems import stick_slip
from scipy.interpolate import CubicSpline

from stribeck.codegen import source
from stribeck.simulation import cache, compiler, lanes, native
from stribeck.simulation.variations import Variations

SECONDS, LIMIT, REFERENCE, ORDERS = 40.0, 1e-6, 1e-11, (5, 6, 7, 8)
ROOM, RTOLS = 1_000_000, 10 ** np.arange(-2, -11, -0.125)
OWN, START = "Rodas5P", "Rodas5P, of no length"
Array = NDArray[np.float64]
SCENARIO = stick_slip(SECONDS, 0.002).scenario

_CODE = """
static const int FIRST[LANES] = {@first}, SECOND[LANES] = {@second};
static const double WEIGHT_1[LANES] = {@weight_1}, WEIGHT_2[LANES] = {@weight_2};
static const double LOW_1[LANES] = {@low_1}, LOW_2[LANES] = {@low_2};
enum { K = @order, CHAIN = @chain };

/* Steps from x until t_end; their times and y; how many, or -1. Rejected ones are counted in *rejected. */
EXPORT int64_t extrapolate(const double *parameters, const double *rows, const double *atol_, double rtol, double t_end,
                           double *x_, int64_t room, double *t_out, double *y_out, int64_t *rejected)
{
    Parameters p;
    Coefficients c;
    Segment piece;
    real x0[N], atol[N];
    for (int i = 0; i < (int)(sizeof p / sizeof(real)); i++) ((real *)&p)[i] = splat(parameters[i]);
    for (int i = 0; i < PIECE; i++) ((real *)&piece)[i] = splat(rows[i]);
    for (int i = 0; i < N; i++) x0[i] = splat(x_[i]), atol[i] = splat(atol_[i]);
    prepare(&p, &c);
    double t = 0, h = 1e-6;
    int64_t steps = 0;
    real n_1, n_2;
    for (int lane = 0; lane < LANES; lane++) n_1[lane] = FIRST[lane], n_2[lane] = SECOND[lane] ? SECOND[lane] : 1;
    while (t < t_end && steps < room) {
        const int last = t + h * 1.000001 >= t_end;
        if (last) h = t_end - t;
        real f0[N], df_dt[N], x[N], x_1[N] = {0}, x_2[N] = {0}, right[N], d[N];
        Jacobian jac;
        Factors fac, second;
        rates(&p, &c, &piece, splat(t), x0, f0);
        jacobian(&p, &c, &piece, splat(t), x0, &jac, df_dt);
        real n = n_1, h_n = splat(h) / n, t_n = splat(t);
        factorise(&p, &c, &jac, 1 / h_n, h_n, &fac);
        factorise(&p, &c, &jac, n_2 / h, h / n_2, &second);
        for (int i = 0; i < N; i++) x[i] = x0[i];
        UNROLL for (int m = 0; m < CHAIN; m++)
        {
            mask turns = {0};
            int some = 0;
            for (int lane = 0; lane < LANES; lane++) turns[lane] = -(FIRST[lane] == m), some |= FIRST[lane] == m;
            if (some) {
                for (int i = 0; i < N; i++) x_1[i] = choose(turns, x[i], x_1[i]), x[i] = choose(turns, x0[i], x[i]);
                for (int q = 0; q < (int)(sizeof fac / sizeof(real)); q++)
                    ((real *)&fac)[q] = choose(turns, ((real *)&second)[q], ((real *)&fac)[q]);
                n = choose(turns, n_2, n);
                h_n = splat(h) / n;
                t_n = choose(turns, splat(t), t_n);
            }
            if (m == 0) for (int i = 0; i < N; i++) right[i] = f0[i];
            else rates(&p, &c, &piece, t_n, x, right);
            for (int i = 0; i < N; i++) right[i] += h_n * df_dt[i];
            solve(&p, &c, &jac, 1 / h_n, h_n, &fac, right, d);
            for (int i = 0; i < N; i++) x[i] += d[i];
            t_n += h_n;
            mask ends = {0};
            for (int lane = 0; lane < LANES; lane++) ends[lane] = -(FIRST[lane] + SECOND[lane] == m + 1);
            for (int i = 0; i < N; i++) x_2[i] = choose(ends, x[i], x_2[i]);
        }
        double new[N], square = 0;
        for (int i = 0; i < N; i++) {
            double low = 0;
            new[i] = 0;
            for (int lane = 0; lane < LANES; lane++) { /* a chain alone ends as the second */
                const double one = SECOND[lane] ? x_1[i][lane] : x_2[i][lane], two = SECOND[lane] ? x_2[i][lane] : 0;
                new[i] += WEIGHT_1[lane] * (one - x0[i][lane]) + WEIGHT_2[lane] * (SECOND[lane] ? two - x0[i][lane] : 0);
                low += LOW_1[lane] * (one - x0[i][lane]) + LOW_2[lane] * (SECOND[lane] ? two - x0[i][lane] : 0);
            }
            const double a = fabs(x0[i][0]), b = fabs(x0[i][0] + new[i]), scale = atol[i][0] + rtol * (a > b ? a : b);
            square += (new[i] - low) / scale * ((new[i] - low) / scale) / N;
        }
        if (!(square < 1e60)) { h *= 0.1; ++*rejected; if (h < 1e-14) return -1; continue; }
        double factor = square > 0 ? 0.9 * exp2(-0.5 / K * log2(square)) : 5;
        factor = factor > 5 ? 5 : factor < 0.2 ? 0.2 : factor;
        if (square > 1) { h *= factor; ++*rejected; if (h < 1e-14) return -1; continue; }
        for (int i = 0; i < N; i++) x0[i] += new[i];
        t = last ? t_end : t + h;
        h *= factor;
        t_out[steps] = t;
        y_out[steps++] = x0[0][0];
    }
    return t < t_end ? -1 : steps;
}
"""


def weights(counts: list[int]) -> dict[int, float]:
    """Of the results with so many substeps, in their combination of order len(counts)."""
    return {n: float(np.prod([n / (n - m) for m in counts if m != n])) for n in counts}


def built(order: int, folder: Path) -> ctypes.CDLL:
    """The method with four lanes."""
    first = [order - lane for lane in range(4)]
    rest = [n for n in range(1, order + 1) if n not in first]
    second = schedule(first, rest)
    high, low = weights(list(range(1, order + 1))), weights(list(range(2, order + 1)))
    filled = {
        "first": first, "second": second, "order": order, "chain": max(a + b for a, b in zip(first, second, strict=True)),
        "weight_1": [high[n] for n in first], "weight_2": [high.get(n, 0.0) for n in second],
        "low_1": [low.get(n, 0.0) for n in first], "low_2": [low.get(n, 0.0) for n in second],
    }  # fmt: skip
    text = _CODE
    for name, value in sorted(filled.items(), key=lambda item: -len(item[0])):
        text = text.replace(f"@{name}", ", ".join(map(repr, value)) if isinstance(value, list) else str(value))
    path = folder / f"extrapolation{order}.c"
    path.write_text(source(SCENARIO.system, lanes=True) + text)
    chosen = compiler.find()
    assert chosen is not None
    library = path.with_suffix(".so")
    command = [
        *chosen.command,
        "-O3",
        "-march=native",
        "-fno-math-errno",
        "-fno-trapping-math",
        "-DLANES=4",
        "-fPIC",
        "-shared",
    ]
    subprocess.run([*command, "-o", str(library), str(path), "-lm"], check=True)
    found = ctypes.CDLL(str(library))
    found.extrapolate.restype = ctypes.c_int64
    return found


def schedule(first: list[int], rest: list[int]) -> list[int]:
    """The second chain of each lane, 0 for none: the long ones of the rest beside the short ones of the first."""
    second = [0] * len(first)
    for lane, n in zip(reversed(range(len(first))), sorted(rest, reverse=True), strict=False):
        second[lane] = n
    return second


def extrapolation(library: ctypes.CDLL, rtol: float) -> Callable[[], tuple[int, int, Array, Array]]:
    """A solve: steps (-1 where it fails), rejected ones, times, y."""
    made = lanes.lane_arrays(Variations(SCENARIO, {"plant.mass": np.ones(1)}))
    numbers = {name: made.by_name[name].ravel().copy() for name in ("parameters", "piece_rows", "atol", "x0")}
    numbers["atol"] *= rtol / made.batch.rtol
    t, y = np.empty(ROOM), np.empty(ROOM)

    def run() -> tuple[int, int, Array, Array]:
        rejected = ctypes.c_int64(0)
        given, rows, atol, x0, t_, y_ = (ctypes.c_void_p(x.ctypes.data) for x in (*numbers.values(), t, y))
        steps = library.extrapolate(
            given, rows, atol, ctypes.c_double(rtol), ctypes.c_double(SECONDS), x0, ctypes.c_int64(ROOM), t_, y_,
            ctypes.byref(rejected),
        )  # fmt: skip
        return int(steps), rejected.value, t[: max(steps, 0)], y[: max(steps, 0)]

    return run


def loosest(row_of: Callable[[float], dict[str, Any]]) -> dict[str, Any]:
    """The row of the loosest rtol whose typical error, over five of the scan, keeps the limit."""
    rows: list[dict[str, Any]] = []
    for rtol in RTOLS:
        rows.append({"rtol": float(rtol), **row_of(float(rtol))})
        near = rows[-5:]
        if len(near) == 5 and (typical := float(np.median([r["error"] for r in near]))) <= LIMIT:
            return {**near[2], "typical_error": typical}
    raise SystemExit("no rtol of the scan keeps the limit")


def main() -> None:
    """Scan, time, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repetitions", type=int, default=41)
    parser.add_argument("--out", type=Path, default=RESULTS / "parallel_stages.json")
    given = parser.parse_args()
    chosen = compiler.find()
    assert chosen is not None
    library, _ = cache.library(source(SCENARIO.system), chosen)
    y = native.solve(library, SCENARIO.with_changes({"solve.rtol": REFERENCE})).states[:, 0]
    span, curve = float(np.ptp(y)), CubicSpline(np.arange(SCENARIO.rows) * SCENARIO.output.step, y)

    def own(rtol: float) -> dict[str, Any]:
        found = native.solve(library, SCENARIO.with_changes({"solve.rtol": rtol}))
        error = float(np.max(abs(found.states[:, 0] - y))) / span
        return {"error": error, "steps": found.stats["accepted"], "rejected": found.stats["rejected"]}

    rows = {OWN: loosest(own)}
    few = SCENARIO.with_changes({"solve.rtol": rows[OWN]["rtol"], "output.step": SECONDS / 2})
    start = few.with_changes({"solve.t_end": 1e-6, "output.step": 1e-6})
    runs: dict[str, Callable[[], Any]] = {
        OWN: lambda: native.solve(library, few), START: lambda: native.solve(library, start),
    }  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        for order in ORDERS:
            other, name = built(order, Path(folder)), f"extrapolation, order {order}"

            def row_of(rtol: float, other: ctypes.CDLL = other) -> dict[str, Any]:
                steps, rejected, t, found = extrapolation(other, rtol)()
                error = float(np.max(abs(found - curve(t)))) / span if steps > 0 else np.inf
                return {"error": error, "steps": steps, "rejected": rejected}

            rows[name] = loosest(row_of)
            runs[name] = extrapolation(other, rows[name]["rtol"])
        seconds: dict[str, list[float]] = {name: [] for name in runs}
        for _ in range(given.repetitions):
            for name, run in runs.items():
                seconds[name].append(timed(run).cpu)
    seconds[OWN] = [a - b for a, b in zip(seconds[OWN], seconds[START], strict=True)]
    for name, row in rows.items():
        row["milliseconds"] = 1e3 * statistics.median(seconds[name])
        row["ratio"] = statistics.median(a / b for a, b in zip(seconds[name], seconds[OWN], strict=True))
        print(name, json.dumps(row), flush=True)
    given.out.write_text(json.dumps({"machine": machine(), "seconds": SECONDS, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
