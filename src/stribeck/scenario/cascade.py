"""What the cascade has in a scenario: its observer, what it knows of the plant, what it measures and when."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from types import EllipsisType, SimpleNamespace
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np
from pydantic import Field

from stribeck import laws
from stribeck.arrays import Array
from stribeck.constants import kind_of, show
from stribeck.control.cascade import SAMPLING, SWING, SWINGS, PressureCascade, course
from stribeck.control.cylinder import Cylinder
from stribeck.control.observer import Adaptation
from stribeck.control.sampled import Sampled
from stribeck.errors import InputError, NotDifferentiable
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import symbol, wrap
from stribeck.kinds import in_a_file
from stribeck.laws.base import PARAMETERS, BristleLaw, Law
from stribeck.laws.form import USUAL
from stribeck.machine.driving import DrivePart
from stribeck.machine.table import joined
from stribeck.scenario import tables
from stribeck.scenario.tables import Problem
from stribeck.signals import Signal

if TYPE_CHECKING:
    from stribeck.scenario import Scenario

NONE = "none"  # the observer's name where friction is not compensated
_MOST_INSTANTS = 1e7  # of a sampled controller: some minutes
_SAMPLES = 4001  # of the path, where it is judged
_MOST_SWINGS = 25  # turns of the valve in a quarter of a run that need no word


class Courses(Protocol):
    """What a remark is made of: the rows of a solution."""

    @property
    def t(self) -> Array:
        """The times, s."""

    @property
    def held(self) -> Mapping[str, Array]:
        """What controllers held at these times."""

    def __getitem__(self, name: str, /) -> Array:
        """A column."""


def cascade_of(scenario: Scenario) -> CascadeSettings | None:
    """What the cascade of a file of schema 1 is made of; None under another drive."""
    return scenario.rig.settings.get("")


def gains_of(scenario: Scenario) -> dict[str, float]:
    """The gains of that cascade."""
    return {name: x for (path, name), x in scenario.values().items() if path == "drive"}


@cache
def cascade_table() -> type[tables.StrictTable]:
    """The model of the table of a cascade; its signal is a table of its own."""
    kind = PressureCascade
    fields: tables.Fields = {"kind": (Literal["cascade"], Field(description=kind.meaning))}
    fields |= {name: tables.number(constant) for name, constant in kind.constants.items()}
    fields |= CascadeSettings.fields()
    fields["signal"] = (dict[str, object], Field(description=f"{kind.signal.meaning}, {kind.signal.unit}"))
    return tables.made("CascadeDrive", fields, kind.meaning)


@dataclass(frozen=True)
class Places:
    """Where the tables of a servo stand in the machine, and where that of the cascade stands in the file."""

    drive: str
    plant: str
    shown: str


@dataclass(frozen=True)
class CascadeSettings:
    """What the controller is made of, with its values."""

    model: dict[str, float]  # the plant, as the controller takes it to be
    adaptation: dict[str, float] | None
    sampling: dict[str, float] | None  # period, delay, resolution, noise, bandwidth and seed; None: continuous
    observer: Law | None = None

    @classmethod
    def fields(cls) -> tables.Fields:
        """Observer, model, adaptation and sampling."""
        known, adapted = (
            "plant constants that the controller takes for true",
            "gains of the adaptation, with adaptive = true",
        )
        noise = "standard deviation of the measured position, m"
        return {
            "sample_time": (float | None, Field(None, gt=0, description="the controller computes every so many s; off: always")),
            "delay": (float, Field(0.0, ge=0, description="time from measuring to acting, s")),
            "noise": (float, Field(0.0, ge=0, description=noise)),
            "quantisation": (float, Field(0.0, ge=0, description="step of the measured position, m")),
            "bandwidth": (
                float | None, Field(None, gt=0, description="of the filter that estimates velocity and acceleration, rad/s")
            ),
            "seed": (int, Field(0, ge=0, le=2**32 - 1, description="of the noise: the same seed gives the same noise")),
            "adaptive": (bool, Field(False, description="adapt sigma_0, sigma_1, sigma_2 and the level F_c on line")),
            "adaptation": tables.given_table("Adaptation", adapted, Adaptation.constants, False),
            "model": tables.given_table("Model", known, Cylinder.constants, True),
            "observer": (
                dict[str, object],
                Field(description="the law that the controller takes for true: name ('none' for no compensation), its own "
                      "constants, and parameters where they differ from the plant's"),
            ),
        }  # fmt: skip

    @classmethod
    def read(
        cls, values: tables.StrictTable | None, table: Mapping[str, object], law: Law | None,
        plant: object, folder: Path, executes: bool, at: Places,
    ) -> tuple[CascadeSettings | None, list[Problem]]:  # fmt: skip
        """The observer with the plant's parameters where it gives none, and the rest of [drive]."""
        observer, found, known = None, list[Problem](), True
        if isinstance(own := table.get("observer"), dict):
            known = executes or not in_a_file(own.get("name"))
            observer, found = read_observer(own, law, folder, at) if known else (None, [])
        own_values = None if values is None else dict(values)
        if own_values is not None:
            found += misplaced(own_values, observer if known and not found else ..., at)
        if found or own_values is None or plant is None:
            return None, found
        given = {n: x for n in Cylinder.constants if (x := getattr(own_values["model"], n)) is not None}
        model = {**{n: getattr(plant, n) for n in Cylinder.constants}, **given}
        sampling = None
        if own_values["sample_time"] is not None:
            sampling = {
                "period": own_values["sample_time"], "resolution": own_values["quantisation"],
                "bandwidth": own_values["bandwidth"] or 0.0, **{n: own_values[n] for n in ("delay", "noise", "seed")},
            }  # fmt: skip
        return cls(model, dict(own_values["adaptation"]) if own_values["adaptive"] else None, sampling, observer), []

    @property
    def law_name(self) -> str:
        """The name of the observer's law."""
        return self.observer.name if self.observer else NONE

    def drive(self, given: Collection[str]) -> PressureCascade:
        """The controller's structure."""
        law, form = (type(self.observer), self.observer.form) if self.observer else (None, USUAL)
        return PressureCascade(law, form, "supply_droop" in given, self.adaptation is not None, self._sampled)

    @property
    def _sampled(self) -> Sampled | None:
        if self.sampling is None:
            return None
        given = self.sampling
        tracks = given["bandwidth"] > 0  # without it the motion is measured as it is
        return Sampled(tracks and given["resolution"] > 0, tracks and given["noise"] > 0, tracks)

    def values(self) -> dict[tuple[str, str], float]:
        """The constants of the plant as it is known, of the observer and of its adaptation."""
        found = {("model", n): x for n, x in self.model.items()}
        found |= {("adaptation", n): x for n, x in (self.adaptation or {}).items()}
        own = self.observer.values if self.observer else {}
        found |= {("observer", n): x for n, x in own.items() if x is not None}
        sampled = self._sampled.numbers if self._sampled else {}
        return found | {(SAMPLING, n): x for n, x in (self.sampling or {}).items() if n in sampled}

    def judge(self, law: Law, signal: Signal, plant: Mapping[str, float], t_end: float, at: Places) -> list[Problem]:
        """What is wrong with the time between samples, and with the path."""
        found: list[Problem] = []
        period = self.sampling["period"] if self.sampling is not None else t_end
        if period < t_end / _MOST_INSTANTS:
            text = f"must be at least solve.t_end/{_MOST_INSTANTS:g} ({t_end / _MOST_INSTANTS:g} s)"
            found.append((f"{at.drive}.sample_time", f"{show(period)}: {text}"))
        return found + _path_problems(SimpleNamespace(**plant), law, signal, t_end, at)

    def sampling_of(self) -> list[dict[str, float]]:
        """Period, delay, noise and seed, where it samples."""
        return [] if self.sampling is None else [{n: self.sampling[n] for n in ("period", "delay", "noise", "seed")}]

    def remarks(self, scenario: Scenario, solution: Courses, drive: DrivePart) -> list[str]:
        """Where the valve is at its limit to the end, or goes to and fro."""
        found = _limited(scenario, solution, drive)
        return found + (_swinging(scenario, solution, drive) if self.sampling is not None else [])


