"""Is a verdict of ``stribeck check`` ever wrong? Laws written to mislead it, and built-in laws with random and extreme constants.

The truth of the former is derived by hand (tests/properties/nasty); that of the latter follows from the exact
conditions of docs/explanation/theory.md, evaluated here with rational numbers. A counterexample to passivity is integrated anew.

    python benchmarks/verdicts.py [--sets 20] [--seed 0]

Every verdict is given to the second checker, and counts as wrong where it refuses the certificate of a yes or contradicts
the counterexample of a no.
"""

from __future__ import annotations

import math
import random
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from fractions import Fraction
from typing import Any

import mpmath
from measure import Given, run, say
from scipy.integrate import solve_ivp

import stribeck
from stribeck.properties.verdicts import refusals
from tests.properties.nasty import PROPERTIES, cases

MAJORANTS = [f"{law}/{m}" for law in ("lugre_majorant", "elastoplastic_majorant") for m in ("atan", "sqrt", "compact")]
BUILTIN = ["lugre", "lugre_arctan", "lugre_sobczyk", "elastoplastic", "elastoplastic_sobczyk", "dahl", *MAJORANTS]
DIGITS = 60
FAILED = "the equations cannot be treated"  # how check says that it failed itself


@dataclass
class Row:
    """A line of the table."""

    name: str
    sets: int = 0
    laws: int = 0
    verdicts: int = 0
    undecided: int = 0
    seconds: float = 0.0
    slowest: float = 0.0
    wrong: list[str] = field(default_factory=list)
    crashes: list[str] = field(default_factory=list)
    open: list[str] = field(default_factory=list)

    def judge(self, name: str, law: Any, truth: dict[str, bool | None]) -> None:
        """Check a law and count its verdicts."""
        self.laws += 1
        start = time.process_time()
        try:
            result = stribeck.check(law)
        except Exception as error:
            self.crashes.append(f"{name}: {type(error).__name__}: {error}")
            return
        finally:
            spent = time.process_time() - start
            self.seconds, self.slowest = self.seconds + spent, max(self.slowest, spent)
        for what in PROPERTIES:
            verdict = result[what]
            self.verdicts += 1
            if verdict.holds is None:
                self.undecided += 1
                self.open.append(f"{name}: {what}")
                if str(verdict.evidence.get("reason")).startswith(FAILED):
                    self.crashes.append(f"{name}: {what}: {verdict.evidence['reason']}")
            elif truth[what] is not None and verdict.holds is not truth[what]:
                self.wrong.append(f"{name}: {what}: {verdict.holds} ({verdict.method})")
            elif verdict.holds and (refused := refusals(verdict.certificate, law, what)):
                self.wrong.append(f"{name}: {what}: its certificate is refused: {refused[0]}")
            elif verdict.holds is False and verdict.verify(law, what) is False:
                self.wrong.append(f"{name}: {what}: its counterexample is contradicted")
            elif what == "passive" and verdict.holds is False and (text := replayed(law, verdict.evidence)):
                self.wrong.append(f"{name}: {what}: {text}")


def replayed(law: Any, evidence: Any) -> str | None:
    """What is wrong with a cycle of held speeds that is said to draw energy, integrated by SciPy; None where it does.

    Only a program that returns z to its start can be judged here; numbers are compared to 1e-3, as a check on the
    statement and not on rounding.
    """
    program, z = evidence.get("program"), evidence.get("z_start")
    if not program or z is None or "energy_drawn" not in evidence:
        return None
    energy = 0.0
    for piece in program:
        v, duration = piece["v"], piece["duration"]

        def rates(t: float, x: Any, v: float = v) -> list[float]:
            return [float(law.rate(v, x[0])), float(law.force(v, x[0])) * v]

        scale = law.scales(law.p)
        tolerance = [1e-12 * scale.length, 1e-9 * abs(evidence["energy_drawn"])]
        solution = solve_ivp(rates, (0, duration), [z, 0.0], method="LSODA", rtol=1e-10, atol=tolerance)
        z, energy = float(solution.y[0, -1]), energy + float(solution.y[1, -1])
    stated = evidence["energy_drawn"]
    if energy > 0 or abs(energy + stated) > 0.01 * abs(stated):
        return f"states {stated:.6g} J drawn, SciPy finds {-energy:.6g} J"
    return None


def nasty(every: int) -> Iterator[Row]:
    """A row for each kind of nasty law."""
    rows: dict[str, Row] = {}
    for case in list(cases())[::every]:
        rows.setdefault(case.kind, Row(case.kind)).judge(f"{case.kind}.{case.name}", case.law(), case.truth)
    yield from rows.values()


