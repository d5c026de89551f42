"""The part of a scenario that only a servo has: its observer, what its controller knows, measures and when."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.constants import kind_of, show
from stribeck.control.observer import SCALES
from stribeck.control.sampled import Sampling
from stribeck.control.servo_system import ServoSystem, compiled
from stribeck.errors import InputError, NotDifferentiable
from stribeck.laws.base import PARAMETERS, BristleLaw, Law
from stribeck.laws.form import USUAL
from stribeck.plants.cylinder import Cylinder
from stribeck.signals import Signal

Problem = tuple[str, str]

NONE = "none"  # the observer's name where friction is not compensated
_MOST_INSTANTS = 1e7  # of a sampled controller: some minutes
_SAMPLES = 4001  # of the path, where it is judged


@dataclass(frozen=True)
class Servo:
    """What the controller of a pneumatic servo is made of, with its values."""

    observer: Law | None
    plant: dict[str, float]
    model: dict[str, float]
    adaptation: dict[str, float] | None
    sampling: Sampling | None

    def system(self, law: Law, signal: type[Signal], droop: bool) -> ServoSystem:
        """The structure of the equations."""
        kind, form = (type(self.observer), self.observer.form) if self.observer else (None, USUAL)
        return ServoSystem(
            type(law),
            law.form,
            kind,
            form,
            signal,
            droop,
            self.adaptation is not None,
            self.sampling is not None,
        )

    def values(self) -> dict[tuple[str, str], float]:
        """The run-time constants that a single body does not have."""
        found = {("plant", n): x for n, x in self.plant.items()} | {("model", n): x for n, x in self.model.items()}
        found |= {("adaptation", n): x for n, x in (self.adaptation or {}).items()}
        own = self.observer.values if self.observer else {}
        found |= {("observer", n): x for n, x in own.items() if x is not None}
        return found | ({("drive", "u"): 0.0} if self.sampling else {})


def read_observer(table: dict[str, Any], plant: Law | None, folder: Path) -> tuple[Law | None, list[Problem]]:
    """The law of [drive.observer] with the plant's parameters where it gives none, and what is wrong with it."""
    path = "drive.observer"
    name = table.get("name")
    if "name" not in table:
        return None, [(f"{path}.name", f"missing: must be given (the name of a smooth law, or {NONE!r})")]
    if name == NONE:
        extra = [(f"{path}.{key}", f"{show(x)}: must be left out: no law") for key, x in table.items() if key != "name"]
        return None, extra
    try:
        cls = laws.find(name, folder)  # type: ignore[arg-type]
        given = _parameters(table.get("parameters", {}), cls, folder)
    except InputError as error:
        where = "name" if not isinstance(table.get("parameters"), str) else "parameters"
        return None, [(f"{path}.{where}", text) for text in error.problems]
    own = {key: x for key, x in table.items() if key not in ("name", "parameters")}
    has = cls.constants()
    inherited = {n: x for n, x in ({**plant.machine, **plant.values} if plant else {}).items() if n in PARAMETERS}
    values = {**{n: x for n, x in inherited.items() if x is not None}, **given, **own}
    if plant is None:  # what it would have given cannot be told missing
        values = {**{n: 1.0 for n in PARAMETERS if n in has and n not in values}, **values}
    wrong = [(f"{path}.{n}", f"{show(own[n])}: belongs in {path}.parameters") for n in own if n in PARAMETERS]
    places = {n: f"{path}.parameters.{n}" for n in (*PARAMETERS, *given)}
    wrong += [(places.get(n, f"{path}.{n}"), text) for n, text in cls.problems(values)]
    if wrong:
        return None, wrong
    law = cls(values)
    if ".py:" in str(name) and (trouble := laws.trouble(law)):
        return None, [(f"{path}.name", f"{show(name)}: {trouble}")]
    return (law, []) if (text := _useless(law)) is None else (None, [(f"{path}.name", f"{show(name)}: {text}")])


def _parameters(given: Any, cls: type[Law], folder: Path) -> dict[str, Any]:
    if isinstance(given, str):
        return laws.parameters_for(cls, given, folder)
    if not isinstance(given, dict):
        raise InputError(f"{show(given)}: must be a table of numbers or the name of a set, not {kind_of(given)}")
    return dict(given)


def _useless(law: Law) -> str | None:
    """Why a law cannot be an observer, or None: the controller needs dF/dt, also at v = 0, and sigma_0."""
    try:
        scales = law.scales(law.p)
        law.force_rate(0.0, scales.length * np.array([-0.5, 0.0, 0.5]) if law.has_z else 0.0, scales.speed)
    except NotDifferentiable as error:
        return f"cannot be an observer, which needs dF/dt: {error}"
    if law.has_z and "sigma_0" not in law.constants():
        return "cannot be an observer: it has z, but no sigma_0 to weigh the tracking error by"
    return None


def not_linear(law: Law | None) -> str | None:
    """Why an observer is not of the kind that the Lyapunov function is for, or None."""
    if law is None:
        return "there is no observer"
    linear = law.has_z and law._graph().linear
    if not (linear and type(law).friction is BristleLaw.friction):
        return f"of law '{law.name}' dz/dt must be linear in z, and F = sigma_0 z + sigma_1 dz/dt + sigma_2 v"
    return None


def not_adaptable(law: Law | None) -> str | None:
    """Why an observer cannot be adapted, or None."""
    reason = not_linear(law)
    if reason is None and law is not None:
        if law.values.get("v_d") is not None:
            reason = f"v_d = {law.values['v_d']:g}: sigma_1 must be constant"
        elif zero := [name for name in ("sigma_0", "sigma_1", "sigma_2") if not law.values[name]]:
            reason = f"{zero[0]} = 0: its scale is adapted, so it must be > 0"
    return f"cannot adapt the observer: {reason}" if reason else None


