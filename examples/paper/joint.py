"""One machine: a geared joint that creeps, whose friction grows with its load, that hunts, and what the level proof says."""

from __future__ import annotations

from typing import Any

import numpy as np

from examples.paper.common import Chapter, Done, Printed, finish
from stribeck.errors import StribeckError
from stribeck.laws.render import ranges_in_words
from stribeck.mouth import plots
from stribeck.mouth.document import Table
from stribeck.properties import WORK, Verdict
from stribeck.properties.checked import CheckedAlways, largest_v_d
from stribeck.properties.ranges import of_contact
from stribeck.properties.worst import Varied
from stribeck.scenario import Scenario
from stribeck.simulation import Solution, simulate

_SET = {"sigma_0": 2.5e3, "sigma_1": 30.0, "sigma_2": 0.5, "F_c": 0.6, "F_s": 1.0, "v_s": 0.02}
_GAIN = {"F_c": 0.06, "F_s": 0.09}
_V_D, _SWING = 0.05, 2.0
_LOADED, _BARE = "friction with its load", "without"
_PLASTIC, _ELASTIC = "lugre_majorant", "elastoplastic_majorant"
_TORQUE = [[0.0, 0.5, 8.5, 9.0], [0.0, 0.22, 0.22, 0.0]]  # s, and N m at the arm: below sigma_0 z_ba of the mesh


def _machine(law: str, loads: bool = True, hunts: bool = False) -> dict[str, object]:
    """The joint: a rotor, a gear, an arm; the mesh rubs the more the gear carries."""
    own = {"z_ba": 1e-4} if law == _ELASTIC else {}
    mesh = {"name": law, "k_v": 1e5, "v_d": _V_D, **own, "parameters": _SET}
    bearing = {"name": _PLASTIC, "k_v": 1e4, "parameters": {
        "sigma_0": 0.02, "sigma_1": 2e-5, "sigma_2": 1e-5, "F_c": 4e-5, "F_s": 5e-5, "v_s": 2.0}}  # fmt: skip
    gain = _GAIN if loads else dict.fromkeys(_GAIN, 0.0)
    torque = {"kind": "points", "t": _TORQUE[0], "value": [0.0 if hunts else 0.01 * x for x in _TORQUE[1]]}
    target = {"kind": "point_to_point", "t": [0.2, 1.7], "value": [0.0, 0.5]}
    tuned = {"K_p": 0.3, "K_i": 0.4, "K_d": 0.03} if hunts else {"K_p": 0.0, "K_i": 0.0, "K_d": 0.0}
    return {
        "schema": 2, "name": "joint",
        "bodies": {"rotor": {"inertia": 3.1e-5}, "arm": {"inertia": 0.35}},
        "links": {"gear": {"from": "rotor", "to": "arm", "ratio": 0.01, "stiffness": 9e3, "damping": 3.0}},
        "contacts": {
            "bearing": {"from": "rotor", "law": bearing},
            "mesh": {"from": "arm", "law": mesh, "loads": [{"force": "gear", **gain}]},
        },
        "loads": {"push": {"on": "rotor", "kind": "signal", "signal": torque}},
        "controllers": {"axis": {"kind": "pid", "on": "rotor", "measures": "arm", "signal": target, **tuned}},
        "solve": {"t_end": 30.0 if hunts else 10.0, "rtol": 1e-7}, "output": {"step": 0.03 if hunts else 0.01},
    }  # fmt: skip


def chapter(done: Done) -> Chapter:
    """Creep, friction that grows with the load, hunting, and the proof."""
    held = {law: _solve(_machine(law)) for law in (_PLASTIC, _ELASTIC)}
    hunting = {label: _solve(_machine(_ELASTIC, label == _LOADED, True)) for label in (_LOADED, _BARE)}
    contacts, swung = _contacts()
    numbers = _numbers(held, hunting, contacts, swung)
    cost, time = (swung.evidence[n] for n in ("energy_drawn_per_cycle", "time_per_cycle"))
    left, moves = numbers["left_behind"], numbers["hunting"]
    text = (
        "A joint as robots have it: a rotor, a gear of 1:100, an arm. The mesh of the gear rubs with F_c + 0.06 |f| and "
        "F_s + 0.09 |f|, f the torque that the gear carries; the rotor turns in a bearing.",
        f"Pushed by {_TORQUE[1][1]:g} N m for 8 s and let go, the arm is left {1e6 * left[_PLASTIC]:.3g} µrad away with the "
        f"majorant law in the mesh, and {1e6 * left[_ELASTIC]:.2g} µrad with its elasto-plastic version, which is elastic below "
        "sigma_0 z_ba.",
        "A position loop with an integral: with the friction that the load adds it hunts, by "
        f"{1e3 * moves[_LOADED]:.3g} mrad; without it the same loop comes to rest ({1e3 * moves[_BARE]:.2g} mrad).",
        "The gear's torque has no bound that the file knows, and the level swings with it. The mesh is passive all the same, as "
        f"its damping falls with speed: v_d = {_V_D:g} rad/s, and up to {numbers['largest_v_d']:.3g} rad/s would do. Without v_d "
        f"it is not: with a level that doubles, {1e3 * cost:.3g} mJ can be drawn in each cycle of {time:.2g} s. The steady "
        "curve is the same with v_d and without.",
    )
    rows = [[n, v.law.name, _of(v), _word(verdict)] for n, (v, verdict) in contacts.items()]
    rows.append(["mesh without v_d", _ELASTIC, f"F_c and F_s up to {_SWING:g} times theirs", _word(swung)])
    rows.append(["the joint", "from torques to speeds", "", "yes" if numbers["machine_passive"] else "not shown"])
    table = Table(["contact", "law", "what varies", "passive"], rows, prose=True)
    return Chapter("joint", "One machine: a geared joint", text, [table], [_figure(held, hunting, swung)], numbers)