# -- built-in laws: the exact conditions ------------------------------------------------------------------------------


def truth_of(name: str, values: dict[str, float]) -> dict[str, bool | None]:
    """What theory.md says of a built-in law; None where it gives no condition that decides."""
    law = name.partition("/")[0]
    return {
        "unique": True,
        "bounded": law != "lugre_arctan",
        "smooth": law not in ("lugre", "elastoplastic", "dahl"),
        "passive": _passive(name, values),
        "drift_free": law in ("elastoplastic", "elastoplastic_majorant"),
    }


def _passive(name: str, values: dict[str, float]) -> bool | None:
    law, _, majorant = name.partition("/")
    exact = {n: Fraction(x) for n, x in values.items()}
    sigma_1, sigma_2, F_c, F_s = (exact[n] for n in ("sigma_1", "sigma_2", "F_c", "F_s"))
    damped = "v_d" in exact
    if law == "dahl":
        return True
    if law in ("lugre_sobczyk", "elastoplastic_sobczyk"):
        return False
    with mpmath.workdps(DIGITS):
        excess = {"": 0, "atan": 2 / mpmath.pi, "sqrt": mpmath.mpf(1), "compact": mpmath.mpf(3) / 8}[majorant]
        m_0 = excess / _real(exact["k_v"]) if majorant else mpmath.mpf(0)
        slow = damped and _real(sigma_1) * (_real(exact["v_d"]) / mpmath.sqrt(2 * mpmath.e) + m_0) <= 4 * _real(F_c)
        steep = sigma_1 == 0 or _real(sigma_1) * m_0 <= _real(F_s)
    if law == "lugre_arctan":
        return True if sigma_1 == 0 or slow else (None if damped else False)
    holds = sigma_1 * (F_s - F_c) <= sigma_2 * F_c
    if (holds and steep) or slow:
        return True
    return None if damped or holds else False


def _real(x: Fraction) -> Any:
    return mpmath.mpf(x.numerator) / x.denominator


# -- built-in laws: sets ------------------------------------------------------------------------------------------------


def ordinary(rng: random.Random, name: str) -> dict[str, float]:
    """Constants as machines have them."""
    values = {
        "F_c": _log(rng, 0.1, 1e3), "v_s": _log(rng, 1e-4, 0.1), "sigma_1": _log(rng, 1, 1e5),
    }  # fmt: skip
    values["F_s"] = values["F_c"] * rng.uniform(1.01, 2.5)
    values["sigma_0"] = values["F_s"] / _log(rng, 1e-7, 1e-4)
    values["sigma_2"] = values["sigma_1"] * _log(rng, 1e-3, 1e1)
    return {**values, **_own(rng, name, values, (1e1, 1e5), (0.1, 0.9))}


def extreme(rng: random.Random, name: str) -> dict[str, float]:
    """Constants at the ends of what can be written: ratios from 1e-12 to 1e12, F_s/F_c - 1 from 1e-10, zeros."""
    values = {"F_c": _log(rng, 1e-6, 1e6), "v_s": _log(rng, 1e-9, 1e3)}
    above = rng.choice([0.0, _log(rng, 1e-10, 1e-3), _log(rng, 1e-3, 1e3)])
    values["F_s"] = values["F_c"] * (1 + above)
    values["sigma_0"] = values["F_s"] / _log(rng, 1e-12, 1e3)
    values["sigma_1"] = rng.choice([0.0, _log(rng, 1e-9, 1e9), _log(rng, 1e-9, 1e9)])
    values["sigma_2"] = rng.choice([0.0, (values["sigma_1"] or 1.0) * _log(rng, 1e-12, 1e12)])
    return {**values, **_own(rng, name, values, (1e-6, 1e12), (1e-6, 0.999999))}


def threshold(rng: random.Random, name: str) -> dict[str, float]:
    """LuGre's condition met or missed by 1e-12 to 1e-6 of it."""
    values = ordinary(rng, name)
    values["F_s"] = values["F_c"] * (1 + rng.choice([1.0, _log(rng, 1e-10, 1.0)]))
    critical = values["sigma_1"] * (values["F_s"] - values["F_c"]) / values["F_c"]
    values["sigma_2"] = critical * (1 + rng.choice([-1, 1]) * _log(rng, 1e-12, 1e-6))
    if "/" in name and rng.random() < 0.5:  # k_v at its own sufficient condition
        values["k_v"] = 2 * values["sigma_1"] / values["F_s"] * (1 + rng.choice([0.0, 1e-9, 1.0]))
    return values


