"""Are the two uncertainties of static fits right, and do their predictions hold? Counts on fresh seeds, by family of records.

    python benchmarks/estimates.py [--families other lacking ...] [--first 70000] [--count 20]

other, lacking, bent, pointed: wrong or incomplete friction; how many intervals and ranges hold the truth, and are usable.
agree, same: halves of a record and records with other motions; the same motion measured twice.
held, rigs, kinds: the error on further motions, as the logarithm of its ratio to the best plain fit of each motion.
"""

from __future__ import annotations

import json
import time
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import static_records as records
from intervals import holds
from measure import Given, run, say, write

from stribeck.identify.core.states import Estimate, EstimateState
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.data.reading import read_log
from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log
from stribeck.identify.methods.static import estimated, fit_static
from stribeck.identify.models.curves import LAWS
from stribeck.identify.options import FitOptions

NAMES, SPEED = {"time": "t", "position": "y", "force": "F"}, {"time": "t", "velocity": "v", "force": "F"}
OUTSIDE = 0.05  # of its rows: a motion with more beyond the ranges that the fit saw is outside
OF_ALL = ("mass", "offset", "F_c", "sigma_2")
FAMILIES = {
    "lacking": ("stribeck_tanh", "coulomb_viscous"), "bent": ("stribeck", "stribeck_tanh", "coulomb_viscous"),
    "pointed": ("stribeck", "stribeck_tanh"), "other": ("coulomb_viscous", "stribeck"),
}  # fmt: skip
PAIRS, MOTIONS = ("agree", "same"), ("held", "rigs", "kinds")


def estimates(log: Log, law: str) -> tuple[dict[str, Estimate], dict[str, float]]:
    """Every estimate of one law's fit, and the speeds of the levels."""
    fitted = estimated(log, (law,), FitOptions())
    return fitted.estimates, fitted.choice.library.levels


def usable(name: str, e: Estimate) -> bool:
    """Identified, or a range below a factor of two; F_s at least within half, v_s at most within twice: these are bounds."""
    low, high = e.range or e.interval
    if e.state in ("at least", "at most"):
        return bool(low > 0.5 * e.value if e.state == "at least" else high < 2 * e.value)
    return bool(e.state == "identified" or (low > 0 and high < 2 * low))


def truths(family: str, seed: int) -> Iterator[dict[str, Any]]:
    """Each estimate with a truth: whether its interval and its range hold, its state, and how wide it is."""
    for kind in records.OTHER_KINDS if family == "other" else [family]:
        if family == "other":
            what, (columns, truth, _), friction = kind, records.other_record(kind, seed), None
        else:
            what, columns, truth, friction = getattr(records, family)(seed)
        log = read_log(columns, ColumnNames(NAMES, {"y": "rad"} if what == "worm" else {}))  # an arm's weight turns
        for law in FAMILIES[family]:
            result, speeds = estimates(log, law)
            reported = {
                n: x
                for n, x in truth.items()
                if n in result and n != "k_v" and (law != "coulomb_viscous" or n in OF_ALL)
            }
            levels = {n: friction(v) for n, v in speeds.items()} if friction else {}
            for name, x in (reported | levels).items():
                e = result[name]
                low, high = e.range or e.interval
                yield {
                    "kind": what, "law": law, "name": name, "state": str(e.state), "level": name in speeds,
                    "interval": holds(e.interval, x), "range": holds((low, high), x), "usable": usable(name, e),
                    "half": (high - low) / 2 / max(abs(e.value), 1e-300) if np.isfinite(high) else None,
                }  # fmt: skip


