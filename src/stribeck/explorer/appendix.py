"""Functions of the page's module beside the solver: columns, tolerances, the steady curve, and claims.

All are generated from the equations that the simulator, the proofs and the listings use.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import fields
from types import SimpleNamespace

from stribeck.codegen.emitted import Added
from stribeck.constants import Column
from stribeck.expressions.graph import Expr, symbol, wrap
from stribeck.expressions.ops import Value, where
from stribeck.laws.base import Claims, Law, Relation
from stribeck.laws.steady import steady_force
from stribeck.laws.values import Constants
from stribeck.machine.elements.contacts import Contact
from stribeck.machine.system import E_STORED, MachineSystem
from stribeck.scenario import Scenario
from stribeck.simulation.promise import RTOL_SMALLEST, share_of

CLAIMS = tuple(field.name for field in fields(Claims))
_NAN = float("nan")


def appendix(scenario: Scenario) -> dict[str, Added]:
    """The functions of a single body under a law: columns of a row, steady friction at a speed, tolerances, claims."""
    system = scenario.system
    (contact,) = system.contacts
    law, q = contact.friction.kind, contact.friction.p
    p = [f"{group}.{name}" for group, name in system.parameters]
    with_energy = system.with_energy()  # the page always shows the stored energy
    values = with_energy.outputs
    outputs = [wrap(values[column.name]) for column in columns(system)]
    inputs = {
        "p": p,
        "s": ["segment.start", "segment.value", "segment.slope"],
        "x": [state.name for state in system.states],
    }
    steady = wrap(steady_force(law, q, symbol("v"), symbol("side")))
    return {
        "system_columns": Added("p s t x out", "iidii", outputs, inputs),
        "system_steady": Added("p v side out", "iddi", [steady], {"p": p}),
        "system_setup": Added("p rtol out", "idi", _setup(scenario), {"p": p}),
        "system_claims": Added("p out", "ii", _claims(law, q), {"p": p}),
        "system_relations": Added("p out", "ii", _relations(law, q), {"p": p}),
    }


def machine_appendix(machine: MachineSystem) -> dict[str, Added]:
    """The functions of a machine: its columns, and the conditions between the constants of each contact's law."""
    p = [f"{owner}.{name}" for owner, name in machine.parameters]
    states = [*(state.name for state in machine.states), *(f"segment.{name}" for name in machine.held)]
    states += [f"memory.{name}" for name in machine.shown]
    values = machine.outputs
    held = [_holds(relation, contact.friction.p) for contact, relation in machine_relations(machine)]
    inputs = {"p": p, "s": [f"segment.{name}" for name in machine.piece_fields], "x": states}
    return {
        "system_columns": Added("p s t x out", "iidii", [values[c.name] for c in machine.columns], inputs),
        "system_relations": Added("p out", "ii", held, {"p": p}),
    }


def machine_relations(machine: MachineSystem) -> list[tuple[Contact, Relation]]:
    """The conditions between constants that the page tests for each contact, in the order of the module's."""
    return [(contact, each) for contact in machine.contacts for each in relations(contact.friction.kind)]


def columns(system: MachineSystem) -> tuple[Column, ...]:
    """The columns of the page: those of the output, and the stored energy."""
    return system.columns if system.energy else (*system.columns, E_STORED)


def relations(law: type[Law]) -> list[Relation]:
    """The conditions between a law's constants that the page tests, in the order of the module's."""
    return [each for each in dict.fromkeys(law.relations) if all(n in law.constants() for n in each.needs)]


def _setup(scenario: Scenario) -> list[Expr]:
    """The absolute tolerance of each state, the share of the tolerances for one step, and the longest step (s)."""
    system, rtol = scenario.system, symbol("rtol")
    machine = scenario.elements.with_values(
        {(path, name): symbol(f"{path}.{name}") for path, name in system.parameters}
    )
    share = share_of(machine.damping())
    least = RTOL_SMALLEST / rtol
    share = wrap(where(share > where(least < 1, least, 1.0), share, where(least < 1, least, 1.0)))
    atol: Mapping[str, Expr | float]
    try:
        atol = scenario.atol(machine, rtol)
    except TypeError:  # a user's law whose scales are no equations: they stay those of the file
        atol = {n: x / scenario.solve.rtol * rtol for n, x in scenario.atol().items()}
    ((use, signal),) = scenario.elements.signals.items()
    longest: Value = signal.longest_step
    if use.kind:
        constants: dict[str, Value] = {name: symbol(f"{use.path}.{name}") for name in use.constants()}
        longest = use.kind(constants).longest_step
    values = [*(share * atol[state.name] for state in system.states), share, longest]
    return [wrap(x) for x in values]


def _claims(law: type[Law], q: Constants) -> list[Expr]:
    """Each claim at the present numbers: 1, 0, or nan if the property does not apply."""
    values = []
    for name in CLAIMS:
        claim = getattr(law.claims, name)
        value = claim(q) if callable(claim) else claim
        if isinstance(value, Expr):
            value = where(value, wrap(1), wrap(0))
        values.append(wrap(_NAN if value is None else value))
    return values


def _relations(law: type[Law], q: Constants) -> list[Expr]:
    return [_holds(relation, q) for relation in relations(law)]


def _holds(relation: Relation, law: SimpleNamespace) -> Expr:
    holds: Value = True
    with suppress(TypeError):  # a user's condition that is no equation: the page cannot test it
        holds = relation.holds(law)
    return wrap(where(holds, wrap(1), wrap(0)) if isinstance(holds, Expr) else 1.0)
