"""What the page asks of a law and a system beside the solver, as C behind the solver's own: columns, tolerances, curve.

All of it is written out from the equations that the simulator, the proofs and the listings use.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from types import SimpleNamespace

from stribeck.drives.base import Column
from stribeck.expressions.emit import C, Writer
from stribeck.expressions.graph import Expr, symbol, wrap
from stribeck.expressions.ops import Value, where
from stribeck.laws.base import Claims, Law, Relation
from stribeck.laws.evaluation import steady_force
from stribeck.laws.values import Constants
from stribeck.machine.parts import ContactPart, symbols_of
from stribeck.machine.system import MachineSystem
from stribeck.scenario import Scenario
from stribeck.simulation.native import share_of

CLAIMS = tuple(field.name for field in fields(Claims))
_NAN = float("nan")

_STEADY = """\
/* Friction when each speed is held for long. */
EXPORT void stribeck_steady(const double *p, int64_t n, const double *v, double *F)
{
    for (int64_t i = 0; i < n; i++) F[i] = law_steady(p, v[i], v[i] > 0 ? 1 : -1);
}"""

_TABLE = """\
/* Every column of the output, row by row. */
EXPORT void stribeck_table(const double *p, int64_t rows, double step, int64_t pieces, const double *start,
                           const double *piece_rows, const double *states, double *out)
{
    int64_t n = 0;
    for (int64_t i = 0; i < rows; i++) {
        const double t = (double)i * step;
        while (n + 1 < pieces && start[n + 1] <= t * (1 + 1e-12)) n++; /* signals/pieces.py */
        columns(p, piece_rows + n * PIECE, t, states + i * (N + HELD + SHOWN), out + i * COLUMNS);
    }
}"""


def appendix(scenario: Scenario) -> str:
    """The functions, to stand behind the C of the scenario's system."""
    system = scenario.system
    (contact,) = system.contacts
    law, q = contact.law, contact.law.symbolic(symbols_of(contact.law_path), contact.form)
    inputs = {f"{group}.{name}": f"p[{i}]" for i, (group, name) in enumerate(system.parameters)}
    piece = {f"segment.{n}": f"s[{i}]" for i, n in enumerate(("start", "value", "slope"))}
    states = {state.name: f"x[{i}]" for i, state in enumerate(system.states)}
    v, side = symbol("v"), symbol("side")
    moving = {"v": "v", "side": "side"}
    whole = replace(system, energy=True)  # the page shows the energy stored, whether the file asks for it or not
    found = whole.outputs
    p = "const double *p"
    now = f"{p}, const double *s, double t, const double *x, double *out"
    outputs = {f"out[{i}]": wrap(found[column.name]) for i, column in enumerate(columns(system))}
    return "\n\n".join(
        [
            "/* ---- What the page shows beside the states. */",
            f"#define COLUMNS {len(columns(system))}",
            _function("columns", now, outputs, {**inputs, **piece, **states, "t": "t"}),
            _value("law_steady", f"{p}, double v, double side", steady_force(law, q, v, side), inputs | moving),
            _TABLE,
            _STEADY,
            _function("setup", f"{p}, double rtol, double *out", _setup(scenario), {**inputs, "rtol": "rtol"}, True),
            _function("claims", f"{p}, double *out", _claims(law, q), inputs, True),
            _function("relations", f"{p}, double *out", _relations(law, q), inputs, True),
        ]
    )


def machine_appendix(machine: MachineSystem) -> str:
    """The same for a machine: its columns, and the conditions between the constants of each contact's law."""
    inputs = {f"{owner}.{name}": f"p[{i}]" for i, (owner, name) in enumerate(machine.parameters)}
    piece = {f"segment.{name}": f"s[{i}]" for i, name in enumerate(machine.piece_fields)}
    names = [*(state.name for state in machine.states), *(f"segment.{name}" for name in machine.held)]
    names += [f"memory.{name}" for name in machine.shown]
    states = {name: f"x[{i}]" for i, name in enumerate(names)}
    found = machine.balance(exact=True).outputs()
    outputs = {f"out[{i}]": found[column.name] for i, column in enumerate(machine.columns)}
    held = {}
    for i, (contact, relation) in enumerate(machine_relations(machine)):
        law = contact.law.symbolic(symbols_of(contact.law_path), contact.form)
        held[f"out[{i}]"] = _holds(relation, law)
    now = "const double *p, const double *s, double t, const double *x, double *out"
    return "\n\n".join(
        [
            f"/* ---- What the page shows beside the states. */\n#define COLUMNS {len(outputs)}",
            _function("columns", now, outputs, {**inputs, **piece, **states, "t": "t"}),
            _TABLE,
            _function("relations", "const double *p, double *out", held, inputs, True),
        ]
    )


