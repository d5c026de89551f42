"""Machines as Python objects: each makes the table that a file would hold, and the same validation judges it.

::

    rig = Machine(
        Body("rotor", inertia=3.1e-5), Body("arm", inertia=0.35),
        Link("gear", "rotor", "arm", ratio=0.01, stiffness=9e3, damping=2.0, gap=2e-4),
        Contact("mesh", "arm", law("lugre_majorant", parameters="canudas1995", k_v=1e6)),
        Controller.cascade("axis", on="rotor", signal=Step(1.0, at=0.1), K_p=30, K_v=0.05),
    )
    solution = simulate(rig, t_end=4.0, step=1e-3)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from stribeck.constants import kind_of
from stribeck.errors import InputError
from stribeck.laws.base import Law
from stribeck.scenario import Scenario
from stribeck.scenario.changes import SECTIONS, changed, plain_table

# -- signals ---------------------------------------------------------------------------------------------------------


class SignalTable(Mapping[str, object]):
    """A signal of time, as the table that a file holds; see docs/scenario.md."""

    def __init__(self, kind: str, **values: object) -> None:
        self._table = {"kind": kind, **{name: x for name, x in values.items() if x is not None}}

    def __getitem__(self, key: str) -> Any:
        return self._table[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._table)

    def __len__(self) -> int:
        return len(self._table)

    def __repr__(self) -> str:
        inside = ", ".join(f"{n}={x!r}" for n, x in self._table.items() if n != "kind")
        return f"{type(self).__name__}({inside})"


class Step(SignalTable):
    """0 before ``at`` (s), ``value`` from then on."""

    def __init__(self, value: float, at: float = 0.0) -> None:
        super().__init__("step", value=value, time=at)


class Ramp(SignalTable):
    """rate * t."""

    def __init__(self, rate: float) -> None:
        super().__init__("ramp", rate=rate)


class Sine(SignalTable):
    """offset + amplitude sin(2 pi frequency t + phase); frequency in Hz, phase in rad."""

    def __init__(self, amplitude: float, frequency: float, offset: float = 0.0, phase: float = 0.0) -> None:
        super().__init__("sine", amplitude=amplitude, frequency=frequency, offset=offset, phase=phase)


class Points(SignalTable):
    """Straight lines between points, constant outside; two equal times make a jump."""

    def __init__(self, t: ArrayLike, value: ArrayLike) -> None:
        super().__init__("points", t=t, value=value)


class PointToPoint(SignalTable):
    """Moves from point to point that begin and end without speed, acceleration and jerk."""

    def __init__(self, t: ArrayLike, value: ArrayLike) -> None:
        super().__init__("point_to_point", t=t, value=value)


class Spline(SignalTable):
    """A spline of order seven through points, at rest at the first and the last."""

    def __init__(self, t: ArrayLike, value: ArrayLike) -> None:
        super().__init__("spline", t=t, value=value)


class File(SignalTable):
    """Two columns of a CSV or Parquet file, read as points."""

    def __init__(self, path: str | Path, time: str, value: str) -> None:
        super().__init__("file", path=str(path), time=time, value=value)


# -- parts -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Part:
    """A part of a machine: the section of the file that it stands in, its name and its table."""

    section: str
    name: str
    table: Mapping[str, object]

    def __repr__(self) -> str:
        inside = "".join(f", {name.strip('_')}={x!r}" for name, x in self.table.items())
        return f"{type(self).__name__}({self.name!r}{inside})"


def _given(**values: object) -> dict[str, object]:
    return {name: x for name, x in values.items() if x is not None}


class Body(Part):
    """A body: ``mass`` (kg) moves straight, ``inertia`` (kg m^2) turns.

    Args:
        name: letters, digits and underscores.
        mass, inertia: one of them, unless the velocity is given.
        y, v: the state at t = 0.
        tied_to: the body to which it is tied rigidly; it then moves ``ratio`` times as far.
        ratio: see ``tied_to``.
        velocity: the signal of the velocity, where that is given.
    """

    def __init__(
        self, name: str, *, mass: float | None = None, inertia: float | None = None, y: float | None = None,
        v: float | None = None, tied_to: str | None = None, ratio: float | None = None,
        velocity: Mapping[str, object] | None = None,
    ) -> None:  # fmt: skip
        initial = _given(y=y, v=v) or None
        driven = None if velocity is None else {"signal": velocity}
        table = _given(mass=mass, inertia=inertia, initial=initial, tied_to=tied_to, ratio=ratio, velocity=driven)
        super().__init__("bodies", name, table)


class Link(Part):
    """A spring and damper between two bodies, along d = ratio y_start - y_end.

    Args:
        name: letters, digits and underscores.
        start: a body's name, or the signal of a far end.
        end: a body's name, or "ground".
        stiffness, damping, gap: on the side of ``end``; see docs/machines.md.
        ratio: see above.
        kind: ``FILE.py:NAME`` for a link of your own, with its constants as further arguments.
    """

    def __init__(
        self, name: str, start: str | Mapping[str, object], end: str = "ground", *, stiffness: float | None = None,
        damping: float | None = None, gap: float | None = None, ratio: float | None = None, kind: str | None = None,
        **own: object,
    ) -> None:  # fmt: skip
        begin = start if isinstance(start, str) else {"signal": start}
        numbers = _given(ratio=ratio, stiffness=stiffness, damping=damping, gap=gap, kind=kind)
        super().__init__("links", name, {"from": begin, "to": end, **numbers, **own})


class Contact(Part):
    """Friction between a body and another, or the ground.

    Args:
        name: letters, digits and underscores.
        start: a body's name.
        law: the friction law: a :class:`Law`, or its table.
        end: a body's name, or "ground".
        ratio: w = ratio v_start - v_end.
        loads: forces that raise the level, such as ``[{"force": "gear", "F_c": 0.06, "F_s": 0.09}]``.
        factors: what parameters are multiplied by, such as ``{"sigma_2": {"signal": Points(...)}}``.
    """

    def __init__(
        self, name: str, start: str, law: Law | Mapping[str, object], *, end: str = "ground", ratio: float | None = None,
        loads: Sequence[Mapping[str, object]] = (), factors: Mapping[str, object] | None = None,
    ) -> None:  # fmt: skip
        more = _given(ratio=ratio, loads=list(loads) or None, factors=factors)
        super().__init__("contacts", name, {"from": start, "to": end, "law": law, **more})


class Load(Part):
    """A force on a body from outside; ``Load.signal``, ``Load.pendulum`` and ``Load.ripple`` make the usual ones."""

    def __init__(self, name: str, on: str, kind: str, **values: object) -> None:
        super().__init__("loads", name, {"on": on, "kind": kind, **values})

    @classmethod
    def signal(cls, name: str, on: str, signal: Mapping[str, object]) -> Load:
        """The signal is the force, N or N m."""
        return cls(name, on, "signal", signal=signal)

    @classmethod
    def pendulum(cls, name: str, on: str, amplitude: float, phase: float = 0.0) -> Load:
        """-amplitude sin(y + phase)."""
        return cls(name, on, "pendulum", amplitude=amplitude, phase=phase)

    @classmethod
    def ripple(cls, name: str, on: str, amplitude: ArrayLike, waves: ArrayLike, phase: ArrayLike | None = None) -> Load:
        """Sum of amplitude sin(waves y + phase)."""
        return cls(name, on, "ripple", amplitude=amplitude, waves=waves, **_given(phase=phase))


class Motor(Part):
    """A DC motor on a body: ``K`` in N m/A, ``R`` in ohm, ``L`` in H, ``voltage`` the limit in V; ``signal`` is the voltage
    where no controller asks for a current."""

    def __init__(
        self, name: str, on: str, *, K: float, R: float, L: float | None = None, voltage: float | None = None,
        current_time: float | None = None, signal: Mapping[str, object] | None = None,
    ) -> None:  # fmt: skip
        more = _given(L=L, voltage=voltage, current_time=current_time, signal=signal)
        super().__init__("motors", name, {"on": on, "K": K, "R": R, **more})


class Controller(Part):
    """A controller on a motor or a body; ``Controller.pid`` and ``Controller.cascade`` make the usual ones.

    Further arguments are those of the file: measures, limit, feedforward, compensation, sampling, dither.
    """

    def __init__(self, name: str, kind: str, on: str, signal: Mapping[str, object], **values: object) -> None:
        super().__init__("controllers", name, {"kind": kind, "on": on, "signal": signal, **_given(**values)})

    @classmethod
    def pid(
        cls,
        name: str,
        *,
        on: str,
        signal: Mapping[str, object],
        K_p: float,
        K_i: float = 0.0,
        K_d: float = 0.0,
        **more: object,
    ) -> Controller:
        """u = -K_p (y - r) - K_i I - K_d v."""
        return cls(name, "pid", on, signal, K_p=K_p, K_i=K_i, K_d=K_d, **more)

    @classmethod
    def cascade(
        cls,
        name: str,
        *,
        on: str,
        signal: Mapping[str, object],
        K_p: float,
        K_v: float,
        T_i: float | None = None,
        **more: object,
    ) -> Controller:
        """v_r = K_p (r - y) + dr/dt, u = K_v (v_r - v) + (K_v/T_i) I."""
        return cls(name, "cascade", on, signal, K_p=K_p, K_v=K_v, T_i=T_i, **more)


# -- the whole -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class VariedMachine:
    """A machine and the values that its lanes have, for :func:`stribeck.simulate_ensemble`."""

    machine: Machine
    values: dict[str, ArrayLike]


class Machine:
    """A machine made of parts; it does not change.

    Args:
        *parts: bodies, links, contacts, loads, motors and controllers.
        name: what it is called.
        folder: where relative paths begin; the working directory unless given.

    Raises:
        InputError: whatever is wrong with the machine, one line for each problem: its path, the value and what is allowed.
    """

    def __init__(self, *parts: Part, name: str = "machine", folder: str | Path | None = None) -> None:
        sections: dict[str, dict[str, object]] = {}
        seen: dict[str, str] = {}
        for part in parts:
            if not isinstance(part, Part):
                raise InputError(f"machine: must be made of bodies, links, contacts and so on, not {kind_of(part)}")
            if part.name in seen:
                text = f"{part.name!r}: must be another name: it is that of {seen[part.name]}.{part.name} already"
                raise InputError(f"{part.section}.{part.name}: {text}")
            seen[part.name] = part.section
            sections.setdefault(part.section, {})[part.name] = dict(part.table)
        self._set(
            plain_table({"schema": 2, "name": name, **sections}), parts, Path(folder) if folder is not None else Path()
        )

    _data: dict[str, object]
    _parts: tuple[Part, ...]
    _folder: Path

    def _set(self, data: dict[str, object], parts: tuple[Part, ...], folder: Path) -> None:
        try:
            Scenario({**data, "solve": {"t_end": 1e-3}, "output": {"step": 1e-3}}, folder=folder)
        except InputError as error:
            own = [text for text in error.problems if not text.startswith(("solve", "output"))]
            if own:
                raise InputError(own) from None
        self.__dict__.update(_data=data, _parts=parts, _folder=folder)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: a Machine does not change; replace({{PATH: VALUE}}) makes another")

    @property
    def name(self) -> str:
        """What it is called."""
        return str(self._data["name"])

    def to_dict(self) -> dict[str, object]:
        """The tables of a machine file, without [solve] and [output]."""
        return plain_table(self._data)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Machine) and self._data == other._data

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        sections = (f"{s} {', '.join(t)}" for s, t in self._data.items() if s in SECTIONS and isinstance(t, dict))
        return f"<Machine {self.name}: {'; '.join(sections)}>"

    def replace(self, changes: Mapping[str, object]) -> Machine:
        """The same machine with other values at some paths: ``{"bodies.arm.inertia": 0.4}``; a path of two words with a table
        adds an element.

        Raises:
            InputError: a path leads into an element that the machine does not have, or what comes out is no valid machine.
        """
        new = object.__new__(Machine)
        new._set(changed(self._data, changes, self._folder), self._parts, self._folder)
        return new

    def vary(self, values: Mapping[str, ArrayLike]) -> VariedMachine:
        """The machine with values for each lane of an ensemble.

        Raises:
            InputError: a path leads into an element that the machine does not have.
        """
        changed(self._data, values, self._folder)
        return VariedMachine(self, dict(values))

    def scenario(self, t_end: float, step: float | None = None, *, energy: bool = False, **solve: object) -> Scenario:
        """What is simulated: until ``t_end`` (s), with a row every ``step`` (s; t_end/1000 unless given).

        Further arguments are those of [solve], such as ``rtol``.

        Raises:
            InputError: whatever is wrong with the machine; one line for each problem.
        """
        output = {"step": t_end / 1000 if step is None else step, "energy": energy}
        return Scenario({**self._data, "solve": {"t_end": t_end, **solve}, "output": output}, folder=self._folder)

    def show(self) -> str:
        """The machine as text, as 'stribeck run --show' prints it."""
        import importlib

        rig = self.scenario(1.0).rig
        return str(importlib.import_module("stribeck.report.schematic").text(rig, self.name))

    def _repr_svg_(self) -> str:
        import importlib

        rig = self.scenario(1.0).rig
        return str(importlib.import_module("stribeck.report.schematic").svg(rig, self.name))


def scenario_of(
    given: Machine | Scenario | str | Path | Mapping[str, object], t_end: float | None, step: float | None, **solve: Any
) -> Scenario:
    """The scenario that ``simulate`` is given, with other times if these are given.

    Raises:
        InputError: it is no valid scenario, or a machine without ``t_end``.
    """
    if isinstance(given, Machine):
        if t_end is None:
            raise InputError("t_end: missing: must be given for a Machine (the end of the simulation, s)")
        return given.scenario(t_end, step, **solve)
    scenario = Scenario.of(given)
    times = {"solve.t_end": t_end, "output.step": step, **{f"solve.{name}": x for name, x in solve.items()}}
    changes = {path: x for path, x in times.items() if x is not None}
    return scenario.with_changes(changes) if changes else scenario
