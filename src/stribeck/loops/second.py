"""A second opinion on hunting: what describing functions say of the loop without its sampling and limit."""

from __future__ import annotations

from typing import TypedDict

from stribeck.analysis.hunting import Hunting, hunting
from stribeck.errors import StribeckError
from stribeck.loops.loop import Loop, controller_of
from stribeck.machine.controllers import Cascade, PidController
from stribeck.scenario import Scenario


class PredictedCycle(TypedDict, total=False):
    """A predicted cycle, m or rad and s, None where there is none; or why nothing can be said."""

    amplitude: float | None
    period: float | None
    mismatch: float
    why_not: str


class SecondOpinion(TypedDict, total=False):
    """What each way says, and what of the loop was left out; or why nothing can be said."""

    left_out: list[str]
    law: PredictedCycle
    body: PredictedCycle
    why_not: str


def second_opinion(loop: Loop, controller: str) -> SecondOpinion:
    """By ``law`` and by ``body`` (:func:`stribeck.hunting`): amplitude and period, None where no cycle is predicted;
    ``why_not`` where the machine is none that they are for."""
    found = as_pid(loop, controller)
    if isinstance(found, str):
        return {"why_not": found}
    scenario, left_out = found
    return {"left_out": left_out, "law": _cycle(scenario, "law"), "body": _cycle(scenario, "body")}


def _cycle(scenario: Scenario, way: str) -> PredictedCycle:
    try:
        return as_row(hunting(scenario, way))
    except StribeckError as error:
        return {"why_not": str(error)}


def as_row(found: Hunting) -> PredictedCycle:
    """A predicted cycle as plain data."""
    some = found.amplitude == found.amplitude
    return {
        "amplitude": found.amplitude if some else None, "period": found.period if some else None,
        "mismatch": found.mismatch,
    }  # fmt: skip


def as_pid(loop: Loop, controller: str) -> tuple[Scenario, list[str]] | str:
    """The loop as a mass, a law and a PID controller (schema = 1), and what of it was left out; or why it is none."""
    scenario = loop.scenario
    rig = scenario.rig
    machine, each = rig.machine, controller_of(scenario, controller)
    free = [body for body in machine.bodies if body.leader is None]
    if len(free) != 1 or machine.links or machine.loads or len(machine.contacts) != 1:
        return "describing functions are for one body with one contact and nothing else"
    contact = machine.contacts[0]
    body = free[0]
    if (
        contact.levels
        or contact.factors
        or contact.span.end is not None
        or rig.values.get((contact.path, "ratio"), 1.0) != 1
    ):
        return "describing functions are for a contact with the ground whose level is constant"
    gains = pid_gains(each.kind, {n: rig.values[each.path, n] for n in each.kind.numbers(each.form)})
    if gains is None:
        return "describing functions are for pid and cascade"
    if not gains["K_i"]:
        return "without an integral they predict no cycle"
    left_out = [
        n
        for n, on in (("sampling", each.sampling), ("compensation", each.compensation), ("dither", each.dither))
        if on is not None
    ]
    left_out += ["limit"] if "limit" in each.form else []
    left_out += ["the motor's inductance and voltage"] if each.on not in machine.body else []
    law = scenario.data["contacts"][contact.name]["law"]
    drive = {"kind": "pid", **gains, "signal": {"kind": "step", "time": 0.0, "value": 1.0}}
    mass = sum(
        rig.values[b.path, b.inertia_name] * rig.values.get((b.path, "ratio"), 1.0) ** (0 if b is body else 2)
        for b in machine.bodies if b.inertia
    )  # fmt: skip
    tables = {
        "schema": 1,
        "law": law,
        "plant": {"mass": mass},
        "drive": drive,
        "solve": {"t_end": 1.0},
        "output": {"step": 1.0},
    }
    return Scenario(tables, folder=scenario.folder, trust=True), left_out


def pid_gains(kind: type, own: dict[str, float]) -> dict[str, float] | None:
    """The gains of the PID controller that does the same while the signal rests."""
    if kind is PidController:
        return {n: own[n] for n in ("K_p", "K_i", "K_d")}
    if kind is not Cascade:
        return None
    K_p, K_v, T_i = own["K_p"], own["K_v"], own.get("T_i")
    if T_i is None:
        return {"K_p": K_v * K_p, "K_i": 0.0, "K_d": K_v}
    # u = K_v (K_p e - v) + K_v/T_i (K_p integral of e - (y - y(0))) with e = r - y
    return {"K_p": K_v * K_p + K_v / T_i, "K_i": K_v * K_p / T_i, "K_d": K_v}