def read_observer(
    table: dict[str, object], plant: Law | None, folder: Path, at: Places
) -> tuple[Law | None, list[Problem]]:
    """The law of [drive.observer] with the plant's parameters where it gives none, and what is wrong with it."""
    path = f"{at.drive}.observer"
    name = table.get("name")
    if "name" not in table:
        return None, [(f"{path}.name", f"missing: must be given (the name of a smooth law, or {NONE!r})")]
    if name == NONE:
        extra = [(f"{path}.{key}", f"{show(x)}: must be left out: no law") for key, x in table.items() if key != "name"]
        return None, extra
    try:
        cls = laws.find(name, folder)
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
    wrong = [
        (f"{path}.{n}", f"{show(own[n])}: belongs in {at.shown}.observer.parameters") for n in own if n in PARAMETERS
    ]
    places = {n: f"{path}.parameters.{n}" for n in (*PARAMETERS, *given)}
    wrong += [(places.get(n, f"{path}.{n}"), text) for n, text in cls.problems(values)]
    if wrong:
        return None, wrong
    law = cls(values)
    if ".py:" in str(name) and (trouble := laws.trouble(law)):
        return None, [(f"{path}.name", f"{show(name)}: {trouble}")]
    return (law, []) if (text := _useless(law)) is None else (None, [(f"{path}.name", f"{show(name)}: {text}")])


