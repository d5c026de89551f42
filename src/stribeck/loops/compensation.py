"""What may be done against friction, and how much of it: the largest share that stays quiet whatever the friction is
within its intervals, and the error that it leaves after a reversal."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.loops.judge import judge
from stribeck.loops.loop import Loop, controller_of, time_constant
from stribeck.loops.moves import reversal_errors
from stribeck.loops.shaken import frequency_for
from stribeck.scenario import Scenario

KINDS = ("none", "reference", "measured", "inner_loop", "dither")
_SHARES = np.array([0.25, 0.5, 0.75, 1.0, 1.25, 1.5])
_AMPLITUDES = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0])  # of a dither, in shares of the friction
_ROUNDS, _ROUNDS_OF_DITHER = 4, 2
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
        dither: its kind, amplitude and frequency, where it is one, and the least share from which on it is quiet.
        table: what stands under ``compensation`` of the controller at that share, where it is one.
    """

    kind: str
    share: float
    largest_quiet_share: float | None
    reversal_error: float
    worst_error: float
    loop: Loop
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
        span = contact.span
        if span.start == each.measures and span.end is None and rig.values.get((contact.path, "ratio"), 1.0) == 1:
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
    smooth = law.differentiable and (rig.signals[each.signal].smooth or rig.signals[each.signal].kind == "ramp")
    return [kind for kind in KINDS if kind != "inner_loop" or (smooth and lag_of(loop.scenario, controller) > 0)]


def lag_of(scenario: Scenario, controller: str) -> float:
    """How far the force lags what is asked for, s: the motor's current, the delay, and half a period that a sample is held."""
    rig = scenario.rig
    each = controller_of(scenario, controller)
    motor = next((m for m in rig.machine.motors if m.name == each.on), None)
    lag = rig.values[motor.path, "current_time"] if motor is not None and motor.has_inductance else 0.0
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
    loop: Loop, controller: str, samples: dict[str, Array], tell: Callable[[float], None] | None = None
) -> list[CompensationResult]:
    """Each kind with its largest quiet share and the error that it leaves.

    Raises:
        InputError: the measured body has no contact with the ground.
    """
    contact = contact_of(loop.scenario, controller)
    found = []
    kinds = kinds_of(loop, controller, contact)
    for i, kind in enumerate(kinds):
        if kind == "dither":
            found.append(_dithered(loop, controller, contact, samples))
            break  # the last
        made = replace(loop, scenario=with_compensation(loop.scenario, controller, contact, kind, 1.0))
        path = f"controllers.{controller}.compensation.share" if kind != "none" else None
        largest = _largest(made, path, samples)
        share = 0.0 if kind == "none" else min(1.0, largest or 0.0)
        given = {} if path is None else {path: share}
        count = len(next(iter(samples.values())))
        wide = {**samples, **{p: np.full(count, x) for p, x in given.items()}}
        own = float(reversal_errors(made, controller, {p: np.array([x]) for p, x in given.items()})[0])
        worst = float(np.nanmax(reversal_errors(made, controller, wide)))
        table = made.scenario.data["controllers"][controller].get("compensation")
        table = {**deepcopy(table), "share": share} if table else None
        found.append(CompensationResult(kind, share, largest, own, worst, made, table=table))
        if tell is not None:
            tell((i + 1) / len(kinds))
    return found


def _dithered(loop: Loop, controller: str, contact: str, samples: dict[str, Array]) -> CompensationResult:
    """The amplitudes that stay quiet, and of these the one that leaves the least worst error."""
    made = replace(loop, scenario=with_compensation(loop.scenario, controller, contact, "dither", 1.0))
    table, path = made.scenario.data["controllers"][controller]["dither"], f"controllers.{controller}.dither.amplitude"
    level, count = float(table["amplitude"]), len(next(iter(samples.values())))

    def lanes(shares: Array) -> dict[str, Array]:
        return {p: np.tile(x, len(shares)) for p, x in samples.items()} | {path: np.repeat(level * shares, count)}

    every = [j.quiet for j in judge(made, lanes(_AMPLITUDES))]
    quiet = [all(every[i : i + count]) for i in range(0, len(every), count)]
    last = max((i for i, each in enumerate(quiet) if each), default=0)
    first = last
    while first and quiet[first - 1]:
        first -= 1
    largest = float(_AMPLITUDES[last]) if any(quiet) else None
    if largest is not None and last + 1 < len(_AMPLITUDES):
        ends = largest, float(_AMPLITUDES[last + 1])
        largest = _bisected(made, lambda x: lanes(np.array([x])), *ends, _ROUNDS_OF_DITHER)
    shares = np.unique([*_AMPLITUDES[first : last + 1], largest or 0.0])
    errors = np.nanmax(reversal_errors(made, controller, lanes(shares)).reshape(len(shares), count), axis=1)
    share = float(shares[int(np.argmin(errors))])
    own = float(reversal_errors(made, controller, {path: np.array([share * level])})[0])
    given = {**table, "amplitude": share * level, "least_quiet_share": float(_AMPLITUDES[first])}
    return CompensationResult("dither", share, largest, own, float(errors.min()), made, given)


def _largest(loop: Loop, path: str | None, samples: dict[str, Array]) -> float | None:
    """The largest share that is quiet with every sample, by bisection between shares looked at."""
    if path is None:
        return 0.0 if _quiet(loop, samples) else None
    count = len(next(iter(samples.values())))
    wide = {p: np.tile(x, len(_SHARES)) for p, x in samples.items()} | {path: np.repeat(_SHARES, count)}
    quiet = np.array([j.quiet for j in judge(loop, wide)]).reshape(len(_SHARES), count).all(axis=1)
    if quiet.all():
        return float(_SHARES[-1])
    first = int(np.argmin(quiet))  # the first that is not
    low, high = (float(_SHARES[first - 1]) if first else 0.0), float(_SHARES[first])
    if not first and not _quiet(loop, samples | {path: np.zeros(count)}):
        return None
    return _bisected(loop, lambda x: samples | {path: np.full(count, x)}, low, high, _ROUNDS)


def _bisected(loop: Loop, lanes: Callable[[float], dict[str, Array]], low: float, high: float, rounds: int) -> float:
    """The largest share found quiet between one that is and one that is not."""
    for _ in range(rounds):
        middle = (low + high) / 2
        if _quiet(loop, lanes(middle)):
            low = middle
        else:
            high = middle
    return low


def _quiet(loop: Loop, values: dict[str, Array]) -> bool:
    return all(j.quiet for j in judge(loop, values))
