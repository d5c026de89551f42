"""Remedies against friction: the largest share of each that stays quiet, and the error after a reversal that remains.

Both hold for every sample of the friction parameters within their intervals.
"""

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

KINDS = {  # in words
    "none": "none", "reference": "feedforward at the signal's speed", "measured": "observer at the measured speed",
    "inner_loop": "observer with dF/dt, led by the lag", "dither": "dither",
}  # fmt: skip
# tried first: from a quarter of the friction to clear over-compensation
_SHARES = np.array([0.25, 0.5, 0.75, 1.0, 1.25, 1.5])
_AMPLITUDES = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0])  # of a dither, in shares of the friction
_ROUNDS = 4  # of bisection between two shares: to 0.25/2**4 = 0.016
MOST_STEPS = 50_000  # of one lane, of which there are hundreds: some 200 slowest time constants of a sampled axis
_DITHERED = 4 * MOST_STEPS  # under a dither the steps are short, and a body creeps to its target
_FIRST = 4  # samples that a search begins with: middle, all low, all high and one more; a failed check adds as many
_BELOW = np.geomspace(1e-3, 1.0, 31)  # of v_s: the speeds among which the largest friction is searched


@dataclass(frozen=True)
class CompensationResult:
    """One remedy against friction.

    Attributes:
        kind: "none", "reference" (the steady curve at the signal's speed), "measured" (the law as an observer at the
            measured speed), "inner_loop" (that with dF/dt, led by the lag of the drive), or "dither" (an oscillation).
        share: the compensated share of the friction in ``reversal_error``: 1, or the largest quiet share below 1. For a
            dither: amplitude over the largest friction below v_s; the quiet amplitude with the least worst error.
        largest_quiet_share: the loop is quiet up to here with every sample of the friction. None if it is not quiet at
            0; 1.5 (3 for a dither) if it is quiet at all shares tried.
        reversal_error: the largest error after a reversal of the standard sine, with the friction of the file (m or rad).
        worst_error: the same with the worst sample (m or rad).
        loop: the machine with this remedy.
        sine: signal and position on the standard sine with this remedy, with the friction of the file.
        dither: for a dither: kind, amplitude, frequency, and the least quiet share.
        table: for a compensation: the controller's table ``compensation`` at ``share``.
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
        """The result as plain data, for JSON."""
        return {
            "kind": self.kind, "share": self.share, "largest_quiet_share": self.largest_quiet_share,
            "reversal_error": self.reversal_error, "worst_reversal_error": self.worst_error,
            **({"dither": self.dither} if self.dither else {}), **({"table": self.table} if self.table else {}),
        }  # fmt: skip


def contact_of(scenario: Scenario, controller: str) -> str:
    """Name of the contact whose friction a controller can compensate: between the measured body and the ground.

    Raises:
        InputError: if there is none.
    """
    machine = scenario.elements
    each = controller_of(scenario, controller)
    for contact in machine.system.contacts:
        if contact.ends == (each.measures,) and machine.values.get((contact.path, "ratio"), 1.0) == 1:
            return contact.name
    raise InputError(
        f"controllers.{controller}.measures: {each.measures}: no contact between it and the ground whose friction could be "
        "compensated"
    )


def kinds_of(loop: Loop, controller: str, contact: str) -> list[str]:
    """The remedies that suit the machine; an inner loop needs a lag, a smooth law and a signal with a second derivative."""
    machine = loop.scenario.elements
    each = controller_of(loop.scenario, controller)
    law = machine.laws[f"contacts.{contact}.law"]
    smooth = law.differentiable and (machine.signals[each.use].smooth or machine.signals[each.use].kind == "ramp")
    return [kind for kind in KINDS if kind != "inner_loop" or (smooth and lag_of(loop.scenario, controller) > 0)]


def lag_of(scenario: Scenario, controller: str) -> float:
    """Lag of the force behind the controller's output, s: the motor's current, the delay, and half a sampling period."""
    machine = scenario.elements
    each = controller_of(scenario, controller)
    motor = next((m for m in machine.system.motors if m.name == each.on), None)
    lag = machine.values[motor.path, "current_time"] if motor is not None and motor.L is not None else 0.0
    if each.sampling is not None:
        sampling = f"{each.path}.sampling"
        lag += machine.values[sampling, "delay"] + machine.values[sampling, "period"] / 2
    return lag


def with_compensation(scenario: Scenario, controller: str, contact: str, kind: str, share: float) -> Scenario:
    """The machine with a remedy; its law is a copy, so that the contact's can be varied independently."""
    data = deepcopy(scenario.data)
    table = data["controllers"][controller]
    given, dither = table.pop("compensation", None) or {}, table.pop("dither", None)
    if kind == "dither":
        level = level_of(scenario, contact)
        frequency = dither["frequency"] if dither else frequency_for(scenario, controller, time_constant(scenario))
        table["dither"] = {**(dither or {"kind": "sine"}), "amplitude": share * level, "frequency": frequency}
    elif kind != "none":
        law = given.get("law") or data["contacts"][contact]["law"]
        speed = "reference" if kind == "reference" else "measured"
        table["compensation"] = {"speed": speed, "law": deepcopy(law), "share": share}
        if kind == "inner_loop":
            table["compensation"]["lead"] = given.get("lead") or lag_of(scenario, controller)
    return Scenario(data, folder=scenario.folder, trust=True)


def level_of(scenario: Scenario, contact: str) -> float:
    """The largest steady friction of a contact up to v_s, N or N m, which a dither has to overcome."""
    law = scenario.elements.laws[f"contacts.{contact}.law"]
    return float(np.max(law.steady_force(law.scales(law.p).speed * _BELOW)))