def _parameters(given: object, cls: type[Law], folder: Path) -> Mapping[str, object]:
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
    linear = law.has_z and law.linear
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


def _path_problems(p: SimpleNamespace, law: Law, signal: Signal, t_end: float, place: Places) -> list[Problem]:
    """Where the path cannot be followed, whatever the gains."""
    room = p.supply_pressure - p.atmospheric_pressure
    if room <= 0:
        return []  # which the plant says
    if not signal.smooth:
        text = f"{show(signal.kind)}: has no three derivatives, which the controller needs"
        return [(f"{place.drive}.signal.kind", f"{text}; must be one of sine, point_to_point, spline")]
    t, (y, v, a, _) = path_of(signal, t_end)
    outside = np.flatnonzero((y < 0) | (y > p.stroke))
    if outside.size:
        i = int(outside[0])
        where = f"the path reaches y = {y[i]:.6g} m at t = {t[i]:.4g} s"
        return [(f"{place.drive}.signal", f"{where}: must stay within the stroke, 0 to {p.stroke:g} m")]
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
        return [(f"{place.plant}.supply_pressure", text)]
    return []


def path_of(signal: Signal, t_end: float) -> tuple[Array, tuple[Array, ...]]:
    """The path and its three derivatives, at times close enough to see every wave and at every point."""
    waves = t_end / signal.longest_step if np.isfinite(signal.longest_step) else 0.0
    t = np.linspace(0, t_end, int(min(max(_SAMPLES, 16 * waves), 200_000)))
    t = np.union1d(t, [start for start, _ in signal.pieces if 0 <= start <= t_end])
    values = signal.values_at(t)
    kind: object = type(signal)
    found = _course(kind, tuple(values))(t, *values.values())
    return t, tuple(np.broadcast_to(np.asarray(x, float), t.shape) for x in found)


@lru_cache(maxsize=32)
def _course(signal: object, names: tuple[str, ...]) -> Callable[..., tuple[Array, ...]]:
    """The path and its derivatives as a function of t and the signal's constants."""
    assert isinstance(signal, type)
    assert issubclass(signal, Signal)
    constants = SimpleNamespace(**{n: symbol(f"signal.{n}") for n in names})
    path = course(wrap(signal.equation(constants, symbol("t"))), symbol("t"))
    return python_function(("t", *(f"signal.{n}" for n in names)), path)


def misplaced(values: Mapping[str, object], observer: Law | EllipsisType | None, at: Places) -> list[Problem]:
    """What the valid table [drive] asks for that does not go together; ``observer`` is ... where it is not known."""
    found, path = list[Problem](), at.drive
    if values["sample_time"] is None:
        text = f"needs {at.shown}.sample_time: without it the controller is continuous and measures exactly"
        keys = [key for key in ("delay", "noise", "quantisation", "bandwidth") if values[key]]
        found += [(f"{path}.{key}", f"{show(values[key])}: {text}") for key in keys]
    elif (values["noise"] or values["quantisation"]) and values["bandwidth"] is None:
        text = "missing: must be given with noise or quantisation (rad/s; of the filter that estimates v and dv/dt)"
        found.append((f"{path}.bandwidth", text))
    if values["adaptive"] and observer is not ... and (reason := not_adaptable(observer)):
        found.append((f"{path}.adaptive", f"true: {reason}"))
    return found


def _swinging(scenario: Scenario, solution: Courses, drive: DrivePart) -> list[str]:
    """That the valve goes to and fro to the end far more often than the path."""
    end, swing = scenario.end, SWING * scenario.values()[drive.path, "u_max"]
    late = solution.held[joined(drive.name, SWINGS, "_")][solution.t >= 0.75 * end]
    swings = int(late[-1] - late[0]) if len(late) else 0
    waves = 0.25 * end / (8 * scenario.rig.signals[drive.signal].longest_step)
    if swings <= max(_MOST_SWINGS, 6 * waves):
        return []
    text = f"the valve goes to and fro {swings} times by more than {swing:g} V in the last quarter of the run"
    return [f"{scenario.name}: {text}: sample_time, delay or noise are too large for these gains"]


def _limited(scenario: Scenario, solution: Courses, drive: DrivePart) -> list[str]:
    """That the valve ends at its limit, when it has been there for a tenth of the run."""
    limit = scenario.values()[drive.path, "u_max"]
    free = np.flatnonzero(np.abs(solution[joined(drive.name, "u")]) < limit * (1 - 1e-9))
    first = free[-1] + 1 if len(free) else 0
    if len(solution.t) - first <= 0.1 * len(solution.t):
        return []
    since = f"from t = {solution.t[first]:.4g} s to the end"
    return [f"{scenario.name}: the valve is at its limit of {limit:g} V {since}: it cannot do what is asked of it"]