def pairs(family: str, seed: int) -> Iterator[tuple[list[Log], str, dict[str, float]]]:
    """Two records whose estimates should agree, the law, and the truth where the law is complete."""
    draw = np.random.default_rng(seed)
    if family == "agree":
        m = records.speed_machine(draw, records.SPEED_FRICTION[seed % 6])
        motions = [records.speed_motion(draw, records.SPEED_MOTIONS[seed // 6 % 4]) for _ in range(2)]
        logs = [read_log(records.speed_record(m, v, draw), ColumnNames(SPEED)) for v in motions]
        middle = len(logs[0]) // 2
        yield [logs[0].rows(slice(None, middle)), logs[0].rows(slice(middle, None))], "stribeck_tanh", {}
        yield logs, "stribeck_tanh", {}
        return
    m = records.other_machine(draw, bool(seed % 2))
    at = records.other_motion(draw, records.OTHER_MOTIONS[seed // 2 % 4], m["fastest"])
    complete = seed // 8 % 2 == 0
    kind = ("belt", "directions", "bristles", "gms")[seed // 16 % 4]
    force = (records.complete if complete else records.OTHER_KINDS[kind][1])(draw, m, at)
    logs = []
    for _ in range(2):
        columns = records.sensed(
            draw, m, at, force + m["mass"] * at[2] + m["offset"], m["encoder"] * draw.uniform(-0.5, 0.5)
        )
        logs.append(read_log(columns, ColumnNames(NAMES)))
    names = ("mass", "offset", "F_c", "sigma_2", *(("F_s", "v_s") if seed % 2 else ()))
    yield logs, "stribeck" if seed % 2 else "coulomb_viscous", {n: m[n] for n in names} if complete else {}


def agreements(family: str, seed: int) -> Iterator[dict[str, Any]]:
    """How far two estimates are apart, in their joint interval; and whether both hold the truth."""
    for logs, law, truth in pairs(family, seed):
        (a, speeds), (b, _) = (estimates(log, law) for log in logs)
        for name in (a.keys() & b.keys()) - set(speeds):
            half = [np.hypot(e[name].parts["C"], e[name].parts["A"]) for e in (a, b)]
            apart = abs(a[name].value - b[name].value)
            if name in ("v_s", "k_v"):
                half = [h / e[name].value for h, e in zip(half, (a, b), strict=True)]
                apart = abs(np.log(a[name].value / b[name].value))
            held = [holds(e[name].interval, truth[name]) for e in (a, b)] if name in truth else []
            yield {"name": name, "apart": float(apart / max(np.hypot(*half), 1e-300)), "holds": held}


def motions(family: str, seed: int) -> Iterator[dict[str, Any]]:
    """The error on each further motion beside the best plain fit's."""
    draw = np.random.default_rng(seed)
    if family == "held":
        m, kind = records.speed_machine(draw, records.SPEED_FRICTION[seed % 6]), records.SPEED_MOTIONS[seed // 6 % 4]
        logs = [
            read_log(records.speed_record(m, records.speed_motion(draw, kind), draw), ColumnNames(SPEED))
            for _ in range(2)
        ]
        rows = [np.flatnonzero(records.away_from_rest(log)) for log in logs]
        seen = [
            (log.velocity[r], log.acceleration[r], log.force[r], np.zeros((len(r), 0)))
            for log, r in zip(logs, rows, strict=True)
        ]
    else:
        kinds, rig, record = records.MEASURED[family]
        kind = list(kinds)[seed % len(kinds)]
        m = rig(draw, kind)
        results = [record(m, kind, draw) for _ in range(4)]
        logs = [read_log(c, ColumnNames(NAMES)) for c in results]
        rows = [np.flatnonzero(~at_rest(log)) for log in logs]
        seen = [records.measured(c, log) for c, log in zip(results, logs, strict=True)]
    plain = []
    for way in (records.least_squares, records.tanh_stribeck):
        for weigh in (False, True) if seen[0][3].shape[1] else (False,):
            v, a, force, w = seen[0]
            plain.append((weigh, way(v, a, force, w if weigh else w[:, :0])))
    fit = fit_static(logs[0], LAWS, FitOptions())
    assert fit.predictor is not None
    for log, r, (v, a, force, w) in zip(logs[1:], rows[1:], seen[1:], strict=True):
        best = min(np.linalg.norm(force - f(v, a, w if weigh else w[:, :0])) for weigh, f in plain if f)
        left = force - fit.predictor.force(log)[r]
        of_motion = [n for n in ("position", "velocity") if n in fit.seen]
        far = [(x < lo) | (x > hi) for n in of_motion for lo, hi in [fit.seen[n]] for x in [getattr(log, n)[r]]]
        yield {
            "kind": kind, "worse": float(np.log(np.linalg.norm(left) / best)),
            "outside": bool(np.mean(np.any(far, axis=0)) > OUTSIDE),
        }  # fmt: skip


def means(found: list[dict[str, Any]], prefix: str, *keys: str) -> dict[str, float]:
    """How many there are, and the share of each key; nothing of none."""
    return {f"{prefix}n": len(found), **{f"{prefix}{k}": np.mean([e[k] for e in found]) for k in keys}} if found else {}


def counted(family: str, found: list[dict[str, Any]]) -> dict[str, float]:
    """The counts of a family."""
    out: dict[str, float] = {}
    if family in FAMILIES:
        own, levels = ([e for e in found if e["level"] is level] for level in (False, True))
        out |= means(own, "", "interval", "range", "usable")
        out |= means([e for e in own if e["kind"] in ("complete", "nothing")], "complete ", "interval")
        for kind in records.OTHER_KINDS if family == "other" else ():
            out |= means([e for e in own if e["kind"] == kind], f"{kind} ", "range", "usable")
        for name, state in (("F_s", EstimateState.AT_LEAST), ("v_s", EstimateState.AT_MOST)):
            for label in ("two-sided", state):
                some = [e for e in own if e["name"] == name and (e["state"] == state) == (label == state)]
                out |= means([{"holds": e["range"]} for e in some], f"{name} {label} ", "holds")
        out |= means(levels, "levels ", "range", "usable")
        if levels:
            out["levels half width"] = np.median([e["half"] for e in levels if e["half"] is not None])
    elif family in PAIRS:
        apart = np.array([e["apart"] for e in found])
        out |= {"n": len(apart), "agree": np.mean(apart <= 1), "median difference": np.median(apart)}
        out |= means([{"interval": held} for e in found for held in e["holds"]], "complete ", "interval")
    else:
        for prefix, some in (("", (True, False)), ("inside ", (False,)), ("outside ", (True,))):
            x = [e["worse"] for e in found if e["outside"] in some]
            rows = [{"mean log ratio": w, "within 1 %": w <= 0.01, "within 5 %": w <= 0.05} for w in x]
            out |= means(rows, prefix, "mean log ratio", "within 1 %", "within 5 %")
            out |= {f"{prefix}worst": max(x)} if x else {}
    return {name: round(float(value), 4) for name, value in out.items()}


def benchmark(given: Given) -> dict[str, Any]:
    """Count the families that are asked for."""
    kept = json.loads(given.out.read_text()) if given.out.exists() else {}
    for family in given.families:
        result, began = list[dict[str, Any]](), time.process_time()
        of = truths if family in FAMILIES else agreements if family in PAIRS else motions
        for seed in range(given.first, given.first + given.count):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result += of(family, seed)
        counts = counted(family, result) | {"seconds": round(time.process_time() - began, 1)}
        kept[family] = {"first": given.first, "seeds": given.count, **counts}
        write(given.out, {**kept, "machine": given.machine})
        say(f"{family}: {counts}")
    return {**kept, "machine": given.machine}


if __name__ == "__main__":
    tables = ("estimates", "other_kinds", "agreements", "further_motions", "bounds")
    run(benchmark, __doc__, "estimates", *tables, families=[*FAMILIES, *PAIRS, *MOTIONS], first=70000, count=(20, 1))
