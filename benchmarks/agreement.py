"""Do 95 % intervals of static fits agree between the halves of a record, and between two records of a machine?

The machines are those of held_out.py, whose friction is mostly none of our laws, so that model error is in every fit; and the
records of ../shared/data, where they are there. A record is cut in the middle and both halves are fitted with the same law and
terms; likewise two records with different motions. Two intervals agree where the estimates differ by no more than the root of
the sum of squares of the halves of the intervals that face each other; independent ones that are right do so in 95 of 100
cases, and the median of the difference in units of that root is then 0.34: where it is less, intervals are wider than the
estimates scatter. What is not called known by both is counted too.

    python benchmarks/agreement.py [--cases 24] [--first 0] [--out FILE]
"""

from __future__ import annotations

import argparse
import json
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from held_out import FRICTION, MOTION, machine, motion, record

import stribeck
from stribeck.identify.api import read_log
from stribeck.identify.log import Log

RESULTS = Path(__file__).parent / "results" / "agreement.json"
DATA = Path(__file__).parent.parent.parent / "shared" / "data"
NAMES = {"time": "t", "velocity": "v", "force": "F"}


def halves(log: Log) -> tuple[Log, Log]:
    """The two halves of a record."""
    middle = len(log) // 2
    return log.rows(slice(None, middle)), log.rows(slice(middle, None))


def compared(one: Log, other: Log, law: str, apart: bool = False, **asked: Any) -> dict[str, Any]:
    """For each number that both fits call known, whether the intervals agree; why there is no fit. ``apart``: the logs are of
    different times, and a level that drifts is then not the same number in both."""
    try:
        fits = [stribeck.fit(log, law, select=False, **asked) for log in (one, other)]
    except stribeck.StribeckError as error:
        return {"failed": str(error).splitlines()[0]}
    found = [{**fit.estimates, **fit.body} for fit in fits]
    agree, apart_by, withheld = {}, {}, []
    for name in found[0].keys() & found[1].keys():
        first, second = sorted((found[0][name], found[1][name]), key=lambda e: e.value if e.value is not None else 0.0)
        known = all(
            e.identifiable and e.value is not None and e.low is not None and e.high is not None for e in (first, second)
        )
        drifts = apart and "F_c_by_time" in asked.get("terms", ()) and name in ("F_c", "F_s")
        if not known:
            withheld.append(name)
        elif not drifts:
            reach = np.hypot(first.high - first.value, second.value - second.low)
            agree[name] = bool(second.value - first.value <= reach)
            apart_by[name] = round(float((second.value - first.value) / max(reach, 1e-300)), 3)
    return {
        "agree": dict(sorted(agree.items())),
        "difference": dict(sorted(apart_by.items())),
        "withheld": sorted(withheld),
    }


def asked_of(fit: Any) -> dict[str, Any]:
    """The law, terms and free constants of a fit, to be fitted again."""
    law = stribeck.laws.find(fit.law)
    free = [n for n in fit.used if n in law.constants() and n in fit.estimates]
    return {
        "law": fit.law,
        "terms": [n for n in fit.body if n not in ("mass", "offset") and "wards" not in n],
        "free": free,
    }


def one(seed: int) -> dict[str, Any]:
    """A machine's record in halves, and two of its records, with the law that the default fit takes and by least squares."""
    draw = np.random.default_rng(seed)
    kind, moves = FRICTION[seed % len(FRICTION)], MOTION[seed // len(FRICTION) % len(MOTION)]
    m = machine(draw, kind)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        first, second = (read_log(record(m, motion(draw, moves), draw), columns=NAMES) for _ in range(2))
        taken = asked_of(stribeck.fit(first).best)
        return {
            "friction": kind, "motion": moves, "law": taken["law"], "terms": taken["terms"],
            "halves": compared(*halves(first), apart=True, **taken), "reruns": compared(first, second, **taken),
            "halves, least squares": compared(*halves(first), "coulomb_viscous"),
            "reruns, least squares": compared(first, second, "coulomb_viscous"),
        }  # fmt: skip


def measured() -> Iterator[tuple[str, dict[str, Any]]]:
    """Records of real machines."""
    emps = {"time": "t", "position": "qm", "force": "vir"}
    seal = {"time": "1", "position": "5", "pressure": "6", "force": "7"}
    arm = {"time": "time", "position": "position", "force": "torque"}
    asked = [("emps/DATA_EMPS.mat", emps, {"force_gain": "gtau"}, {"law": "coulomb_viscous"}),
             ("emps/DATA_EMPS.mat", emps, {"force_gain": "gtau"}, {"law": "stribeck_tanh"})]  # fmt: skip
    asked += [
        (f"pneumatic-seal/O-ring257_{bar}bar.csv", seal, {"units": {"1": "ms", "5": "mm", "6": "bar"}},
         {"law": "coulomb_viscous", "terms": ["area"], "mass": 0.0, "constants": {"sigma_2": 0}})
        for bar in (1, 3, 5, 7)
    ]  # fmt: skip
    asked += [
        (f"simple-pendulum/{name}_measured.csv", arm, {}, {"law": "coulomb_viscous", "terms": ["gravity_sin"]})
        for name in ("sysid", "direct_collocation", "energy_shaping")
    ]
    for path, columns, how, fit in asked:
        if (DATA / path).is_file():
            yield f"{path}, {fit['law']}", compared(*halves(read_log(DATA / path, columns=columns, **how)), **fit)


def counted(cases: list[dict[str, Any]]) -> dict[str, float | int | None]:
    """How many intervals agree, of how many, how many numbers are withheld, and the median of the differences."""
    told = [held for case in cases for held in case.get("agree", {}).values()]
    apart_by = [by for case in cases for by in case.get("difference", {}).values()]
    return {
        "agree": sum(told), "of": len(told), "withheld": sum(len(case.get("withheld", ())) for case in cases),
        "median difference": round(float(np.median(apart_by)), 3) if apart_by else None,
    }  # fmt: skip


def main() -> None:
    """Run the cases that are asked for and print the counts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=24)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--out", type=Path, default=RESULTS)
    given = parser.parse_args()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found: dict[str, Any] = {"measured": dict(measured()), "made": {}}
    for seed in range(given.first, given.first + given.cases):
        found["made"][str(seed)] = case = one(seed)
        print(seed, case["friction"], case["motion"], case["law"], {
            k: [n for n, held in v.get("agree", {}).items() if not held] or len(v.get("agree", {}))
            for k, v in case.items() if isinstance(v, dict)}, flush=True)  # fmt: skip
        ways = ("halves", "reruns", "halves, least squares", "reruns, least squares")
        found["counts"] = {way: counted([c[way] for c in found["made"].values()]) for way in ways}
        found["counts"]["measured, halves"] = counted(list(found["measured"].values()))
        given.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(found["measured"])
    print(found["counts"])


if __name__ == "__main__":
    main()
