"""Over-compensation: the share above which a compensation at the measured speed exceeds the friction."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.loops.compensation import contact_of, with_compensation
from stribeck.loops.loop import controller_of
from stribeck.machine.elements.controllers import Cascade, Pid
from stribeck.scenario import Scenario
from stribeck.simulation.single import simulate_once

# Of the share, in the run that shows it: the surplus that accelerates the body must exceed the solver's error.
BEYOND = 0.05
_SPEEDS = 400  # over these decades: steps of 3 %, in which a steady curve is smooth
_DECADES = (1e-2, 1e3)  # of v_s: below, the Stribeck curve is flat at F_s; above, viscous friction decides
_OFF = {Pid: ("K_p", "K_i", "K_d"), Cascade: ("K_p", "K_v")}


@dataclass(frozen=True)
class Excess:
    """The share above which friction and compensation together accelerate the body.

    Attributes:
        share: the smallest share at which the steady net friction is negative at some speed, with the friction of the file.
        worst_share: the same with the worst sample of the friction.
        speed: the speed at which this happens with the worst sample, m/s or rad/s.
        sample: the friction parameters of that sample, by path.
        counterexample: the machine released at ``speed`` with a share 5 % above ``worst_share`` and no other control; it
            accelerates by itself. None if such a machine cannot be made or does not accelerate.
        ends: the speed at the end of that run, m/s or rad/s.
    """

    share: float
    worst_share: float
    speed: float
    sample: dict[str, float]
    counterexample: Scenario | None
    ends: float

    def row(self) -> dict[str, object]:
        """The result as plain data, for JSON."""
        run = None if self.counterexample is None else {"speed_at_first": self.speed, "speed_at_the_end": self.ends}
        return {
            "share": self.share, "worst_share": self.worst_share, "speed": self.speed, "sample": self.sample,
            "counterexample": run, "how": "steady curves, at speeds tried; the run is simulated",
        }  # fmt: skip


def excess(scenario: Scenario, controller: str, samples: dict[str, Array]) -> Excess:
    """The share above which the law as an observer at the measured speed exceeds the contact's friction.

    At constant speed the controller adds ``share`` times its own law's steady force, and the contact takes its steady
    friction. If the first is larger, net friction is negative, and the two together are not passive. A feedforward at the
    reference's speed does not depend on the motion and is not concerned.

    Raises:
        InputError: if the measured body has no contact with the ground.
    """
    contact = contact_of(scenario, controller)
    compensated = with_compensation(scenario, controller, contact, "measured", 1.0)
    each = controller_of(compensated, controller)
    assert each.compensation is not None
    law = compensated.elements.laws[f"contacts.{contact}.law"]
    observer = compensated.elements.laws[each.friction_path]
    scale = law.scales(law.p).speed
    v = scale * np.geomspace(*_DECADES, _SPEEDS)
    added = np.asarray(observer.steady_force(v))
    count = len(next(iter(samples.values())))
    rows = [{path: float(x[i]) for path, x in samples.items()} for i in range(count)]
    shares = np.array([_ratios(compensated, contact, row, v, added) for row in rows])
    i, k = (int(n) for n in np.unravel_index(int(np.argmin(shares)), shares.shape))
    worst, speed = float(shares[i, k]), float(v[k])
    file_share = float(_ratios(compensated, contact, {}, v, added).min())
    demonstration = _counterexample(compensated, controller, contact, rows[i], worst * (1 + BEYOND), speed)
    return Excess(file_share, worst, speed, rows[i], *demonstration)


def _ratios(scenario: Scenario, contact: str, sample: dict[str, float], v: Array, added: Array) -> Array:
    """Steady friction of the contact over the added force, at each speed; inf where no force is added."""
    changed = scenario.with_changes(sample) if sample else scenario
    taken = np.asarray(changed.elements.laws[f"contacts.{contact}.law"].steady_force(v))
    return np.asarray(np.where(added > 0, taken / np.where(added > 0, added, 1.0), np.inf))


def _counterexample(
    compensated: Scenario, controller: str, contact: str, sample: dict[str, float], share: float, speed: float
) -> tuple[Scenario | None, float]:
    """The body released at a speed with only friction and compensation; its last speed."""
    each = controller_of(compensated, controller)
    data = deepcopy(compensated.with_changes(sample).data)
    gains, body = _OFF.get(type(each)), data["bodies"][each.measures]
    if gains is None or "tied_to" in body or "velocity" in body:
        return None, speed
    table = data["controllers"][controller]
    data["bodies"] = {each.measures: {**body, "initial": {"y": 0.0, "v": speed}}}
    data["contacts"] = {contact: data["contacts"][contact]}
    for group in ("links", "loads", "motors"):
        data.pop(group, None)
    data["controllers"] = {controller: table}
    for name in ("limit", "sampling", "feedforward", "T_i", "dither"):
        table.pop(name, None)
    table |= {**dict.fromkeys(gains, 0.0), "on": each.measures}
    table["signal"] = {"kind": "step", "value": 0.0, "time": 0.0}
    table["compensation"]["share"] = share
    data["contacts"][contact].pop("loads", None)
    inertia = body.get("mass", body.get("inertia", 1.0))
    law = compensated.elements.laws[f"contacts.{contact}.law"]
    end = 20 * inertia * speed / max(BEYOND * float(law.steady_force(speed)), 1e-300)
    data["name"] = f"{compensated.name}_overcompensated"
    data["solve"], data["output"] = {"t_end": end}, {"step": end / 400, "energy": True}
    counterexample = Scenario(data, folder=compensated.folder, trust=True)
    run = simulate_once(counterexample)
    last = float(run[f"{each.measures}.v"][-1])
    return (counterexample if last > 1.5 * speed else None), last