def judge(servo: Servo, law: Law, signal: Signal, t_end: float, initial: Mapping[str, float]) -> list[Problem]:
    """What is wrong with valid tables taken together: the path and the pressures."""
    p = SimpleNamespace(**servo.plant)
    found: list[Problem] = []
    for name, highest in (("y", p.stroke), ("p_1", np.inf), ("p_2", np.inf)):
        if not 0 <= initial[name] <= highest:
            allowed = f"within the stroke, 0 to {p.stroke:g} m" if name == "y" else "an absolute pressure >= 0 Pa"
            found.append((f"plant.initial.{name}", f"{show(initial[name])}: must be {allowed}"))
    if servo.sampling is not None and servo.sampling.time < t_end / _MOST_INSTANTS:
        text = f"must be at least solve.t_end/{_MOST_INSTANTS:g} ({t_end / _MOST_INSTANTS:g} s)"
        found.append(("drive.sample_time", f"{show(servo.sampling.time)}: {text}"))
    room = p.supply_pressure - p.atmospheric_pressure
    if room <= 0:
        text = f"{show(p.supply_pressure)}: must be above plant.atmospheric_pressure ({p.atmospheric_pressure:g} Pa)"
        return [*found, ("plant.supply_pressure", text)]
    if not signal.smooth:
        text = f"{show(signal.kind)}: has no three derivatives, which the controller needs"
        return [*found, ("drive.signal.kind", f"{text}; must be one of sine, point_to_point, spline")]
    t, (y, v, a, _) = path_of(servo, law, signal, t_end)
    outside = np.flatnonzero((y < 0) | (y > p.stroke))
    if outside.size:
        i = int(outside[0])
        where = f"the path reaches y = {y[i]:.6g} m at t = {t[i]:.4g} s"
        return [*found, ("drive.signal", f"{where}: must stay within the stroke, 0 to {p.stroke:g} m")]
    friction = law.steady_force(v)
    if "F_s" in law.machine:  # lugre_arctan's steady force grows without limit as v -> 0, which no motion waits for
        most = law.machine["F_s"] + law.machine.get("sigma_2", 0.0) * abs(v)
        friction = np.clip(friction, -most, most)
    needed = abs(p.mass * a + friction) / p.area
    i = int(np.argmax(needed))
    if needed[i] > room:
        text = (
            f"{show(p.supply_pressure)}: the path needs a pressure difference of {needed[i]:.4g} Pa at t = {t[i]:.4g} s"
        )
        text += f", and {room:.4g} Pa above the atmosphere are all there is; must be higher, or the path slower"
        found.append(("plant.supply_pressure", text))
    return found


def path_of(servo: Servo, law: Law, signal: Signal, t_end: float) -> tuple[Array, tuple[Array, ...]]:
    """The path and its three derivatives, at times close enough to see every wave and at every point."""
    waves = t_end / signal.longest_step if np.isfinite(signal.longest_step) else 0.0
    t = np.linspace(0, t_end, int(min(max(_SAMPLES, 16 * waves), 200_000)))
    t = np.union1d(t, [start for start, _ in signal.pieces if 0 <= start <= t_end])
    system, values = servo.system(law, type(signal), False), signal.values_at(t)
    names = ("t", *(f"signal.{n}" for n in values))
    found = compiled(system, names, "path")(t, *values.values())
    return t, tuple(np.broadcast_to(np.asarray(x, float), t.shape) for x in found)


def misplaced(values: Any, observer: Any) -> list[Problem]:
    """What the valid table [drive] asks for that does not go together; ``observer`` is ... where it is not known."""
    found: list[Problem] = []
    if values.sample_time is None:
        text = "needs drive.sample_time: without it the controller is continuous and measures exactly"
        keys = [key for key in ("delay", "noise", "quantisation", "bandwidth") if getattr(values, key)]
        found += [(f"drive.{key}", f"{show(getattr(values, key))}: {text}") for key in keys]
    elif (values.noise or values.quantisation) and values.bandwidth is None:
        text = "missing: must be given with noise or quantisation (rad/s; of the filter that estimates v and dv/dt)"
        found.append(("drive.bandwidth", text))
    if values.adaptive and observer is not ... and (reason := not_adaptable(observer)):
        found.append(("drive.adaptive", f"true: {reason}"))
    return found


def assembled(observer: Law | None, plant: Any, values: Any) -> Servo:
    """The servo of validated tables."""
    own = {name: getattr(plant, name) for name in Cylinder.constants}
    known = {name: x for name in own if (x := getattr(values.model, name)) is not None}
    sampling = None
    if values.sample_time is not None:
        sampling = Sampling(
            values.sample_time, values.delay, values.noise, values.quantisation, values.bandwidth, values.seed
        )
    adaptation = dict(values.adaptation) if values.adaptive else None
    return Servo(observer, own, {**own, **known}, adaptation, sampling)


def atol_scales(servo: Servo, law: Law) -> dict[str, float]:
    """Natural magnitudes of the states that a single body does not have, for the default tolerances."""
    scales = law.scales(law.p)
    pressure = scales.force / servo.plant["area"]
    return {"p_1": pressure, "p_2": pressure, "z_hat": scales.length, "eta": scales.length} | dict.fromkeys(
        (scale.name for scale in SCALES), 1.0
    )
