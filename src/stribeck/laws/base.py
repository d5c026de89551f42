"""The base of friction laws: constants, equations, claims, and all that is derived from the equations.

A law is a class with one or two short functions written like the literature prints them::

    class MyLaw(BristleLaw):
        '''One line that describes the law.'''

        source = "Who, where, which equation"
        claims = Claims(unique=True, bounded=True, smooth=False, passive=False, drift_free=False)
        k_v = Constant("s/m", "steepness of the smooth sign", above=0)

        @staticmethod
        def dz_dt(p, v, z):
            return v - abs(v) / g(p, v) * z

``p`` holds the constants by name; ``v`` and ``z`` are numbers, arrays, graph nodes or SymPy symbols.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import cache
from itertools import product
from types import SimpleNamespace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.constants import Constant, show
from stribeck.errors import InputError, NotDifferentiable, corrected, nearest
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import derivative, symbol, symbols, wrap
from stribeck.expressions.ops import Value
from stribeck.kinds import FromFile, of_a_file
from stribeck.laws import terms
from stribeck.laws.form import USUAL, Form
from stribeck.laws.steady import SLOWEST, steady_deflection, steady_force
from stribeck.laws.values import Constants, OnTerm
from stribeck.laws.values import Scales as Scales

# Parameters of a machine: they belong to the contact, whatever its law.
PARAMETERS: dict[str, Constant] = {
    "sigma_0": Constant("N/m", "bristle stiffness", above=0, rotary_unit="N m/rad"),
    "sigma_1": Constant("N s/m", "bristle damping", at_least=0, rotary_unit="N m s/rad"),
    "sigma_2": Constant("N s/m", "viscous friction", at_least=0, rotary_unit="N m s/rad"),
    "F_c": Constant("N", "Coulomb friction force", above=0, rotary_unit="N m"),
    "F_s": Constant("N", "static friction force", above=0, rotary_unit="N m"),
    "v_s": Constant("m/s", "Stribeck velocity", above=0, rotary_unit="rad/s"),
}

IN_MEMORY: dict[str, type[Law]] = {}  # laws that a program defined, by the name that their tables carry

Claim = bool | Callable[[SimpleNamespace], Value] | None


@dataclass(frozen=True)
class Relation:
    """A condition between constants: the constant at fault, the allowed values in words, and the test."""

    key: str
    allowed: str
    holds: Callable[[SimpleNamespace], bool]
    needs: tuple[str, ...]


@dataclass(frozen=True)
class Claims:
    """The claims of a law: True, False, a condition on its constants, or None if a property does not apply.

    A condition may be sufficient only. If it does not hold, nothing is claimed.

    Attributes:
        unique: one solution z(t) for every piecewise continuous v(t).
        bounded: z stays within :meth:`Law.z_bound` for every v(t).
        smooth: dz/dt is continuously differentiable in (v, z).
        passive: from v to F, with z within its bound, or any z if there is no bound.
        drift_free: dz/dt = v exactly for ``|z|`` <= :meth:`Law.z_elastic`.
    """

    unique: Claim = None
    bounded: Claim = None
    smooth: Claim = None
    passive: Claim = None
    drift_free: Claim = None


STATIC_ABOVE_COULOMB = (Relation("F_s", "at least F_c", lambda p: p.F_s >= p.F_c, ("F_c", "F_s")),)


_TAKEN = {  # names of the equations and files, which no constant may have
    "v": "the velocity", "z": "the bristle deflection", "t": "the time", "y": "the position", "F": "the friction force",
    "u": "the driving force", "dz_dt": "the bristles' rate", "parameters": "the machine's parameters",
}  # fmt: skip


@cache
def _constants(law: type[Law]) -> dict[str, Constant]:
    names = dict.fromkeys(name for base in reversed(law.__mro__) for name in vars(base))
    constants = {name: value for name in names if isinstance(value := getattr(law, name), Constant)}
    last = sorted(constants, key=lambda name: _may_be_none(constants[name]))
    return {**{name: PARAMETERS[name] for name in law.uses}, **{name: constants[name] for name in last}}


@cache
def _taken_names() -> dict[str, str]:
    """Names that a constant cannot have, and their meanings: variables, and attributes of every law."""
    attributes = {n: "it is a part of every law" for n in dir(Law) if not isinstance(getattr(Law, n), Constant)}
    return attributes | dict.fromkeys((*dir(Constants), "machine", "p"), "it is a part of every law") | _TAKEN


def _value(constant: Constant, given: Any) -> float | str | None:
    if constant.choices:
        return given or constant.choices[0]
    return float(given) if given is not None else constant.default


def _may_be_none(constant: Constant) -> bool:
    return constant.optional or bool(constant.choices)


def _shaped(value: Value, v: Value, z: Value) -> Array:
    """A value, which need not depend on both v and z, in their common shape."""
    shape = np.broadcast_shapes(np.shape(v), np.shape(z))
    return np.asarray(value if np.shape(value) == shape else np.full(shape, value))[()]


@dataclass(frozen=True)
class _Graph:
    """Functions made from the graph of a law's equations.

    Attributes:
        function: of the constants, v and z: F, and the derivatives of dz/dt and F by v and by z.
        steady: of the constants, v and its sign: the steady deflection and force.
        names: of the constants.
        linear: whether dz/dt is linear in z.
    """

    function: Callable[..., tuple[Value, ...]]
    steady: Callable[..., tuple[Value, ...]]
    names: tuple[str, ...]
    linear: bool


class Law(metaclass=FromFile):
    """A friction law with its constants' values; the base of :class:`BristleLaw` and :class:`StaticLaw`.

    Args:
        values: the constants by name, SI units.
        rotary: units N m and rad instead of N and m; the values are the same.

    Raises:
        InputError: a constant is unknown, missing, of the wrong type, not finite or unphysical; every problem found.
    """

    name: ClassVar[str] = ""
    source: ClassVar[str] = "user"
    claims: ClassVar[Claims] = Claims()
    uses: ClassVar[tuple[str, ...]] = ()  # the machine parameters that the equations use
    relations: ClassVar[tuple[Relation, ...]] = ()
    has_z: ClassVar[bool] = True
    inputs: ClassVar[tuple[str, ...]] = ()  # constants that vary in time: loads of a contact
    beside: ClassVar[tuple[str, ...]] = ()  # the keys of a machine's file that the inputs stand for
    symmetric: ClassVar[bool] = True  # F and dz/dt change sign with (v, z)
    p: Constants
    machine: dict[str, float]
    rotary: bool
    _graphs: ClassVar[dict[tuple[object, ...], _Graph]] = {}

    def __init__(self, values: Mapping[str, Any], rotary: bool = False) -> None:
        if problems := self.problems(values):
            raise InputError([f"{path}: {text}" for path, text in problems])
        declared = self.constants()
        self.p = Constants({name: _value(constant, values.get(name)) for name, constant in declared.items()})
        # parameters of the machine that this law does not use, such as v_s for the event threshold
        self.machine: dict[str, float] = {
            name: float(value) for name, value in values.items() if name in PARAMETERS and value is not None
        }
        self.rotary = rotary

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "name" not in cls.__dict__:
            cls.name = cls.__name__
        if taken := [n for n, value in vars(cls).items() if isinstance(value, Constant) and n in _taken_names()]:
            text = "this name is taken: a constant must have another"
            raise InputError([f"{cls.__name__}.{n}: {text} ({_taken_names()[n]})" for n in taken])

    # -- equations, which a law defines ------------------------------------------------------------------------------

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        """Rate of the bristle deflection, m/s."""
        raise NotImplementedError

    @staticmethod
    def friction(p: SimpleNamespace, v: Value, z: Value, dz_dt: Value) -> Value:
        """Friction force in N, positive when it opposes positive velocity."""
        raise NotImplementedError

    @staticmethod
    def stored_energy(p: SimpleNamespace, z: Value) -> Value:
        """Energy kept by the bristles, J."""
        return 0.0 * z

    @staticmethod
    def scales(p: SimpleNamespace) -> Scales:
        """Natural length (m), speed (m/s) and force (N) of the law."""
        raise NotImplementedError

    @staticmethod
    def z_bound(p: SimpleNamespace) -> Value:
        """Z of the claim ``bounded``, m."""
        raise NotImplementedError

    @staticmethod
    def z_elastic(p: SimpleNamespace) -> Value:
        """z_0 of the claim ``drift_free``, m."""
        raise NotImplementedError

    # -- declarations ----------------------------------------------------------------------------------------------

    @classmethod
    def constants(cls) -> dict[str, Constant]:
        """Every constant by name: the machine's parameters, the law's own, and optional constants last."""
        return dict(_constants(cls))

    @classmethod
    def own_constants(cls) -> dict[str, Constant]:
        """The constants that belong to the law and not to the machine: k_v, z_ba, ..."""
        return {name: constant for name, constant in cls.constants().items() if name not in PARAMETERS}

    @classmethod
    def problems(cls, values: Mapping[str, Any]) -> list[tuple[str, str]]:
        """Invalid values: (name, message) for each problem.

        Parameters of a machine that the law does not use are allowed, and checked too.
        """
        declared = cls.constants()
        known = {**PARAMETERS, **declared}
        problems = []
        for name, value in values.items():
            if name not in known:
                has = ", ".join(cls.own_constants()) or "none of its own"
                guess = nearest(name, known) or f" (it has {has})"
                problems.append((name, f"{show(value)}: law '{cls.name}' has no such constant{guess}"))
            elif not (value is None and _may_be_none(known[name])) and (text := known[name].problem(value)):
                problems.append((name, f"{show(value)}: {text}"))
        for name, constant in declared.items():
            if constant.required and name not in corrected(values, known):
                unit = f" in {constant.unit}" if constant.unit else ""
                problems.append(
                    (name, f"missing: law '{cls.name}' needs it ({constant.meaning}, {constant.allowed}{unit})")
                )
        wrong = {name for name, _ in problems}
        defaults = {n: c.default for n, c in declared.items() if c.default is not None}
        on = defaults | {n: x for n, x in values.items() if x is not None}
        return problems + cls.broken({n: x for n, x in on.items() if n not in wrong})

    @classmethod
    def broken(cls, on: Mapping[str, float | str]) -> list[tuple[str, str]]:
        """The violated relations among those whose constants are all in ``on`` and valid by themselves."""
        problems = []
        for relation in dict.fromkeys((*cls.relations, *STATIC_ABOVE_COULOMB)):
            if all(need in on for need in relation.needs):
                given = {need: on[need] if isinstance(on[need], str) else float(on[need]) for need in relation.needs}
                if not relation.holds(SimpleNamespace(**given)):
                    others = ", ".join(f"{n} = {show(on[n])}" for n in relation.needs if n != relation.key)
                    text = f"must be {relation.allowed}{f' ({others})' if others else ''}"
                    problems.append((relation.key, f"{show(on[relation.key])}: {text}"))
        return problems

    @property
    def values(self) -> dict[str, float | None]:
        """The numeric constants, None for an optional one that is off; ``p.numbers`` are those that are on."""
        return {name: x for name, x in vars(self.p).items() if not isinstance(x, str)}

    @property
    def choices(self) -> dict[str, str]:
        """The constants that are words."""
        return self.p.words

    @property
    def form(self) -> Form:
        """The form of the equations with these constants."""
        constants, p = self.constants(), vars(self.p)
        on = tuple(name for name, c in constants.items() if c.optional and p[name] is not None)
        return Form(on, tuple((n, p[n]) for n, c in constants.items() if c.choices and p[n] != c.choices[0]))

    @classmethod
    def forms(cls) -> list[Form]:
        """Every form that the equations can take; the usual one first."""
        each = [
            [(n, word) if i else None for i, word in enumerate(c.choices)] if c.choices else [None, n]
            for n, c in cls.constants().items()
            if c.choices or c.optional
        ]
        return [
            Form(tuple(x for x in one if isinstance(x, str)), tuple(x for x in one if isinstance(x, tuple)))
            for one in product(*each)
        ]

    @classmethod
    def numbers(cls, form: Form = USUAL) -> dict[str, Constant]:
        """The numeric constants in a form of the equations, without choices and optional ones that are off."""
        return {n: c for n, c in cls.constants().items() if not c.choices and (not c.optional or n in form)}

    @classmethod
    def symbolic(cls, make: Callable[[str], Value], form: Form = USUAL, on_term: OnTerm | None = None) -> Constants:
        """The constants as symbols; optional ones that are off are None, choices are words."""
        words, values = dict(form.choices), dict[str, Value]()
        for name, constant in cls.constants().items():
            if constant.choices:
                values[name] = words.get(name, constant.choices[0])
            else:
                values[name] = None if constant.optional and name not in form else make(name)
        return Constants(values, on_term)

    def same_as(self, other: Law | None) -> bool:
        """Whether another law has the same equations, form and constants."""
        return type(self) is type(other) and isinstance(other, Law) and self.p == other.p

    def guarantees(self) -> dict[str, bool | None]:
        """The claims evaluated for these values: True, False, or None where a property does not apply."""
        result: dict[str, bool | None] = {}
        for field in fields(Claims):
            claim = getattr(self.claims, field.name)
            result[field.name] = bool(claim(self.p)) if callable(claim) else claim
        return result

    # -- as an object of Python ------------------------------------------------------------------------------------

    @property
    def _numbers(self) -> dict[str, Value]:
        """Every constant that is on; first all of the machine's parameters, used or not."""
        return {**self.machine, **self.p.numbers, **self.p.words}

    def __setattr__(self, name: str, value: object) -> None:
        if "rotary" in vars(self):  # which is set last
            raise AttributeError(f"{name}: a law does not change; replace({name}=VALUE) makes another")
        object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        inside = "".join(f", {name}={x!r}" for name, x in self._numbers.items())
        return f"law({self.name!r}{inside}{', rotary=True' if self.rotary else ''})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Law):
            return NotImplemented
        same = type(self) is type(other) and self.rotary == other.rotary
        return same and self._numbers == other._numbers

    def __hash__(self) -> int:
        return hash((type(self), self.rotary, *vars(self.p).items()))

    def replace(self, **constants: float | str | None) -> Self:
        """The same law with other values of some constants: ``law.replace(F_s=2.0)``; None turns an optional one off.

        Raises:
            InputError: an unknown constant or a bad value; one line for each problem.
        """
        return type(self)({**self._numbers, **constants}, self.rotary)

    def of_motion(self, rotary: bool) -> Self:
        """The same law with the units of rotary or linear motion; the values are the same."""
        return self if self.rotary == rotary else type(self)(self._numbers, rotary)

    def to_dict(self) -> dict[str, object]:
        """The table ``[law]`` of a scenario, or ``[contacts.NAME.law]`` of a machine, with name, constants and choices.

        A law of a user's file is named ``FILE.py:NAME``. A law that a program defined is known to this process only.
        """
        kind = type(self)
        name = kind.name
        if of_a_file(kind):
            name = f"{inspect.getfile(kind)}:{kind.__name__}"
        elif not kind.__module__.startswith(f"{__package__}."):
            name = f"{kind.__module__}:{kind.__qualname__}"
            IN_MEMORY[name] = kind
        numbers = self.p.numbers
        constants = {n: x for n, x in numbers.items() if n not in PARAMETERS}
        machine = {n: x for n, x in numbers.items() if n in PARAMETERS} | self.machine
        return {"name": name, **constants, **self.p.words, **({"parameters": machine} if machine else {})}

    def _repr_html_(self) -> str:
        """For notebooks: the equations and the constants."""
        from html import escape

        from stribeck.laws.render import equations  # needs SymPy, for display only

        rows = equations(type(self), self.form)
        lines = "".join(f"<div style='margin-left:1.5em'><i>{escape(row.text)}</i></div>" for row in rows)
        declared = {name: c.of_motion(self.rotary) for name, c in self.constants().items()}
        cells = "".join(
            f"<tr><td>{escape(name)}</td><td>{x if isinstance(x, str) else f'{x:g}'}</td>"
            f"<td>{escape(declared[name].unit)}</td><td style='text-align:left'>{escape(declared[name].meaning)}</td></tr>"
            for name, x in self._numbers.items()
            if name in declared
        )
        return f"<b>{escape(self.name)}</b>{lines}<table>{cells}</table>"

    # -- derived from the equations ---------------------------------------------------------------------------------

    @property
    def jumps_at_rest(self) -> bool:
        """True where F is discontinuous at v = 0, so that a body cannot come to rest in a simulation."""
        above, below = self.force(1e-300, 0.0), self.force(-1e-300, 0.0)
        return bool(abs(above - below) > 1e-9 * self.scales(self.p).force)

    @property
    def differentiable(self) -> bool:
        """True if F has a time derivative wherever v has one.

        This is as the law claims. Without a claim it is tested at rest, with and without deflection.
        """
        smooth = self.guarantees()["smooth"]
        if smooth is not None:
            return smooth
        length = self.scales(self.p).length if self.has_z else 0.0
        try:
            self.force_rate(0.0, np.array([0.0, length, -length]), 1.0)
        except NotDifferentiable:
            return False
        return True

    @property
    def linear(self) -> bool:
        """True where dz/dt is linear in z."""
        return self._graph().linear

    # -- evaluation: NumPy -----------------------------------------------------------------------------------------

    def rate(self, v: ArrayLike, z: ArrayLike) -> Array:
        """dz/dt in m/s for velocities v (m/s) and deflections z (m); shapes broadcast."""
        v, z = np.asarray(v, float)[()], np.asarray(z, float)[()]
        return _shaped(self._in_floats(lambda p: self.dz_dt(p, v, z)), v, z)

    def force(self, v: ArrayLike, z: ArrayLike = 0.0) -> Array:
        """Friction force in N for velocities v (m/s) and deflections z (m); shapes broadcast."""
        v, z = np.asarray(v, float)[()], np.asarray(z, float)[()]
        return _shaped(self._in_floats(lambda p: self.friction(p, v, z, self.dz_dt(p, v, z))), v, z)

    def force_with(self, v: Array, z: Array, dz_dt: Array) -> Array:
        """Friction force in N for velocities v (m/s), deflections z (m) and rates dz/dt (m/s)."""
        return np.asarray(self._in_floats(lambda p: self.friction(p, v, z, dz_dt)))

    def _in_floats(self, equation: Callable[[Constants], Value]) -> Value:
        """An equation's value; inf or nan, as with NumPy, if a result leaves the range of floats."""
        with np.errstate(all="ignore"):
            try:
                return equation(self.p)
            except ArithmeticError:  # raised by Python's floats
                return equation(self.p.replaced({n: np.asarray(x, float)[()] for n, x in self.p.numbers.items()}))

    def jacobian(self, v: ArrayLike, z: ArrayLike = 0.0) -> tuple[Array, Array]:
        """The derivatives of dz/dt by v and by z (1/s), at velocities v and deflections z."""
        rate_v, rate_z = self._evaluate(np.asarray(v, float), np.asarray(z, float))[1:3]
        return rate_v, rate_z

    def force_rate(self, v: ArrayLike, z: ArrayLike, dv_dt: ArrayLike) -> Array:
        """dF/dt in N/s at velocities v (m/s), deflections z (m) and accelerations dv_dt (m/s^2); shapes broadcast.

        Raises:
            NotDifferentiable: F has no time derivative there: v = 0, and F or its two one-sided derivatives differ.
        """
        v, z, dv_dt = np.broadcast_arrays(np.asarray(v, float), np.asarray(z, float), np.asarray(dv_dt, float))
        value, _ = self._force_rate(v, z, dv_dt)
        at_rest = v == 0
        if at_rest.any():
            # the limits v -> 0+ and v -> 0-, which agree to rounding if the equations are smooth
            (above, force_above), (below, force_below) = (
                self._force_rate(np.where(at_rest, side, v), z, dv_dt) for side in (1e-300, -1e-300)
            )
            with np.errstate(all="ignore"):
                differs = ~(abs(above - below) <= 1e-9 * (abs(above) + abs(below)) + 1e-250)  # rounding at 1e-300 m/s
                # a jump of the force matters only if v passes through 0
                jumps = (abs(force_above - force_below) > 1e-9 * self.scales(self.p).force) & (dv_dt != 0)
            if (at_rest & (differs | jumps)).any():
                raise NotDifferentiable(
                    f"law '{self.name}' has no dF/dt at v = 0: its equation holds |v| or sgn(v), so the "
                    "derivatives from the two sides differ; use a smooth law such as lugre_sobczyk or lugre_majorant"
                )
            value = np.where(at_rest, above, value)
        return value[()]

    def steady_deflection(self, v: ArrayLike) -> Array:
        """The deflection z in m at which dz/dt = 0 at constant v (m/s); 0 at v = 0.

        It is the root that a bristle reaches from z = 0. Speeds below 1e-100 m/s are evaluated at that speed, as
        products of them would underflow.
        """
        return self._steady(v)[0]

    def steady_force(self, v: ArrayLike) -> Array:
        """The steady friction force in N at constant v (m/s).

        At v = 0 the force lies in a range; its middle, 0, is returned.
        """
        return self._steady(v)[1]

    def _steady(self, v: ArrayLike) -> tuple[Array, Array]:
        """The steady deflection and force; 0 at rest."""
        v = np.asarray(v, float)[()]
        moving = np.where(abs(v) < SLOWEST, SLOWEST * np.where(v < 0, -1.0, 1.0), v)[()] if self.has_z else v
        graph = self._graph()
        values = self._in_floats(lambda p: graph.steady(*(p.numbers[n] for n in graph.names), moving, np.sign(moving)))
        z, force = (np.where(v == 0, 0.0, np.broadcast_to(x, np.shape(v)))[()] for x in values)
        return z, force

    # -- derivatives, from the graph of the equations --------------------------------------------------------------

    def _graph(self) -> _Graph:
        key = (type(self), self.form)
        if key not in Law._graphs:
            p, v, z = self.symbolic(symbol, self.form), symbol("v"), symbol("z")
            rate = wrap(self.dz_dt(p, v, z)) if self.has_z else wrap(0)
            force = wrap(self.friction(p, v, z, rate))
            outputs = [force, *(derivative(of, by) for of in (rate, force) for by in (v, z))]
            names = tuple(p.numbers)
            function = python_function([*names, "v", "z"], outputs)
            side = symbol("side")
            z = steady_deflection(type(self), p, v, side) if self.has_z else wrap(0.0)
            steady = python_function([*names, "v", "side"], [z, steady_force(type(self), p, v, side)])
            Law._graphs[key] = _Graph(function, steady, names, linear="z" not in symbols([outputs[2]]))
        return Law._graphs[key]

    def _evaluate(self, v: Array, z: Array) -> list[Array]:
        """F and the derivatives of dz/dt and F by v and z."""
        graph = self._graph()
        v, z = np.broadcast_arrays(v, z)
        values = self._in_floats(lambda p: graph.function(*(p.numbers[n] for n in graph.names), v, z))
        return [np.broadcast_to(x, v.shape)[()] for x in values]

    def _force_rate(self, v: Array, z: Array, dv_dt: Array) -> tuple[Array, Array]:
        force, _, _, force_v, force_z = self._evaluate(v, z)
        rate = self.rate(v, z) if self.has_z else 0.0
        with np.errstate(all="ignore"):
            return np.asarray(force_v * dv_dt + force_z * rate), np.asarray(force)


