"""The library: every friction law, parameter set and machine, each with its source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING

from stribeck import laws, parameter_sets
from stribeck.constants import kind_of, show
from stribeck.errors import InputError, error_text, nearest, note
from stribeck.kinds import of_a_file
from stribeck.laws import sanity
from stribeck.laws.base import Claims, Law
from stribeck.laws.form import USUAL, Form
from stribeck.laws.render import Equation, condition, equations
from stribeck.parameter_sets import ParameterSet
from stribeck.parameter_sets.library import MachineSet, machine_sets

if TYPE_CHECKING:
    from stribeck.mouth.document import Document

_OF_FILES = ("name", "units", "words")  # fields of a set that repeat its key, or that only files have


@dataclass(frozen=True)
class Library:
    """Laws, parameter sets and machines by name.

    Attributes:
        laws: the laws' classes; ``stribeck.law(name, ...)`` makes one with its constants.
        sets: the laws' parameters as published: ``values``, ``title``, ``source``, ``motion``.
        machines: whole machines, published or fitted: ``machine`` (tables of schema 2), ``source``, ``license``, ``record``.
    """

    laws: Mapping[str, type[Law]]
    sets: Mapping[str, ParameterSet]
    machines: Mapping[str, MachineSet]

    def to_dict(self) -> dict[str, object]:
        """The JSON of ``stribeck library --json``: equations, constants and sources of all entries.

        Raises:
            InputError: a law of a user's file has equations that cannot be evaluated.
        """
        return {
            "laws": [described(law, name) for name, law in self.laws.items()],
            "parameter_sets": {
                name: {k: v for k, v in asdict(s).items() if k not in _OF_FILES} for name, s in self.sets.items()
            },
            "machines": {name: m.to_dict() for name, m in self.machines.items()},
        }

    def document(self) -> Document:
        """All entries, a line each."""
        from stribeck.laws import said

        return said.shelf(self)

    def documents(self) -> list[Document]:
        """Documents with all details of each law, set and machine, in this order.

        Raises:
            InputError: a law of a user's file has equations that cannot be evaluated.
        """
        from stribeck.laws import said

        return [
            *(said.law(described(law, name)) for name, law in self.laws.items()),
            *(said.parameter_set(each) for each in self.sets.values()),
            *(said.machine(each) for each in self.machines.values()),
        ]


def library(*names: str) -> Library:
    """List the laws, parameter sets and machines that come with Stribeck, with their sources.

    Args:
        names: only these; ``FILE.py:NAME`` is a law of your own. Everything unless given.

    Raises:
        InputError: if a name is unknown, or a law's file does not load.
    """
    if wrong := [name for name in names if not isinstance(name, str)]:
        raise InputError([f"{show(name)}: must be a name, not {kind_of(name)}" for name in wrong])
    sets, machines = parameter_sets.parameters(), dict(machine_sets())
    if not names:
        return Library(dict(laws.builtin()), sets, machines)
    from_files = {name: laws.find(name) for name in names if ".py:" in name}
    known = [*laws.builtin(), *sets, *machines]
    for name in names:
        if name not in known and name not in from_files:
            guess = nearest(name, known) or " ('stribeck library' lists what there is)"
            raise InputError(f"{name!r}: no such law, parameter set or machine{guess}")
    return Library(
        {name: law for name, law in {**laws.builtin(), **from_files}.items() if name in names},
        {name: each for name, each in sets.items() if name in names},
        {name: machine for name, machine in machines.items() if name in names},
    )


def described(law: type[Law], name: str) -> dict[str, object]:
    """A law's equations, constants, source and guarantees, as JSON.

    Args:
        law: the law's class.
        name: its name in the request.

    Raises:
        InputError: the equations of a law from a user's file cannot be evaluated.
    """
    own_file = of_a_file(law)
    try:
        result, problem = _describe(law), _problem(law) if own_file else None
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        if not own_file:
            raise
        raise InputError(f"{name!r}: its equations cannot be evaluated: {error_text(error)}") from error
    if problem:
        raise InputError(f"{name!r}: {problem}")
    return result


def _problem(law: type[Law]) -> str | None:
    """The reason why the equations cannot be evaluated with allowed constants, or None; None too if none are known."""
    values = {n: v for n, v in parameter_sets.load("canudas1995").values.items() if n in law.constants()}
    values |= {n: c.example for n, c in law.own_constants().items() if c.example is not None and n not in values}
    values |= {n: 1.0 for n, c in law.constants().items() if c.required and n not in values and not c.problem(1.0)}
    if law.problems(values):
        return None
    example = law(values)
    if (problem := laws.trouble(example)) is None:
        for line in sanity.problems(example):
            note(f"{law.name}: {line}")
    return problem


def _describe(law: type[Law]) -> dict[str, object]:
    constants = {
        name: {
            "unit": c.unit or "1", "rotary_unit": c.rotary_unit, "meaning": c.meaning, "allowed": c.allowed,
            "required": c.required, "default": c.choices[0] if c.choices else c.default,
            "where": "law.parameters" if name in law.uses else "law",
        }
        for name, c in law.constants().items()
    }  # fmt: skip
    return {
        "name": law.name,
        "summary": " ".join((law.__doc__ or "").split()),
        "equations": _equations(law),
        "parameters": constants,
        "source": law.source,
        "has_z": law.has_z,
        "guarantees": _guarantees(law),
        "with": {form.words[0]: _changed(law, form) for form in law.forms() if len(form.words) == 1},
    }


def _equations(law: type[Law], form: Form = USUAL) -> list[dict[str, str]]:
    return [asdict(e) for e in equations(law, form)]


def _guarantees(law: type[Law], form: Form = USUAL) -> dict[str, object]:
    claims = {field.name: getattr(law.claims, field.name) for field in fields(Claims)}
    conditions = {n: condition(c, law, form) if callable(c) else c for n, c in claims.items()}
    return {n: {"if": asdict(c)} if isinstance(c, Equation) else c for n, c in conditions.items()}


def _changed(law: type[Law], form: Form) -> dict[str, object]:
    """The equations and guarantees of this form of the law that differ from the usual form."""
    usual, claims = _equations(law), _guarantees(law)
    return {
        "equations": [e for e in _equations(law, form) if e not in usual],
        "guarantees": {n: c for n, c in _guarantees(law, form).items() if c != claims[n]},
    }
