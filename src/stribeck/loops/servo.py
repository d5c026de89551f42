"""The Lyapunov function V of a pneumatic servo: conditions on the gains, proof, and V along the simulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from stribeck.constants import require_positive
from stribeck.errors import InputError
from stribeck.loops.gains import GainVerdict, Proof, Staying, gain_verdict, prove, staying
from stribeck.loops.lyapunov import Along, along, gains_of
from stribeck.loops.proof import derive
from stribeck.machine.elements.controllers.pressure_cascade import PressureCascade, not_linear
from stribeck.scenario import Scenario
from stribeck.simulation import Solution, simulate

if TYPE_CHECKING:
    from stribeck.mouth.document import Document


@dataclass(frozen=True)
class ServoDesign:
    """The result of ``design`` for a pneumatic servo: whether its Lyapunov function V decreases with its gains.

    Attributes:
        solution: the simulation of the scenario.
        gains: the conditions at the speed ``gains.v_max``, their margins, and gains that meet them.
        proof: whether interval arithmetic proves dV/dt <= 0 for all errors and all speeds up to ``gains.v_max``.
        along: V along the simulation; None if the simulation has no rows.
        staying: the starts from which the speed stays below ``v_max``; None if the simulation has no rows.
        not_covered: the parts of the scenario that the proof does not cover, in words.
    """

    solution: Solution
    gains: GainVerdict
    proof: Proof
    along: Along | None
    staying: Staying | None
    not_covered: tuple[str, ...]

    @property
    def failed(self) -> str | None:
        """Why the simulation failed."""
        return self.solution.reason if self.solution.status != "done" else None

    def document(self) -> Document:
        """The design as a document for the terminal and for a page."""
        from stribeck.loops import servo_said

        return servo_said.servo(self)

    def to_dict(self) -> dict[str, object]:
        """Plain data, as ``stribeck design --json`` prints it."""
        result: dict[str, object] = {
            "scenario": self.solution.scenario.name, "derivative": str(derive().derivative), **asdict(self.gains),
            "proof": {"proven": self.proof.proven, "boxes": self.proof.boxes, "reason": self.proof.reason or None},
            "not_covered": list(self.not_covered),
        }  # fmt: skip
        simulation: dict[str, object] = {"status": self.solution.status, "reason": self.solution.reason}
        if self.staying is not None:
            result["staying"] = asdict(self.staying)
        if self.along is not None:
            simulation |= self.along.summary()
        return {**result, "simulation": simulation}


def design_servo(
    rig: Scenario,
    controller: PressureCascade,
    v_max: float | None = None,
    tell: Callable[[float, str], None] | None = None,
) -> ServoDesign:
    """Decide whether V decreases with the gains of a servo (``drive.kind = "cascade"``).

    Args:
        rig: the servo.
        controller: its cascade.
        v_max: the largest speed of the proof, m/s; twice the peak speed of the simulation unless given.
        tell: called with the completed share of the simulation and a description of this step.

    Raises:
        InputError: the observer's law is not linear in z, or ``v_max`` is no speed.
        StribeckError: SymPy is not installed.
    """
    if v_max is not None:
        require_positive("v_max", v_max, "m/s")
    if text := not_linear(controller.observer_law):
        raise InputError(f"drive.observer.name: no V that could be shown to decrease: {text}")
    solution = simulate(rig, progress=None if tell is None else lambda share: tell(share, "the servo's motion"))
    observer, d = controller.observer_law, controller.gains
    assert observer is not None
    speed = v_max if v_max is not None else 2 * max(solution.peaks["v"], 1e-6)
    verdict, proof = gain_verdict(observer, d, speed), prove(observer, d, (-speed, speed))
    if not len(solution.t):
        return ServoDesign(solution, verdict, proof, None, None, doubts(rig, controller))
    stays = _staying(rig, solution, speed)
    return ServoDesign(solution, verdict, proof, along(solution), stays, doubts(rig, controller))


def _staying(scenario: Scenario, solution: Solution, v_max: float) -> Staying:
    """Whether the speed stays below ``v_max``. The path's speed follows from the rows: dy_d/dt = v - s + lambda e."""
    lag = gains_of(scenario)["lambda"] * solution["e"]
    path = float(np.max(np.abs(solution["v"] - solution["s"] + lag)))
    return staying(v_max, scenario.elements.values["bodies", "mass"], path, float(solution["V"][0]), float(lag[0]))


def doubts(scenario: Scenario, controller: PressureCascade) -> tuple[str, ...]:
    """The parts of the scenario that the proof does not cover."""
    reasons = []
    if controller.observer_law is not None and not controller.observer_law.same_as(scenario.law):
        reasons.append(
            "plant and observer differ: dV/dt gains sigma_1 d s + d z_err/K, the errors stay of the order of d"
        )
    piston = scenario.elements.bodies[controller.on]
    if any(x != getattr(piston, n) for n, x in controller.model):
        reasons.append("the controller knows another plant")
    if controller.sampling is not None:
        reasons.append("the controller is sampled")
    if controller.adaptive:
        reasons.append("adapted parameters: V has further terms (docs/explanation/servo.md)")
    if controller.supply_droop:
        reasons.append("the supply droops")
    return (*reasons, "a valve at its limit, and p_1 and p_2 one by one")