def compare(
    loop: Loop, controller: str, samples: dict[str, Array], tell: Callable[[float, str], None] | None = None
) -> list[CompensationResult]:
    """Each remedy with its largest quiet share and the error that remains.

    Raises:
        InputError: if the measured body has no contact with the ground.
    """
    contact = contact_of(loop.scenario, controller)
    kinds = kinds_of(loop, controller, contact)
    results = list[CompensationResult]()
    without = replace(loop, scenario=with_compensation(loop.scenario, controller, contact, "none", 0.0))
    quiet_without = np.array([j.quiet for j in judge(without, samples, most_steps=MOST_STEPS)])
    for i, kind in enumerate(kinds):
        if tell is not None:
            tell(i / len(kinds), f"compensation: {KINDS[kind]}")
        compensated = replace(loop, scenario=with_compensation(loop.scenario, controller, contact, kind, 1.0))
        if kind == "none":
            remedy = _Remedy(compensated, samples, None, 1.0, quiet_without)
            results.append(_result(remedy, controller, kind, 0.0, 0.0 if quiet_without.all() else None))
        elif kind == "dither":
            results.append(_dithered(compensated, controller, samples, quiet_without))
        else:
            remedy = _Remedy(compensated, samples, f"controllers.{controller}.compensation.share", 1.0, quiet_without)
            largest = remedy.largest(_SHARES, _ROUNDS)
            results.append(_result(remedy, controller, kind, min(1.0, largest or 0.0), largest))
    return results


@dataclass
class _Remedy:
    """A loop with a remedy of variable share, and the samples of the friction with which it is quiet.

    Attributes:
        path: the number that sets the share; None if the remedy has none.
        unit: that number for a share of 1.
        without: for each sample, whether the loop is quiet without the remedy.
        most_steps: of the solver for one lane.
        worst: indices of the samples that limited the share so far; a search uses these, and all others check its result.
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
        """The values of the lanes: every share with every one of these samples."""
        values = {p: np.tile(x[which], len(shares)) for p, x in self.samples.items()}
        return values if self.path is None else values | {self.path: np.repeat(self.unit * shares, len(which))}

    def quiet(self, shares: Array, which: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Whether each share is quiet with each of these samples; shape (shares, samples)."""
        quiet = np.array([j.quiet for j in judge(self.loop, self.lanes(shares, which), most_steps=self.most_steps)])
        return quiet.reshape(len(shares), len(which))

    def errors(self, controller: str, shares: Array, which: NDArray[np.int64]) -> Array:
        """The largest error after reversals of each share, with the worst of these samples."""
        errors = reversal_errors(self.loop, controller, self.lanes(shares, which))
        return np.asarray(np.nanmax(errors.reshape(len(shares), len(which)), axis=1))

    def holds(self, share: float) -> bool:
        """Whether a share is quiet with every sample; the first samples that are not are added to the worst."""
        all_samples = np.arange(len(self.without))
        failing = np.flatnonzero(~(self.without if share == 0 else self.quiet(np.array([share]), all_samples)[0]))
        self.worst = np.unique(np.concatenate([self.worst, failing[:_FIRST]]))
        return not len(failing)

    def largest(self, shares: Array, rounds: int) -> float | None:
        """The largest share that is quiet with every sample, or None; searched with the worst samples, checked with all."""
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
    """The errors after reversals of a remedy at a share."""
    given = {} if remedy.path is None else {remedy.path: np.array([remedy.unit * share])}
    sine = on_a_sine(remedy.loop, controller, given)
    nominal = float(sine.errors["reversal"] or 0.0) if "failed_at" not in sine.errors else np.nan
    worst = float(remedy.errors(controller, np.array([share]), np.arange(len(remedy.without)))[0])
    table = remedy.loop.scenario.data["controllers"][controller].get("compensation")
    table = {**deepcopy(table), "share": share} if table else None
    return CompensationResult(kind, share, largest, nominal, worst, remedy.loop, sine, table=table)


def _dithered(
    compensated: Loop, controller: str, samples: dict[str, Array], quiet_without: NDArray[np.bool_]
) -> CompensationResult:
    """A dither at the quiet amplitude with the least worst error."""
    table = compensated.scenario.data["controllers"][controller]["dither"]
    level = float(table["amplitude"])
    remedy = _Remedy(
        compensated, samples, f"controllers.{controller}.dither.amplitude", level, quiet_without, _DITHERED
    )
    remedy.holds(0.0)
    worst = remedy.worst
    quiet = np.concatenate([[quiet_without.all()], remedy.quiet(_AMPLITUDES[1:], worst).all(axis=1)])
    while quiet.any():  # an amplitude that is quiet with the worst samples is checked with all
        last = int(np.flatnonzero(quiet)[-1])
        if remedy.holds(float(_AMPLITUDES[last])):
            break
        quiet[last] = False
    first = last = max((int(i) for i in np.flatnonzero(quiet)), default=0)
    while first and quiet[first - 1]:
        first -= 1
    shares = _AMPLITUDES[first : last + 1]
    share = float(shares[int(np.argmin(remedy.errors(controller, shares, worst)))])
    if not remedy.holds(share):
        share = float(_AMPLITUDES[last])
    result = _result(remedy, controller, "dither", share, float(_AMPLITUDES[last]) if quiet.any() else None)
    dither = {**table, "amplitude": share * level, "least_quiet_share": float(_AMPLITUDES[first])}
    return replace(result, dither=dither, table=None)
