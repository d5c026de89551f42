"""``stribeck gains``."""

from __future__ import annotations

from pathlib import Path

from stribeck.cli import show
from stribeck.cli.text import say
from stribeck.control.gains import Condition, GainVerdict, Proof, Staying
from stribeck.control.proof import derive
from stribeck.errors import InputError
from stribeck.loops import servo as analysis
from stribeck.loops.lyapunov import Along
from stribeck.loops.servo import check_servo
from stribeck.scenario import Scenario


def gains(path: Path, v_max: float | None, assignments: list[str], out: Path | None, json: bool, trust: bool) -> int:
    """Print whether V decreases for the scenario's gains: conditions, proof, and V along the simulation.

    A machine's controllers have no such V: what its gains do is what ``design`` says of them.
    """
    scenario = show.load(path, assignments, trust)
    if not scenario.rig.single:
        from stribeck.cli import design

        if v_max is not None:
            raise InputError("--v-max: must be left out: a machine's loop is judged at the speeds of its signals")
        return design.run(path, assignments, {}, out, json, trust)
    check_servo(scenario, v_max)
    if out is not None:
        show.check_folder(out)
    with show.progress(scenario.name) as tell:
        found = analysis.gains(scenario, v_max, tell)
    solution, summary, files = found.solution, found.summary(), list[str]()
    if out is not None:
        from stribeck.report.gains import write_gains

        files = write_gains(solution, found.verdict, found.proof, found.along, summary, out, show.command_line())
    if json:
        show.print_json(summary | ({"files": files} if out is not None else {}))
    else:
        _print(scenario, found.verdict, found.proof, list(found.not_covered), found.along)
        if found.staying is not None:
            _print_staying(found.staying, found.verdict.v_max)
        for file in files:
            print(f"  wrote {file}")
    if solution.status != "done":
        show.failed(scenario.name, solution.reason)
        return 1
    return 0


def _print_staying(stays: Staying, v_max: float) -> None:
    word = "stays" if stays.holds else "is not shown to stay"
    _line(
        f"from this start |v| {word} below {v_max:.4g} m/s (V falls, so |v| <= {stays.bound:.4g} m/s); so it does from "
        f"every start with V(0) < {stays.largest_V:.4g} J and lambda |e(0)| <= sqrt(2 V(0)/M)"
    )


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