def machine_relations(machine: MachineSystem) -> list[tuple[ContactPart, Relation]]:
    """The conditions between constants that the page tests of each contact, in the order of the C."""
    return [(contact, each) for contact in machine.contacts for each in relations(contact.law)]


def columns(system: MachineSystem) -> tuple[Column, ...]:
    """The columns that the page takes: those of the output, and the energy stored."""
    stored = next(c for c in replace(system, energy=True).columns if c.name == "E_stored")
    return system.columns if system.energy else (*system.columns, stored)


def relations(law: type[Law]) -> list[Relation]:
    """The conditions between constants that the page tests, in the order of the C."""
    return [each for each in dict.fromkeys(law.relations) if all(n in law.constants() for n in each.needs)]


def _setup(scenario: Scenario) -> dict[str, Expr]:
    """The absolute tolerance of each state, the step's share of the tolerances, the longest step."""
    system, rtol = scenario.system, symbol("rtol")
    rig = scenario.rig.with_values({(path, name): symbol(f"{path}.{name}") for path, name in system.parameters})
    share = share_of(rig.damping())
    least = 1e-13 / rtol  # simulation/native.py: below it rounding is the larger error
    share = wrap(where(share > where(least < 1, least, 1.0), share, where(least < 1, least, 1.0)))
    draft = object.__new__(Scenario)
    draft.__dict__.update({**scenario.__dict__, "solve": SimpleNamespace(rtol=rtol, atol=scenario.solve.atol)})
    atol: Mapping[str, Expr | float]
    try:
        atol = draft.atol(rig)
    except TypeError:  # a law of the user's whose scales are no equations: they stay those of the file
        atol = {n: x / scenario.solve.rtol * rtol for n, x in scenario.atol().items()}
    longest: Value = scenario.signal.longest_step
    (use,) = system.signals
    if use.kind:
        own: dict[str, Value] = {name: symbol(f"{use.path}.{name}") for name in use.constants()}
        longest = use.kind(own).longest_step
    values = [*(share * atol[state.name] for state in system.states), share, longest]
    return {f"out[{i}]": wrap(x) for i, x in enumerate(values)}


def _claims(law: type[Law], q: Constants) -> dict[str, Expr]:
    """Each claim at the present numbers: 1, 0, or not a number where the property does not apply."""
    found = {}
    for i, name in enumerate(CLAIMS):
        claim = getattr(law.claims, name)
        value = claim(q) if callable(claim) else claim
        if isinstance(value, Expr):
            value = where(value, wrap(1), wrap(0))
        found[f"out[{i}]"] = wrap(_NAN if value is None else value)
    return found


def _relations(law: type[Law], q: Constants) -> dict[str, Expr]:
    return {f"out[{i}]": _holds(relation, q) for i, relation in enumerate(relations(law))}


def _holds(relation: Relation, law: SimpleNamespace) -> Expr:
    holds: Value = True
    with suppress(TypeError):  # a user's own, which is no equation: the page cannot test it
        holds = relation.holds(law)
    return wrap(where(holds, wrap(1), wrap(0)) if isinstance(holds, Expr) else 1.0)


def _value(name: str, arguments: str, value: Expr, inputs: dict[str, str]) -> str:
    return _write(name, arguments, [("const double value", value)], inputs, "static double", "    return value;\n")


def _function(name: str, arguments: str, outputs: dict[str, Expr], inputs: dict[str, str], public: bool = False) -> str:
    kind = "EXPORT void" if public else "static void"
    return _write(f"stribeck_{name}" if public else name, arguments, list(outputs.items()), inputs, kind, "")


def _write(
    name: str, arguments: str, outputs: Sequence[tuple[str, Expr]], inputs: dict[str, str], kind: str, end: str
) -> str:
    lines = Writer(C, inputs, taken={"p", "v", "s", "x", "t", "out", "value", "side", "rtol"}).write(outputs)
    unused = "".join(f"    (void){part.replace('*', ' ').split()[-1]};\n" for part in arguments.split(","))
    return f"{kind} {name}({arguments})\n{{\n{unused}{''.join(f'    {line}' + chr(10) for line in lines)}{end}}}"