class BristleLaw(Law):
    """A law with one state, the mean deflection z of bristles: F = sigma_0 z + sigma_1 dz/dt + sigma_2 v.

    With the constant v_d the bristle damping sigma_1 falls with speed; delta is the exponent of the Stribeck curve.
    """

    v_d: ClassVar[Constant | None] = terms.V_D  # None in a law with another force
    delta: ClassVar[Constant | None] = terms.DELTA  # None in a law without the Stribeck curve g
    uses: ClassVar[tuple[str, ...]] = ("sigma_0", "sigma_1", "sigma_2", "F_c", "F_s", "v_s")
    relations: ClassVar[tuple[Relation, ...]] = STATIC_ABOVE_COULOMB

    @staticmethod
    def friction(p: SimpleNamespace, v: Value, z: Value, dz_dt: Value) -> Value:
        """The paper's eq. 1."""
        sigma_1 = p.sigma_1 if p.v_d is None else terms.sigma_1(p, v)
        return p.sigma_0 * z + sigma_1 * dz_dt + p.sigma_2 * v

    @staticmethod
    def stored_energy(p: SimpleNamespace, z: Value) -> Value:
        """The bristles' elastic energy, J.

        Raises:
            InputError: the law has no sigma_0 and does not override this method.
        """
        if not hasattr(p, "sigma_0"):
            raise InputError("output.energy: true: must be false for a law without sigma_0 and stored_energy(p, z)")
        return p.sigma_0 * z**2 / 2

    @staticmethod
    def scales(p: SimpleNamespace) -> Scales:
        """F_s/sigma_0, v_s and F_s."""
        return Scales(p.F_s / p.sigma_0, p.v_s, p.F_s)

    @staticmethod
    def z_bound(p: SimpleNamespace) -> Value:
        """F_s/sigma_0."""
        return p.F_s / p.sigma_0


class StaticLaw(Law):
    """A law without internal state: the force is a function of the velocity."""

    has_z = False

    @staticmethod
    def scales(p: SimpleNamespace) -> Scales:
        """v_s and F_s (or F_c) if the law has them, or else 1 mm/s and 1 N; and the distance in 10 ms at this speed."""
        speed, force = getattr(p, "v_s", 1e-3), getattr(p, "F_s", getattr(p, "F_c", 1.0))
        return Scales(1e-2 * speed, speed, force)

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        """0, as there is no z."""
        return 0.0 * v
