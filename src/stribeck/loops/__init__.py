"""The command `design`: verdict, tracking errors and friction compensation of a machine's control loop.

The methods are explained in docs/explanation/design.md.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from stribeck.constants import which_controller
from stribeck.errors import InputError, arg, nearest, read_pairs
from stribeck.loops import boundary, compensation
from stribeck.loops.excess import Excess, excess
from stribeck.loops.judge import Judgment, judge
from stribeck.loops.loop import Loop, loop_of
from stribeck.loops.lyapunov import cascade_of
from stribeck.loops.moves import Moves, Tracked, errors, moves_of
from stribeck.loops.servo import ServoDesign, design_servo
from stribeck.loops.starts import Start, distinct_judgments, from_starts
from stribeck.loops.uncertainty import friction_intervals, friction_samples
from stribeck.scenario import Scenario
from stribeck.scenario.objects import Machine, scenario_of

if TYPE_CHECKING:
    from stribeck.mouth.document import Document

__all__ = ["Design", "ServoDesign", "design"]

Tell = Callable[[float, str], None]


@dataclass(frozen=True)
class Design:
    """The result of :func:`design` for a machine with a controller.

    Attributes:
        loop: the machine with signals that end at rest, and its slowest time constant.
        controller: name of the controller that is judged.
        judgment: the verdict: "quiet", "creeping", "hunting", "unstable" or "failed", with amplitude and period.
        tracked: signal, position and tracking errors of each move ("file", "sine", "slow_ramp", "step").
        lines: the verdict along each varied path, with its boundaries.
        compensations: each remedy against friction, with its largest quiet share and the error that remains.
        why_not: why compensations were not compared; empty if they were.
        excess: the share above which compensation at the measured speed exceeds the friction.
        starts: the judgment from each of many starts.
        moves: amplitude (m or rad) and greatest speed of the standard moves.
    """

    loop: Loop
    controller: str
    judgment: Judgment
    tracked: dict[str, Tracked]
    lines: list[boundary.PathVerdicts]
    compensations: list[compensation.CompensationResult]
    why_not: str
    excess: Excess | None
    starts: list[Start]
    moves: Moves

    @property
    def verdict(self) -> str:
        """The verdict in one word."""
        return self.judgment.verdict

    @property
    def failed(self) -> str | None:
        """Why the simulation failed."""
        return self.judgment.note if self.verdict == "failed" else None

    @property
    def errors(self) -> dict[str, dict[str, float | None]]:
        """Tracking errors of each move, namely peak, rms, reversal, standstill (m or rad) and settling time (s)."""
        return {name: each.errors for name, each in self.tracked.items()}

    def document(self) -> Document:
        """The design as a document, for the terminal and for a page."""
        from stribeck.loops import said

        return said.design(self)

    def to_dict(self) -> dict[str, object]:
        """Plain data, as ``stribeck design --json`` prints it."""
        j = self.judgment
        cycle = {"amplitude": j.amplitude, "period": j.period, "body": j.body}
        return {
            "status": "failed" if self.verdict == "failed" else "done",
            "scenario": self.loop.scenario.name,
            "verdict": None if self.verdict == "failed" else self.verdict,
            "why": j.note or None,
            "limit_cycle": cycle if self.verdict == "hunting" else None,
            "starts": [start.row() for start in self.starts],
            "depends_on_the_start": len(distinct_judgments(self.starts, j)) > 1,
            "slowest_time_constant": self.loop.slowest,
            "held_signals": list(self.loop.held),
            "errors": self.errors,
            "moves": {**asdict(self.moves), "period": self.moves.period},
            "boundaries": [asdict(b) for x in self.lines for b in x.boundaries],
            "mixed": [asdict(m) for x in self.lines for m in x.mixed],
            "scans": [{"path": x.turned.path, "points": len(x.values), "resolution": x.resolution} for x in self.lines],
            "compensations": [c.row() for c in self.compensations],
            "compensations_missing": self.why_not or (None if self.compensations else "not asked for"),
            "over_compensation": self.excess.row() if self.excess else None,
        }


def design(
    machine: Scenario | Machine | str | Path | Mapping[str, object],
    vary: Sequence[str] = (),
    compensate: bool = False,
    uncertainty: str | Path | None = None,
    controller: str | None = None,
    v_max: float | None = None,
    tell: Tell | None = None,
) -> Design | ServoDesign:
    """Judge a machine's loop: does it hunt, how well does it track, which remedy helps.

    Args:
        machine: a machine (schema = 2) with a controller, or a body under a PID controller (schema = 1), whose parts are then
            called ``body``, ``contact`` and ``controller``; its file or its tables.
        vary: ranges ``"PATH=LOW:HIGH"`` in which boundaries of the verdict are searched.
        compensate: whether remedies against friction are compared.
        uncertainty: a parameters.toml with intervals of the friction parameters; 10 % both ways unless given.
        controller: name of the controller; the first unless given.
        v_max: largest speed of a servo's proof, m/s; twice the peak of its motion unless given.
        tell: called with the completed share of the present part, and the part's name.

    Raises:
        InputError: if the machine has no controller, or lacks a path or name; one line for each problem.
    """
    scenario = scenario_of(machine, None, None)
    if (cascade := cascade_of(scenario)) is not None:
        given = {"vary": vary, "compensate": compensate, "uncertainty": uncertainty, "controller": controller}
        if wrong := [arg(key) for key, value in given.items() if value]:
            text = "must be left out: a servo is judged by its Lyapunov function"
            raise InputError([f"{key}: {text}" for key in wrong])
        return design_servo(scenario, cascade, v_max, tell)
    if v_max is not None:
        raise InputError(f"{arg('v_max')}: must be left out: only a servo (drive.kind = 'cascade') has such a proof")
    loop = loop_of(scenario)
    known = [c.name for c in loop.scenario.system.controllers]
    name, ranges = which_controller(controller or known[0], known), _ranges(scenario, loop, vary)
    samples = friction_samples(friction_intervals(loop.scenario, uncertainty))

    def part(text: str) -> Callable[[float], None]:
        return lambda share: None if tell is None else tell(share, text)

    judgment = judge(loop, tell=part("verdict"))[0]
    starts = from_starts(loop, name, part("other starts"))
    part("tracking errors")(0.0)
    tracked = errors(loop, name)
    lines = [boundary.line(loop, x, part(f"boundaries of {x.path}"), scenario.path_in_machine(x.path)) for x in ranges]
    compensations, over, why_not = list[compensation.CompensationResult](), None, ""
    if compensate:
        try:
            compensations, over = compensation.compare(loop, name, samples, tell), excess(loop.scenario, name, samples)
        except InputError as error:
            why_not = str(error)
    return Design(loop, name, judgment, tracked, lines, compensations, why_not, over, starts, moves_of(loop, name))


def _ranges(scenario: Scenario, loop: Loop, vary: Sequence[str]) -> list[boundary.Turned]:
    def read(text: str) -> tuple[str, boundary.Turned]:
        turned = boundary.Turned.parse(text)
        if scenario.path_in_machine(turned.path) not in loop.scenario.places:
            known = nearest(turned.path, scenario.places)
            raise InputError(f"{arg('vary')}: {turned.path}: no number of the machine{known}")
        return turned.path, turned

    return list(read_pairs(read, vary, arg("vary")).values())
