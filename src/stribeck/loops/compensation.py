"""What may be done against friction, and how much of it: the largest share that stays quiet whatever the friction is
within its intervals, and the error that it leaves after a reversal."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.loops.judge import judge
from stribeck.loops.loop import Loop, controller_of, time_constant
from stribeck.loops.moves import Tracked, on_a_sine, reversal_errors
from stribeck.loops.shaken import frequency_for
from stribeck.scenario import Scenario

KINDS = ("none", "reference", "measured", "inner_loop", "dither")
_SHARES = np.array([0.25, 0.5, 0.75, 1.0, 1.25, 1.5])
_AMPLITUDES = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0])  # of a dither, in shares of the friction
_ROUNDS = 4  # of bisection between two shares: to 0.016
MOST_STEPS = 50_000  # of one lane, of which there are hundreds: some 200 slowest time constants of a sampled axis
_DITHERED = 4 * MOST_STEPS  # under a dither the steps are short, and a body creeps to its target
_FIRST = 4  # samples that a search begins with, all at their middles, lows and highs first; and so many that limit it are added
_BELOW = np.geomspace(1e-3, 1.0, 31)  # of v_s


@dataclass(frozen=True)
class CompensationResult:
    """One way to make up for friction.

    Attributes:
        kind: "none"; "reference": the steady curve at the signal's speed; "measured": the law as an observer at the
            measured speed; "inner_loop": that with dF/dt, led by the lag of the drive; "dither": an oscillation.
        share: of the friction that is made up for in ``reversal_error``: 1, or what stays quiet of it; of a dither the
            amplitude over the largest friction below v_s, of what is quiet the one that leaves the least worst error.
        largest_quiet_share: up to which the loop is quiet with every sample of the friction; None where it is not even
            quiet without, 1.5 (a dither's 3) where all shares looked at are.
        reversal_error: the largest error after a reversal of the standard sine, with the friction as in the file.
        worst_error: the same with the worst sample.
        loop: the machine with it.
        sine: how the standard sine is followed with it, with the friction as in the file.
        dither: its kind, amplitude and frequency, where it is one, and the least share from which on it is quiet.
        table: what stands under ``compensation`` of the controller at that share, where it is one.
    """

    kind: str
    share: float
    largest_quiet_share: float | None
    reversal_error: float
    worst_error: float
    loop: Loop
    sine: Tracked
    dither: dict[str, object] | None = None
    table: dict[str, object] | None = None

    def row(self) -> dict[str, object]:
        """What is told of it."""
        return {
            "kind": self.kind, "share": self.share, "largest_quiet_share": self.largest_quiet_share,
            "reversal_error": self.reversal_error, "worst_reversal_error": self.worst_error,
            **({"dither": self.dither} if self.dither else {}), **({"table": self.table} if self.table else {}),
        }  # fmt: skip


def contact_of(scenario: Scenario, controller: str) -> str:
    """The contact whose friction a controller can make up for: of the body that it measures, to the ground.

    Raises:
        InputError: there is none.
    """
    rig = scenario.rig
    each = controller_of(scenario, controller)
    for contact in rig.machine.contacts:
        if contact.ends == (each.measures,) and rig.values.get((contact.path, "ratio"), 1.0) == 1:
            return contact.name
    raise InputError(
        f"controllers.{controller}.measures: {each.measures}: no contact between it and the ground whose friction could be "
        "made up for"
    )


def kinds_of(loop: Loop, controller: str, contact: str) -> list[str]:
    """The kinds that the machine can have: an inner loop has a lag, a smooth law and a signal with a second derivative."""
    rig = loop.scenario.rig
    each = controller_of(loop.scenario, controller)
    law = rig.laws[f"contacts.{contact}.law"]
    smooth = law.differentiable and (rig.signals[each.use].smooth or rig.signals[each.use].kind == "ramp")
    return [kind for kind in KINDS if kind != "inner_loop" or (smooth and lag_of(loop.scenario, controller) > 0)]


def lag_of(scenario: Scenario, controller: str) -> float:
    """How far the force lags what is asked for, s: the motor's current, the delay, and half a period that a sample is held."""
    rig = scenario.rig
    each = controller_of(scenario, controller)
    motor = next((m for m in rig.machine.motors if m.name == each.on), None)
    lag = rig.values[motor.path, "current_time"] if motor is not None and motor.L is not None else 0.0
    if each.sampling is not None:
        own = f"{each.path}.sampling"
        lag += rig.values[own, "delay"] + rig.values[own, "period"] / 2
    return lag


def with_compensation(scenario: Scenario, controller: str, contact: str, kind: str, share: float) -> Scenario:
    """The machine with that compensation; its law is a copy, so that the contact's can be varied beside it."""
    data = deepcopy(scenario.data)
    table = data["controllers"][controller]
    own, shaken = table.pop("compensation", None) or {}, table.pop("dither", None)
    if kind == "dither":
        level = level_of(scenario, contact)
        frequency = shaken["frequency"] if shaken else frequency_for(scenario, controller, time_constant(scenario)[0])
        table["dither"] = {**(shaken or {"kind": "sine"}), "amplitude": share * level, "frequency": frequency}
    elif kind != "none":
        law = own.get("law") or data["contacts"][contact]["law"]
        speed = "reference" if kind == "reference" else "measured"
        table["compensation"] = {"speed": speed, "law": deepcopy(law), "share": share}
        if kind == "inner_loop":
            table["compensation"]["lead"] = own.get("lead") or lag_of(scenario, controller)
    return Scenario(data, folder=scenario.folder, trust=True)


def level_of(scenario: Scenario, contact: str) -> float:
    """The largest steady friction of a contact up to v_s, N or N m: what a dither has to overcome."""
    law = scenario.rig.laws[f"contacts.{contact}.law"]
    return float(np.max(law.steady_force(law.scales(law.p).speed * _BELOW)))


def compare(
    loop: Loop, controller: str, samples: dict[str, Array], tell: Callable[[float, str], None] | None = None
) -> list[CompensationResult]:
    """Each kind with its largest quiet share and the error that it leaves.

    Raises:
        InputError: the measured body has no contact with the ground.
    """
    contact = contact_of(loop.scenario, controller)
    kinds = kinds_of(loop, controller, contact)
    found, without = (
        list[CompensationResult](),
        np.array([j.quiet for j in judge(loop_without(loop, controller), samples, most_steps=MOST_STEPS)]),
    )
    for i, kind in enumerate(kinds):
        if tell is not None:
            tell(i / len(kinds), f"compensation: {kind}")
        made = replace(loop, scenario=with_compensation(loop.scenario, controller, contact, kind, 1.0))
        if kind == "none":
            remedy = _Remedy(made, samples, None, 1.0, without)
            found.append(_result(remedy, controller, kind, 0.0, 0.0 if without.all() else None))
        elif kind == "dither":
            found.append(_dithered(made, controller, samples, without))
        else:
            remedy = _Remedy(made, samples, f"controllers.{controller}.compensation.share", 1.0, without)
            largest = remedy.largest(_SHARES, _ROUNDS)
            found.append(_result(remedy, controller, kind, min(1.0, largest or 0.0), largest))
    return found


def loop_without(loop: Loop, controller: str) -> Loop:
    """The loop without any compensation of a controller."""
    return replace(loop, scenario=with_compensation(loop.scenario, controller, "", "none", 0.0))


@dataclass
class _Remedy:
    """A loop with a remedy whose share is turned, and which samples of the friction it is quiet with.

    Attributes:
        path: the number that is turned; None: nothing.
        unit: that number for a share of 1.
        without: by sample, whether the loop is quiet without the remedy.
        most_steps: of the solver for one lane.
        worst: the samples that limited it so far: all the others are asked at the end.
    """

    loop: Loop
    samples: dict[str, Array]
    path: str | None
    unit: float
    without: NDArray[np.bool_]
    most_steps: int = MOST_STEPS
    worst: NDArray[np.int64] = field(init=False)

    def __post_init__(self) -> None:
        self.worst = np.arange(min(_FIRST, len(self.without)))

    def lanes(self, shares: Array, which: NDArray[np.int64]) -> dict[str, Array]:
        """Every share with every one of these samples."""
        found = {p: np.tile(x[which], len(shares)) for p, x in self.samples.items()}
        return found if self.path is None else found | {self.path: np.repeat(self.unit * shares, len(which))}

    def quiet(self, shares: Array, which: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Whether each share is quiet with each of these samples."""
        found = np.array([j.quiet for j in judge(self.loop, self.lanes(shares, which), most_steps=self.most_steps)])
        return found.reshape(len(shares), len(which))

    def errors(self, controller: str, share: float | None, which: NDArray[np.int64]) -> Array:
        """The errors after reversals with these samples."""
        return reversal_errors(self.loop, controller, self.lanes(np.array([share or 0.0]), which))

    def holds(self, share: float) -> bool:
        """Whether it is quiet with every sample; those that are not are kept among the worst."""
        every = np.arange(len(self.without))
        bad = np.flatnonzero(~(self.without if share == 0 else self.quiet(np.array([share]), every)[0]))
        self.worst = np.unique(np.concatenate([self.worst, bad[:_FIRST]]))
        return not len(bad)

    def largest(self, shares: Array, rounds: int) -> float | None:
        """The largest share that is quiet with every sample: looked for with the worst ones, and asked of all; None where
        there is none."""
        if self.holds(float(shares[-1])):
            return float(shares[-1])
        high = np.inf
        while high > 0:
            tried = shares[shares < high]
            quiet = self.quiet(tried, self.worst).all(axis=1)
            first = len(tried) - 1 if quiet.all() else int(np.argmin(quiet))  # the first that is not
            low, high = (float(tried[first - 1]) if first else 0.0), float(tried[first])
            for _ in range(rounds):
                middle = (low + high) / 2
                low, high = (middle, high) if self.quiet(np.array([middle]), self.worst).all() else (low, middle)
            if self.holds(low):
                return low
            high = low
        return None


def _result(remedy: _Remedy, controller: str, kind: str, share: float, largest: float | None) -> CompensationResult:
    """What a remedy leaves at a share."""
    given = {} if remedy.path is None else {remedy.path: np.array([share])}
    sine = on_a_sine(remedy.loop, controller, given)
    own = float(sine.errors["reversal"] or 0.0) if "failed_at" not in sine.errors else np.nan
    worst = float(np.nanmax(remedy.errors(controller, share, np.arange(len(remedy.without)))))
    table = remedy.loop.scenario.data["controllers"][controller].get("compensation")
    table = {**deepcopy(table), "share": share} if table else None
    return CompensationResult(kind, share, largest, own, worst, remedy.loop, sine, table=table)


def _dithered(made: Loop, controller: str, samples: dict[str, Array], without: NDArray[np.bool_]) -> CompensationResult:
    """The amplitudes that stay quiet, and of these the one that leaves the least worst error."""
    table = made.scenario.data["controllers"][controller]["dither"]
    level = float(table["amplitude"])
    remedy = _Remedy(made, samples, f"controllers.{controller}.dither.amplitude", level, without, _DITHERED)
    remedy.holds(0.0)
    some = remedy.worst
    quiet = np.concatenate([[without.all()], remedy.quiet(_AMPLITUDES[1:], some).all(axis=1)])
    while quiet.any():  # what is quiet with the worst samples is asked of all
        last = int(np.flatnonzero(quiet)[-1])
        if remedy.holds(float(_AMPLITUDES[last])):
            break
        quiet[last] = False
    first = last = max((int(i) for i in np.flatnonzero(quiet)), default=0)
    while first and quiet[first - 1]:
        first -= 1
    shares = _AMPLITUDES[first : last + 1]
    left = [float(np.nanmax(remedy.errors(controller, float(share), some))) for share in shares]
    share = float(shares[int(np.argmin(left))])
    if not remedy.holds(share):
        share = float(_AMPLITUDES[last])
    found = _result(remedy, controller, "dither", share, float(_AMPLITUDES[last]) if quiet.any() else None)
    given = {**table, "amplitude": share * level, "least_quiet_share": float(_AMPLITUDES[first])}
    return replace(found, dither=given, table=None)