def _solve(tables: dict[str, object]) -> Solution:
    solution = simulate(Scenario(tables))
    if solution.reason:
        raise StribeckError(f"the joint failed: {solution.reason}")
    return solution


def _contacts() -> tuple[dict[str, tuple[Varied, Verdict]], Verdict]:
    """Each contact for all that its load can do, and the mesh without v_d while its level doubles."""
    scenario = Scenario(_machine(_ELASTIC))
    result = {}
    for contact in scenario.system.contacts:
        varied = of_contact(scenario.elements, contact, scenario.end, {})
        result[contact.name] = varied, CheckedAlways(varied, None, WORK).passive()
    law = scenario.elements.laws["contacts.mesh.law"]
    bare = type(law)({**law.values, **law.choices, "v_d": None}, law.rotary)
    return result, CheckedAlways(Varied.by_level(bare, 1.0, _SWING), None, WORK).passive()


def _numbers(
    held: dict[str, Solution], hunting: dict[str, Solution], contacts: dict[str, tuple[Varied, Verdict]], swung: Verdict
) -> dict[str, Any]:
    return {
        "left_behind": {law: float(s["arm.y"][-1]) for law, s in held.items()},
        "hunting": {label: float(np.ptp(s["arm.y"][s.t >= 15.0])) for label, s in hunting.items()},
        "passive": {name: verdict.holds for name, (_, verdict) in contacts.items()},
        "machine_passive": all(verdict.holds for _, verdict in contacts.values()),
        "largest_v_d": largest_v_d(contacts["mesh"][0]),
        "swung": {n: swung.evidence[n] for n in ("energy_drawn_per_cycle", "time_per_cycle")},
    }


def _of(varied: Varied) -> str:
    return ranges_in_words(varied.to_dict(), varied.law) or "nothing"


def _word(verdict: Verdict) -> str:
    return {True: "yes, proved", False: "no, a run draws energy", None: "undecided"}[verdict.holds]


def _figure(held: dict[str, Solution], hunting: dict[str, Solution], swung: Verdict) -> Printed:
    drawn = _solve(swung.scenario or {})
    with plots.style():
        built, axes = plots.figure([["creep", "friction"], ["hunts", "energy"]], 5.4)
        for i, (law, s) in enumerate(held.items(), start=1):
            plots.line(axes["creep"], i, s.t, 1e6 * s["arm.y"], law)
        axes["creep"].set(xlabel="t (s)", ylabel="arm (µrad)", title="pushed for 8 s, and let go")
        for i, (label, s) in enumerate(hunting.items(), start=1):
            early = s.t <= 4.0
            plots.line(axes["friction"], i, s.t[early], s["mesh.F"][early], label)
            plots.line(axes["hunts"], i, s.t, 1e3 * (s["arm.y"] - s["axis.r"][-1]), label)
        axes["friction"].set(xlabel="t (s)", ylabel="friction of the mesh (N m)", title="on the way to the target")
        axes["hunts"].set(xlabel="t (s)", ylabel="arm - target (mrad)", title="at the target", ylim=(-30, 30))
        plots.line(axes["energy"], 3, drawn.t, 1e3 * drawn["E_in"], "put in, in all")
        axes["energy"].axhline(0.0, color=plots.GRAY, linewidth=0.8)
        axes["energy"].set(xlabel="t (s)", ylabel="energy put in (mJ)", title="mesh without v_d, its level swung")
        for name in ("creep", "friction", "hunts"):
            axes[name].legend()
        return finish(
            built, "joint",
            "A geared joint. Above: what a push leaves behind, and friction on the way to a target. Below: the loop at the "
            "target, which hunts with the friction that the load adds; and the mesh without v_d, its level swung between 1 "
            f"and {_SWING:g}: every cycle takes the energy put in further below 0.",
        )  # fmt: skip
