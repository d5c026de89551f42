"""What a friction law is: its constants, its equations, what it claims, and all that follows from the equations.

A law is a class with one or two short functions written like the literature prints them::

    class MyLaw(BristleLaw):
        '''One line that says what it is.'''

        source = "Who, where, which equation"
        claims = Claims(unique=True, bounded=True, smooth=False, passive=False, drift_free=False)
        k_v = Constant("s/m", "steepness of the smooth sign", above=0)

        @staticmethod
        def dz_dt(p, v, z):
            return v - abs(v) / g(p, v) * z

``p`` holds the constants by name; ``v`` and ``z`` are numbers, arrays, graph nodes or SymPy symbols.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import cache
from itertools import product
from types import SimpleNamespace
from typing import Any, ClassVar

from stribeck.constants import Constant, show
from stribeck.errors import InputError, nearest
from stribeck.expressions.ops import Value
from stribeck.kinds import FromFile
from stribeck.laws import terms
from stribeck.laws.evaluation import Evaluation
from stribeck.laws.form import USUAL, Form
from stribeck.laws.objects import AsObject
from stribeck.laws.values import Constants, OnTerm
from stribeck.laws.values import Scales as Scales

# Parameters of a machine: they belong to the contact, whichever law describes it.
PARAMETERS: dict[str, Constant] = {
    "sigma_0": Constant("N/m", "bristle stiffness", above=0, rotary_unit="N m/rad"),
    "sigma_1": Constant("N s/m", "bristle damping", at_least=0, rotary_unit="N m s/rad"),
    "sigma_2": Constant("N s/m", "viscous friction", at_least=0, rotary_unit="N m s/rad"),
    "F_c": Constant("N", "Coulomb friction force", above=0, rotary_unit="N m"),
    "F_s": Constant("N", "static friction force", above=0, rotary_unit="N m"),
    "v_s": Constant("m/s", "Stribeck velocity", above=0, rotary_unit="rad/s"),
}

Claim = bool | Callable[[SimpleNamespace], Value] | None


@dataclass(frozen=True)
class Relation:
    """A condition between constants: the one to blame, what is allowed in words, and the test."""

    key: str
    allowed: str
    holds: Callable[[SimpleNamespace], bool]
    needs: tuple[str, ...]


@dataclass(frozen=True)
class Claims:
    """What a law claims to guarantee: True, False, or a condition on its constants; None where it does not apply.

    Where a condition is not met nothing is claimed; it may be sufficient only.

    unique: one solution z(t) for every piecewise continuous v(t). bounded: z stays within :meth:`Law.z_bound`
    whatever v(t). smooth: dz/dt is continuously differentiable in (v, z). passive: from v to F, with z within that
    bound (unrestricted where there is none). drift_free: dz/dt = v exactly for ``|z|`` <= :meth:`Law.z_elastic`.
    """

    unique: Claim = None
    bounded: Claim = None
    smooth: Claim = None
    passive: Claim = None
    drift_free: Claim = None


STATIC_ABOVE_COULOMB = (Relation("F_s", "at least F_c", lambda p: p.F_s >= p.F_c, ("F_c", "F_s")),)


_TAKEN = {  # what the equations and the files call so; a constant of that name would be taken for it
    "v": "the velocity", "z": "the bristle deflection", "t": "the time", "y": "the position", "F": "the friction force",
    "u": "the driving force", "dz_dt": "the bristles' rate", "parameters": "the machine's parameters",
}  # fmt: skip


@cache
def _taken_names() -> dict[str, str]:
    """Names that a constant cannot have, and what they are: variables, and what every law is made of."""
    own = {n: "it is a part of every law" for n in dir(Law) if not isinstance(getattr(Law, n), Constant)}
    return own | dict.fromkeys((*dir(Constants), "machine", "p"), "it is a part of every law") | _TAKEN


def _value(constant: Constant, given: Any) -> float | str | None:
    if constant.choices:
        return given or constant.choices[0]
    return float(given) if given is not None else constant.default


def _may_be_none(constant: Constant) -> bool:
    return constant.optional or bool(constant.choices)


class Law(AsObject, Evaluation, metaclass=FromFile):
    """A friction law with its constants' values; the base of :class:`BristleLaw` and :class:`StaticLaw`.

    Args:
        values: the constants by name, SI units.
        rotary: of a machine that turns: N m in the place of N, rad in that of m; the numbers are the same.

    Raises:
        InputError: a constant is unknown, missing, of the wrong type, not finite or unphysical; every problem found.
    """

    name: ClassVar[str] = ""
    source: ClassVar[str] = "user"
    claims: ClassVar[Claims] = Claims()
    uses: ClassVar[tuple[str, ...]] = ()  # the machine parameters that the equations use
    relations: ClassVar[tuple[Relation, ...]] = ()
    has_z: ClassVar[bool] = True
    inputs: ClassVar[tuple[str, ...]] = ()  # constants that are given anew at each instant: loads of a contact
    beside: ClassVar[tuple[str, ...]] = ()  # the keys of a machine's file that the inputs stand for
    symmetric: ClassVar[bool] = True  # F and dz/dt change sign with (v, z)

    def __init__(self, values: Mapping[str, Any], rotary: bool = False) -> None:
        if found := self.problems(values):
            raise InputError([f"{path}: {text}" for path, text in found])
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

    # -- equations: the part that a law writes ---------------------------------------------------------------------

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
        """Every constant of the law by name: the machine's parameters first, then its own, what may be left out last."""
        names = dict.fromkeys(name for base in reversed(cls.__mro__) for name in vars(base))
        own = {name: value for name in names if isinstance(value := getattr(cls, name), Constant)}
        last = sorted(own, key=lambda name: _may_be_none(own[name]))
        return {**{name: PARAMETERS[name] for name in cls.uses}, **{name: own[name] for name in last}}

    @classmethod
    def own_constants(cls) -> dict[str, Constant]:
        """The constants that belong to the law and not to the machine: k_v, z_ba, ..."""
        return {name: constant for name, constant in cls.constants().items() if name not in PARAMETERS}

    @classmethod
    def problems(cls, values: Mapping[str, Any]) -> list[tuple[str, str]]:
        """What is wrong with the values: (name, message) for each problem; an empty list when all is well.

        Parameters of a machine that the law does not use are allowed, and checked.
        """
        declared = cls.constants()
        known = {**PARAMETERS, **declared}
        found = []
        for name, value in values.items():
            if name not in known:
                has = ", ".join(cls.own_constants()) or "none of its own"
                guess = nearest(name, known) or f" (it has {has})"
                found.append((name, f"{show(value)}: law '{cls.name}' has no such constant{guess}"))
            elif not (value is None and _may_be_none(known[name])) and (text := known[name].problem(value)):
                found.append((name, f"{show(value)}: {text}"))
        for name, constant in declared.items():
            if constant.required and name not in values:
                unit = f" in {constant.unit}" if constant.unit else ""
                found.append(
                    (name, f"missing: law '{cls.name}' needs it ({constant.meaning}, {constant.allowed}{unit})")
                )
        wrong = {name for name, _ in found}
        defaults = {n: c.default for n, c in declared.items() if c.default is not None}
        on = defaults | {n: x for n, x in values.items() if x is not None}
        return found + cls.broken({n: x for n, x in on.items() if n not in wrong})

    @classmethod
    def broken(cls, on: Mapping[str, float | str]) -> list[tuple[str, str]]:
        """The relations that do not hold, of those whose constants are all ``on`` and valid by themselves."""
        found = []
        for relation in dict.fromkeys((*cls.relations, *STATIC_ABOVE_COULOMB)):
            if all(need in on for need in relation.needs):
                given = {need: on[need] if isinstance(on[need], str) else float(on[need]) for need in relation.needs}
                if not relation.holds(SimpleNamespace(**given)):
                    others = ", ".join(f"{n} = {show(on[n])}" for n in relation.needs if n != relation.key)
                    text = f"must be {relation.allowed}{f' ({others})' if others else ''}"
                    found.append((relation.key, f"{show(on[relation.key])}: {text}"))
        return found

    @property
    def values(self) -> dict[str, float | None]:
        """The constants that are numbers, None where an optional one is off; ``p.numbers`` are those that are on."""
        return {name: x for name, x in vars(self.p).items() if not isinstance(x, str)}

    @property
    def choices(self) -> dict[str, str]:
        """The constants that are words."""
        return self.p.words

    @property
    def form(self) -> Form:
        """What of these constants changes the form of the equations."""
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
        """The constants that are numbers in that form of the equations: no choices, and no optional ones that are off."""
        return {n: c for n, c in cls.constants().items() if not c.choices and (not c.optional or n in form)}

    @classmethod
    def symbolic(cls, make: Callable[[str], Value], form: Form = USUAL, on_term: OnTerm | None = None) -> Constants:
        """The constants as symbols; optional ones that are off are None, choices are words."""
        words, made = dict(form.choices), dict[str, Value]()
        for name, constant in cls.constants().items():
            if constant.choices:
                made[name] = words.get(name, constant.choices[0])
            else:
                made[name] = None if constant.optional and name not in form else make(name)
        return Constants(made, on_term)

    def same_as(self, other: Law | None) -> bool:
        """Whether another law has the same equations, in the same form, and the same numbers."""
        return type(self) is type(other) and isinstance(other, Law) and self.p == other.p

    def guarantees(self) -> dict[str, bool | None]:
        """The claims evaluated for these values: True, False, or None where a property does not apply."""
        result: dict[str, bool | None] = {}
        for field in fields(Claims):
            claim = getattr(self.claims, field.name)
            result[field.name] = bool(claim(self.p)) if callable(claim) else claim
        return result


class BristleLaw(Law):
    """A law with one state, the mean deflection z of bristles: F = sigma_0 z + sigma_1 dz/dt + sigma_2 v.

    With the constant v_d the bristle damping sigma_1 falls with speed; delta is the exponent of the Stribeck curve.
    """

    v_d: ClassVar[Constant | None] = terms.V_D  # None in a law whose force is another
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
            InputError: of a law without sigma_0 that does not say its own.
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
        """v_s and F_s (or F_c) where the law has them, else 1 mm/s and 1 N; the distance gone in 10 ms."""
        speed, force = getattr(p, "v_s", 1e-3), getattr(p, "F_s", getattr(p, "F_c", 1.0))
        return Scales(1e-2 * speed, speed, force)

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        """There is no z: 0."""
        return 0.0 * v
