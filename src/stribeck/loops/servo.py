"""Whether the gains of a pneumatic servo make V decrease: conditions, proof, and V along the simulation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from stribeck.constants import require_positive
from stribeck.control.gains import GainVerdict, Proof, Staying, gain_verdict, prove, staying
from stribeck.control.proof import derive
from stribeck.errors import InputError
from stribeck.loops.lyapunov import Along, along
from stribeck.scenario import Scenario
from stribeck.scenario.cascade import CascadeSettings, cascade_of, not_linear
from stribeck.simulation import Solution, simulate


@dataclass(frozen=True)
class Gains:
    """What is found about the gains of a servo.

    Attributes:
        solution: the scenario simulated.
        verdict: the conditions at the speed ``verdict.v_max``, by how much they hold, and gains that do.
        proof: whether dV/dt <= 0 is proven by intervals for all errors and speeds up to it.
        along: V along the simulation; None where it has no row.
        staying: from which starts the speed stays below ``v_max``; None as before.
        not_covered: what of the scenario the proof does not cover, in words.
    """

    solution: Solution
    verdict: GainVerdict
    proof: Proof
    along: Along | None
    staying: Staying | None
    not_covered: tuple[str, ...]

    def summary(self) -> dict[str, object]:
        """What ``stribeck gains --json`` prints, without the files."""
        found: dict[str, object] = {
            "scenario": self.solution.scenario.name, "derivative": str(derive().derivative), **self.verdict.summary(),
            "proof": {"proven": self.proof.proven, "boxes": self.proof.boxes, "reason": self.proof.reason or None},
            "not_covered": list(self.not_covered),
        }  # fmt: skip
        simulation: dict[str, object] = {"status": self.solution.status, "reason": self.solution.reason}
        if self.staying is not None:
            found["staying"] = asdict(self.staying)
        if self.along is not None:
            simulation |= self.along.summary()
        return {**found, "simulation": simulation}


def gains(
    scenario: Scenario | str | Path | Mapping[str, object],
    v_max: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> Gains:
    """Whether the Lyapunov function V of a pneumatic servo (``drive.kind = "cascade"``) decreases with its gains.

    Args:
        scenario: a servo: a scenario, the path of its file, or its tables.
        v_max: the speed up to which it is asked, m/s; twice the peak of the simulation unless given.
        progress: called now and then with the share of the simulation done, 0 to 1.

    Raises:
        InputError: the scenario is no servo, its observer's law is not linear in z, or ``v_max`` is no speed.
        StribeckError: SymPy is not installed.
    """
    rig = Scenario.of(scenario)
    controller = check_servo(rig, v_max)
    solution = simulate(rig, progress)
    observer, d = controller.observer, rig.drive_values
    assert observer is not None
    speed = v_max if v_max is not None else 2 * max(solution.peaks["v"], 1e-6)
    verdict, proof = gain_verdict(observer, d, speed), prove(observer, d, (-speed, speed))
    if not len(solution.t):
        return Gains(solution, verdict, proof, None, None, doubts(rig, controller))
    return Gains(solution, verdict, proof, along(solution), _staying(rig, solution, speed), doubts(rig, controller))


def check_servo(scenario: Scenario, v_max: float | None) -> CascadeSettings:
    """The controller of a servo whose V can be asked about.

    Raises:
        InputError: as :func:`gains`.
    """
    if v_max is not None:
        require_positive("v_max", v_max, "m/s")
    if (controller := cascade_of(scenario)) is None:
        raise InputError(f"drive.kind: {scenario.drive.kind!r}: must be 'cascade': only a servo has such gains")
    if text := not_linear(controller.observer):
        raise InputError(f"drive.observer.name: no V that could be shown to decrease: {text}")
    return controller


def _staying(scenario: Scenario, solution: Solution, v_max: float) -> Staying:
    """Whether the speed stays where the gains are good; the path's speed is that of the rows, dy_d/dt = v - s + lambda e."""
    lag = scenario.drive_values["lambda"] * solution["e"]
    path = float(np.max(np.abs(solution["v"] - solution["s"] + lag)))
    return staying(v_max, scenario.plant_values["mass"], path, float(solution["V"][0]), float(lag[0]))


def doubts(scenario: Scenario, controller: CascadeSettings) -> tuple[str, ...]:
    """What of the scenario the proof does not cover."""
    found = []
    if controller.observer is not None and not controller.observer.same_as(scenario.law):
        found.append(
            "plant and observer differ: dV/dt gains sigma_1 d s + d z_err/K, the errors stay of the order of d"
        )
    if controller.model != scenario.plant_values:
        found.append("the controller knows another plant")
    if controller.sampling is not None:
        found.append("the controller is sampled")
    if controller.adaptation is not None:
        found.append("adapted parameters: V has further terms (docs/servo.md)")
    if scenario.drive_values.get("supply_droop"):
        found.append("the supply droops")
    return (*found, "a valve at its limit, and p_1 and p_2 one by one")
