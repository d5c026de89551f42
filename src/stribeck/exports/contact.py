"""The friction of a contact, its loads and factors included, as a law: what raises its level is an input."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import SimpleNamespace
from typing import cast

from stribeck.constants import Constant
from stribeck.errors import note
from stribeck.expressions import pretty
from stribeck.expressions.graph import symbols
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value
from stribeck.laws.base import Claims, Law
from stribeck.laws.values import Constants, observer_of
from stribeck.machine.assembly import Assembly
from stribeck.machine.elements.contacts import Contact
from stribeck.machine.table import Carrier
from stribeck.scenario import Scenario
from stribeck.simulation.comparison import law_path

Places = dict[tuple[str, str], str]
POSITION = ("position", "")  # the input of a factor with waves; others are ("load", NAME) and ("factor", NAME)


def contact_law(scenario: Scenario, contact: str | None = None) -> Law:
    """The friction of one of a machine's contacts as a law.

    Its constants are those of the contact's law, and the gains, weights and waves of its loads and factors. Its
    ``inputs`` are constants that change from instant to instant:

    - ``load_NAME``: the force of the link, motor or load NAME;
    - ``factor_NAME``: a signal's factor of the constant NAME;
    - ``position``: of the contact, if factors are waves of it.

    An underscore is added if the contact's law has a constant of that name.

    Raises:
        InputError: there is no such contact, or none is named where there are several.
    """
    path, machine = scenario.called.to_machine(law_path(scenario, contact)), scenario.elements
    law = machine.laws[path]
    (part,) = (each for each in machine.system.contacts if each.law_path == path)
    if (ratio := machine.values.get((part.path, "ratio"), 1.0)) != 1:
        note(f"{part.path}.ratio: {ratio:g}: v and F are those of the contact: F acts on the body by {ratio:g} times")
    if not part.loads and not part.factors:
        return law
    kind, places = _with_inputs(type(law), part)
    attached = {name: machine.values[place] for place, name in places.items() if place[0] != path}
    return kind({**law.machine, **law.p.numbers, **law.p.words, **attached}, law.rotary)


def deflection(scenario: Scenario, contact: str | None = None) -> tuple[str, float]:
    """The deflection of a contact's bristles at t = 0, m (rad), behind its key in the file.

    Raises:
        InputError: there is no such contact, or none is named where there are several.
    """
    path = scenario.called.to_machine(law_path(scenario, contact))
    (part,) = (each for each in scenario.elements.system.contacts if each.law_path == path)
    column = f"{part.name}.z" if part.name else "z"
    return scenario.called.to_file(f"{part.path}.initial.z"), scenario.initial.get(column, 0.0)


@dataclass(frozen=True)
class _Instant:
    """The quantities that a contact needs from the machine's assembly, from the law's inputs."""

    p: SimpleNamespace
    inputs: Places
    called: Names = field(default_factory=Names)

    def force_of(self, name: str) -> Value:
        """The force of a link, motor or load."""
        return getattr(self.p, self.inputs["load", name])

    def reference(self, signal: Value) -> Value:
        """The value of a factor's signal, whose path is ...factors.NAME.signal."""
        return SimpleNamespace(value=getattr(self.p, self.inputs["factor", signal.path.split(".")[-2]]))


@lru_cache(maxsize=64)
def _with_inputs(base: type[Law], part: Contact) -> tuple[type[Law], Places]:
    """The law of such a contact, and its constants for those of the machine's tables."""
    taken = {*base.constants()}
    declared, places = _constants(part, taken)
    inputs, called = _inputs(part, taken)

    def loaded(p: SimpleNamespace) -> Constants:
        """The base law's constants at this instant, by the contact's own equations."""

        def put(owner: str, name: str) -> Value:
            return getattr(p, places[owner, name]) if (owner, name) in places else 1.0

        here = cast(Contact, part.carrying(part.path, Carrier(put)))
        constants = here.parameters(cast(Assembly, _Instant(p, called)), position(p))
        return _with_terms(constants, p, inputs)

    def position(p: SimpleNamespace) -> Value:
        return getattr(p, called[POSITION]) if POSITION in called else 0.0

    def at_instant(equation: Callable[..., Value]) -> Value:
        return staticmethod(lambda p, *rest: equation(loaded(p), *rest))

    equations = {n: at_instant(getattr(base, n)) for n in ("dz_dt", "friction", "z_bound", "z_elastic")}
    claims = Claims(unique=base.claims.unique, bounded=base.claims.bounded, smooth=base.claims.smooth)
    beside = [f"{part.path}.loads" for _ in part.loads[:1]] + [
        f"{part.path}.factors.{constant}" for constant in part.factors
    ]
    attributes = {
        "name": base.name, "__doc__": f"{(base.__doc__ or base.name).strip()} Its level follows loads.", "claims": claims,
        "inputs": tuple(inputs), "beside": tuple(beside),
    }  # fmt: skip
    kind: type[Law] = type(base.__name__, (base,), {**attributes, **declared, **inputs, **equations})
    return kind, places


def _with_terms(constants: Constants, p: SimpleNamespace, inputs: Iterable[str]) -> Constants:
    """The same, with what loads and factors change as named terms of the inputs: F_c(load_gear)."""
    on_term = observer_of(p)
    if on_term is None:
        return constants
    read = {str(getattr(p, name).value): getattr(p, name) for name in inputs}
    terms = {}
    for name, x in constants.numbers.items():
        if x is not getattr(p, name):
            arguments = tuple(read[each] for each in read if each in symbols([x]))
            terms[name] = on_term(name, pretty.name(name, latex=True), arguments, x)
    return Constants({**vars(constants), **terms}, on_term)


def _free(name: str, taken: set[str]) -> str:
    """A name that is not taken, which it then is."""
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def _constants(part: Contact, taken: set[str]) -> tuple[dict[str, Constant], Places]:
    """The constants that loads and factors add, by name; and every constant's name by its place in the file."""
    declared, places = dict[str, Constant](), Places()
    for leaf in part.leaves(part.path):
        owner, name = leaf.key
        section, _, inside = owner.removeprefix(f"{part.path}.").partition(".")
        if owner == part.law_path:
            places[leaf.key] = name
        elif section in ("loads", "factors"):
            gain = (
                f"weight_{inside}_{name.removeprefix('weight_')}"
                if name.startswith("weight_")
                else f"gain_{inside}_{name}"
            )
            places[leaf.key] = _free(gain if section == "loads" else f"{inside}_{name}", taken)
            declared[places[leaf.key]] = replace(leaf.constant, optional=False)
    return declared, places


def _inputs(part: Contact, taken: set[str]) -> tuple[dict[str, Constant], Places]:
    """The inputs of the contact at each instant, by name; and the names of its loads, factors and position."""
    named = [name for each in part.loads for name in (*each.weights, *([each.against] if each.against else []))]
    inputs = {("load", name): Constant("N", f"force of {name}", default=0.0) for name in named}
    for factored, factor in part.factors.items():
        if factor.signal is not None:
            inputs["factor", factored] = Constant("1", f"factor of {factored}", above=0, default=1.0)
    if any(factor.signal is None for factor in part.factors.values()):
        inputs[POSITION] = Constant("m", "position of the contact", default=0.0)
    called = {key: _free("_".join(filter(None, key)), taken) for key in inputs}
    return {called[key]: constant for key, constant in inputs.items()}, called
