"""``stribeck gains``."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from stribeck.analysis.lyapunov import Along, along
from stribeck.cli import show
from stribeck.cli.text import say
from stribeck.control.gains import Condition, GainVerdict, Proof, Staying, judge, prove, staying
from stribeck.control.proof import derive
from stribeck.errors import InputError
from stribeck.scenario import Scenario
from stribeck.scenario.servo import not_linear
from stribeck.simulation import Solution, simulate


def gains(path: Path, v_max: float | None, assignments: list[str], out: Path | None, json: bool, trust: bool) -> int:
    """Print whether V decreases for the scenario's gains: conditions, proof, and V along the simulation."""
    scenario = show.load(path, assignments, trust)
    if v_max is not None and not 0 < v_max < np.inf:
        raise InputError(f"--v-max: {v_max}: must be a finite speed > 0, m/s")
    if scenario.servo is None:
        raise InputError(f"drive.kind: {scenario.drive.kind!r}: 'stribeck gains' needs a servo, drive.kind = 'cascade'")
    observer = scenario.servo.observer
    if text := not_linear(observer):
        raise InputError(f"drive.observer.name: no V that could be shown to decrease: {text}")
    assert observer is not None
    if out is not None:
        show.check_folder(out)
    with show.progress(scenario.name) as tell:
        solution = simulate(scenario, tell)
    speed = v_max if v_max is not None else 2 * max(solution.peaks["v"], 1e-6)
    verdict = judge(observer, scenario.drive_values, speed)
    proof = prove(observer, scenario.drive_values, (-speed, speed))
    found = along(solution) if len(solution.t) else None
    doubts = _doubts(scenario)
    stays = _staying(scenario, solution, speed) if len(solution.t) else None
    summary: dict[str, Any] = {
        "scenario": scenario.name, "derivative": str(derive().derivative), **verdict.summary(),
        "proof": {"proven": proof.proven, "boxes": proof.boxes, "reason": proof.reason or None},
        "not_covered": doubts, "simulation": {"status": solution.status, "reason": solution.reason},
    }  # fmt: skip
    if stays is not None:
        summary["staying"] = asdict(stays)
    if found is not None:
        summary["simulation"] |= found.summary()
    if out is not None:
        from stribeck.report.gains import write

        summary["files"] = write(solution, verdict, proof, found, summary, out, show.command_line())
    if json:
        show.print_json(summary)
    else:
        _print(scenario, verdict, proof, doubts, found)
        if stays is not None:
            _print_staying(stays, speed)
        for file in summary.get("files", ()):
            print(f"  wrote {file}")
    if solution.status != "done":
        show.failed(scenario.name, solution.reason)
        return 1
    return 0


def _staying(scenario: Scenario, solution: Solution, v_max: float) -> Staying:
    """Whether the speed stays where the gains are good; the path's speed is that of the rows, dy_d/dt = v - s + lambda e."""
    d = scenario.drive_values
    lag = d["lambda"] * solution["e"]
    path = float(np.max(np.abs(solution["v"] - solution["s"] + lag)))
    assert scenario.servo is not None
    return staying(v_max, scenario.servo.plant["mass"], path, float(solution["V"][0]), float(lag[0]))


def _print_staying(stays: Staying, v_max: float) -> None:
    word = "stays" if stays.holds else "is not shown to stay"
    _line(
        f"from this start |v| {word} below {v_max:.4g} m/s (V falls, so |v| <= {stays.bound:.4g} m/s); so it does from "
        f"every start with V(0) < {stays.largest_V:.4g} J and lambda |e(0)| <= sqrt(2 V(0)/M)"
    )


def _doubts(scenario: Scenario) -> list[str]:
    """What of the scenario the proof does not cover."""
    servo, observer = scenario.servo, scenario.servo.observer if scenario.servo else None
    assert servo is not None
    assert observer is not None
    found = []
    if not observer.same_as(scenario.law):
        found.append(
            "plant and observer differ: dV/dt gains sigma_1 d s + d z_err/K, the errors stay of the order of d"
        )
    if servo.model != servo.plant:
        found.append("the controller knows another plant")
    if servo.sampling is not None:
        found.append("the controller is sampled")
    if servo.adaptation is not None:
        found.append("adapted parameters: V has further terms (docs/servo.md)")
    if scenario.drive_values.get("supply_droop"):
        found.append("the supply droops")
    return [*found, "a valve at its limit, and p_1 and p_2 one by one"]


def _print(scenario: Scenario, verdict: GainVerdict, proof: Proof, doubts: list[str], found: Along | None) -> None:
    d, v = scenario.drive_values, verdict
    given = f"K_D = {d['K_D']:g} N s/m, K = {d['K']:g} m/N, |v| <= {v.v_max:.4g} m/s, w <= {v.w_max:.4g} 1/s"
    say(f"{scenario.name}: {given}", 4)
    _line(f"dV/dt = {derive().derivative}")
    _print_condition("exact condition", v.exact)
    _print_condition("corrected (21)", v.sufficient)
    _line(f"corrected (21) also needs K < {v.largest_K_sufficient:.4g} m/N")
    if not v.exact.holds:
        _line(
            f"gains that hold with a factor of two to spare: K_D = {v.proposed['K_D']:.4g}, or K = {v.proposed['K']:.4g}"
        )
    word = {True: "proven", False: "refuted", None: "not settled"}[proof.proven]
    why = f" ({proof.reason})" if proof.reason else ""
    _line(f"dV/dt <= 0 for all errors and |v| <= {v.v_max:.4g} m/s, by intervals: {word}{why}, {proof.boxes} boxes")
    _line("not covered: " + "; ".join(doubts))
    if found is None:
        return
    s = found.summary()
    rises = f"rises by more than 1e-9 V(0) after {s['rises']} rows, by at most {s['largest_rise']:.3g} J"
    _line(f"along the simulation V goes from {s['V_0']:.4g} to {s['V_end']:.4g} J, {rises}")
    for what, key in (
        ("V rises", "rise_times"),
        ("dV/dt above (19)", "excess_times"),
        ("valve limited", "saturated_times"),
    ):
        if spans := s[key]:
            more = f" and {len(spans) - 4} more" if len(spans) > 4 else ""
            _line(f"{what}: t = " + ", ".join(f"{a:g} to {b:g}" for a, b in spans[:4]) + f" s{more}")


def _print_condition(name: str, c: Condition) -> None:
    holds = "holds" if c.holds else "does not hold"
    speed = "any speed" if c.largest_speed is None else f"{c.largest_speed:.4g} m/s"
    _line(f"{name}: {holds}; needs K_D >= {c.least_K_D:.4g} (margin {c.margin:.4g}); dV/dt <= 0 up to {speed}")


def _line(text: str) -> None:
    say(text, 4, "  ")