def falling(rng: random.Random, name: str) -> dict[str, float]:
    """Damping that falls with speed."""
    values = ordinary(rng, name)
    return values if name == "dahl" else {**values, "v_d": _log(rng, 1e-3, 1e3) * values["v_s"]}


def edge(rng: random.Random, name: str) -> dict[str, float]:
    """The last float before a limit: F_s one or two beyond F_c, k_v as small or large as can be written, damping 1e-12 or
    1e12 times another, v_d a billionth from what makes every set passive."""
    values = extreme(rng, name) if rng.random() < 0.5 else ordinary(rng, name)
    kind = rng.choice(["F_s", "k_v", "ratio", "v_d", "v_d"])
    if kind == "F_s":
        values["F_s"] = values["F_c"] * (1 + rng.choice([2**-52, 2**-51, 1e-15]))
        values["sigma_2"] = rng.choice([0.0, values["sigma_1"] * rng.choice([1e-16, 2**-51, 1e-14])])
    elif kind == "k_v" and "k_v" in values:
        values["k_v"] = rng.choice([5e-324, 1e-310, 1e-300, 1e300, 1.7e308])
    elif kind == "ratio":
        values["sigma_1"] = values["sigma_2"] * rng.choice([1e-12, 1e12])
        values["sigma_2"] = rng.choice([values["sigma_2"], 5e-324])
    elif name != "dahl" and values["sigma_1"] > 0:
        excess = {"atan": 2 / math.pi, "sqrt": 1.0, "compact": 0.375}.get(name.partition("/")[2], 0.0)
        room = 4 * values["F_c"] / values["sigma_1"] - excess / values.get("k_v", 1.0)
        if 0 < room < 1e300:
            values["v_d"] = math.sqrt(2 * math.e) * room * (1 + rng.choice([-1e-9, 1e-9, -1e-15]))
    return values


SETS = {"ordinary": ordinary, "extreme": extreme, "threshold": threshold, "v_d": falling, "edge": edge}


def _log(rng: random.Random, low: float, high: float) -> float:
    return float(low * (high / low) ** rng.random())


def _own(
    rng: random.Random, name: str, values: dict[str, float], steep: tuple[float, float], share: tuple[float, float]
) -> dict[str, float]:
    own = {}
    if name not in ("lugre", "elastoplastic", "dahl"):
        own["k_v"] = _log(rng, *steep) / values["v_s"]
    if name.startswith("elastoplastic"):
        own["z_ba"] = rng.uniform(*share) * values["F_c"] / values["sigma_0"]
    return own


def builtin(kind: str, given: Any) -> Iterator[Row]:
    """A row for each built-in law with sets of one kind."""
    for name in BUILTIN:
        row, (plain, _, majorant) = Row(f"{kind} {name}"), name.partition("/")
        for k in range(given.sets):
            values = SETS[kind](random.Random(f"{given.seed} {kind} {name} {k}"), name)
            row.sets += 1
            try:
                law = stribeck.law(plain, values, **({"smooth_abs": majorant} if majorant else {}))
            except stribeck.InputError:  # z_ba rounded up to F_c/sigma_0
                continue
            row.judge(f"{name} {values}", law, truth_of(name, values))
        say(f"{row.name}: {row.verdicts} verdicts, {len(row.wrong)} wrong, {row.undecided} undecided")
        yield row


def benchmark(given: Given) -> dict[str, Any]:
    """Counts over all laws, and the lines."""
    every = [*nasty(20 if given.quick else 1), *(row for kind in SETS for row in builtin(kind, given))]
    wrong, crashes = ([x for row in every for x in getattr(row, n)] for n in ("wrong", "crashes"))
    counts = {
        **{n: sum(getattr(row, n) for row in every) for n in ("laws", "verdicts", "undecided")},
        "wrong": len(wrong), "crashes": len(crashes), "cpu_seconds": sum(row.seconds for row in every),
        "slowest_law_cpu_seconds": max(row.slowest for row in every),
    }  # fmt: skip
    print(*wrong, *(f"CRASH {x}" for x in crashes), sep="\n")
    about = {"seed": given.seed, "sets": given.sets, "all": counts}
    return {**about, "rows": {row.name: asdict(row) for row in every}}


if __name__ == "__main__":
    results = run(benchmark, __doc__, "verdicts", sets=(20, 1), seed=0)
    sys.exit(1 if results["all"]["wrong"] or results["all"]["crashes"] else 0)
