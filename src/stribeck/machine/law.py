"""The friction law of a table: read with every problem collected, and carried by the table as numbers, symbols or arrays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

from pydantic import PlainValidator, ValidationError, ValidationInfo, WithJsonSchema

from stribeck import laws
from stribeck.constants import kind_of, show
from stribeck.errors import InputError, corrected, nearest
from stribeck.expressions.ops import Value
from stribeck.kinds import in_a_file
from stribeck.laws.base import PARAMETERS, Law, Scales
from stribeck.laws.form import Form
from stribeck.laws.values import Constants, OnTerm
from stribeck.machine.table import Carrier, ConstantLeaf, Problem, Reading, joined, no_table, problems_at, unknown_key

_KEYS = ("name", "parameters")


def unknown(table: Mapping[str, object], path: str, known: Iterable[str]) -> list[Problem]:
    """A problem for each key that is not known."""
    known = [*dict.fromkeys(known)]
    strange = [(key, x) for key, x in table.items() if key not in known]
    return [(f"{path}.{key}" if path else key or "''", unknown_key(key, x, known)) for key, x in strange]


def read_law(table: object, path: str, reading: Reading) -> tuple[Law | None, list[Problem]]:
    """The law of a table at a path, or None; and what is wrong with the table.

    Where a law in a file is not executed, all but the law itself is judged.
    """
    problems: list[Problem] = []
    if not isinstance(table, dict):
        text = f"missing: the table [{path}] must be given (with name and parameters)"
        return None, [(path, text if table is None else no_table(table))]
    law = _named_law(table, path, reading, problems)
    given = _parameters(table, path, law, reading.folder, problems)
    parameters = given or {}
    constants = {name: value for name, value in table.items() if name not in _KEYS}
    paths = {name: f"{path}.parameters.{name}" for name in (*PARAMETERS, *parameters)}
    paths |= {n: f"{path}.{n}" for n in constants}
    for name in [name for name in constants if name in PARAMETERS or name in parameters]:
        inside = f"{reading.to_file(path)}.parameters"
        text = f"belongs in {inside}" if name in PARAMETERS else f"stands in {inside} too"
        problems.append((f"{path}.{name}", f"{show(constants.pop(name))}: {text}"))
    has = law.constants() if law is not None else {}
    misspelt = {n: constants.pop(n) for n in list(constants) if n not in has and nearest(n, _KEYS)}
    problems += unknown(misspelt, path, _KEYS)
    if law is None:  # the machine's parameters can be judged all the same, and what no law of the package has
        wrong = Law.problems({name: value for name, value in parameters.items() if name in PARAMETERS})
        if ".py:" not in str(table.get("name")):
            every = (name for each in laws.builtin().values() for name in each.constants())
            problems += unknown(constants, path, ("name", "parameters", *every, *PARAMETERS))
    else:
        wrong = law.problems({**parameters, **constants})
    if given is None:  # said already
        wrong = [(name, text) for name, text in wrong if name not in PARAMETERS]
    problems += [(paths.get(name, f"{path}.{name}"), text) for name, text in wrong]
    if law is None or given is None or wrong:
        return None, problems
    read = law({**parameters, **constants})
    if trouble := (in_a_file(table["name"]) and laws.trouble(read)) or laws.overflow(read):
        return None, [*problems, (f"{path}.name", f"{show(table['name'])}: {trouble}")]
    return read, problems


def problems_below(path: str, problems: Iterable[Problem]) -> ValidationError:
    """Problems of the table at a path, for its validator to raise."""
    below = ((place.removeprefix(path).lstrip("."), text) for place, text in problems)
    return problems_at([(tuple(key.split(".")) if key else (), text) for key, text in below])


def _named_law(table: Mapping[str, object], path: str, reading: Reading, problems: list[Problem]) -> type[Law] | None:
    if "name" not in table:
        if "name" not in corrected(table, _KEYS):
            problems.append((f"{path}.name", "missing: must be given (the name of a law, or FILE.py:NAME)"))
        return None
    if in_a_file(table["name"]) and not reading.executes:
        return None
    try:
        return laws.find(table["name"], reading.folder)
    except InputError as error:
        problems += [(f"{path}.name", text) for text in error.problems]
        return None


def _parameters(
    table: Mapping[str, object], path: str, law: type[Law] | None, folder: Path, problems: list[Problem]
) -> Mapping[str, object] | None:
    """The machine's parameters; None where they are missing or cannot be read, which is then said."""
    given, place = table.get("parameters"), f"{path}.parameters"
    if given is None:
        if law is None or not any(law.constants()[name].required for name in law.uses):
            return {}
        needs = f"law '{law.name}' needs {', '.join(law.uses)}"
        if "parameters" not in corrected(table, _KEYS):
            problems.append((place, f"missing: must be a table of numbers or the name of a set; {needs}"))
        return None
    if isinstance(given, dict):
        return dict(given)
    if not isinstance(given, str):
        text = f"must be a table of numbers or the name of a set, not {kind_of(given)}"
        problems.append((place, f"{show(given)}: {text}"))
        return None
    try:
        return laws.parameters_for(law, given, folder)
    except InputError as error:
        problems += [(place, text) for text in error.problems]
        return None


@dataclass(frozen=True, eq=False)
class Friction:
    """A law with its constants: numbers, symbols or arrays. Equal ones have the same class, form and constants."""

    kind: type[Law]
    form: Form
    p: Constants
    law: Law | None = None  # while the numbers are those of the file
    listed: frozenset[str] = frozenset()  # constants that the file has among the parameters
    written: Mapping[str, Any] = field(default_factory=dict)  # the table
    machine: Mapping[str, float] = field(default_factory=dict)  # its parameters, also those that the law does not use

    @classmethod
    def from_law(cls, law: Law, table: Mapping[str, Any] | None = None) -> Friction:
        """A law with numbers, and its table where it has been read from one."""
        table = law.to_dict() if table is None else table
        inside = table.get("parameters")
        return cls(
            type(law),
            law.form,
            law.p,
            law,
            frozenset(inside if isinstance(inside, Mapping) else ()),
            table,
            law.machine,
        )

    def _identity(self) -> tuple[Any, ...]:
        return self.kind, self.form, tuple(vars(self.p).items())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Friction) and self._identity() == other._identity()

    def __hash__(self) -> int:
        return hash(self._identity())

    def leaves(self, path: str) -> Iterator[ConstantLeaf]:
        """Its constants, in the order in which the class declares them."""
        for name, declared in self.kind.numbers(self.form).items():
            inside = ".parameters" if name in self.listed or name in PARAMETERS else ""
            yield ConstantLeaf(f"{path}{inside}.{name}", (path, name), declared, self.p.numbers[name])

    def carrying(self, path: str, carrier: Carrier) -> Friction:
        """See :class:`FileTable`."""
        p = self.kind.symbolic(lambda name: carrier.put(path, name), self.form)
        if carrier.structure:
            return Friction(self.kind, self.form, p)
        kept = all(x is vars(self.p)[name] for name, x in vars(p).items())
        return replace(self, p=p, law=self.law if kept else None)

    def to_table(self) -> dict[str, Any]:
        """The value as in a file."""
        return dict(self.written)

    def scales(self) -> Scales:
        """Natural magnitudes."""
        return self.kind.scales(self.p)

    @property
    def slip_speed(self) -> Value:
        """The speed at which slip and stick occur: v_s, even if the law does not use it; 0 if there is none."""
        return self.p.numbers.get("v_s", self.machine.get("v_s", 0.0))

    def with_named_terms(self, on_term: OnTerm) -> Constants:
        """The constants, whose terms are named."""
        return Constants(vars(self.p), on_term)


LAW = "friction law"


def _read(key: str, value: object, info: ValidationInfo) -> Friction | None:
    """The law of a table at ``key`` of an element's; None where it is one in a file that must not be executed yet."""
    if isinstance(value, Friction):
        return value
    if isinstance(value, Law):
        return Friction.from_law(value)
    reading = info.context or Reading()
    path = joined(reading.place, key)
    law, problems = read_law(value, path, reading)
    if problems:
        raise problems_below(path, problems)
    if law is None:
        return None
    assert isinstance(value, Mapping)
    return Friction.from_law(law, value)


_SCHEMA = WithJsonSchema({"type": "object", "title": LAW})  # the schema of files has the law's own in its place
FrictionLaw = Annotated[Friction | None, PlainValidator(lambda value, info: _read("law", value, info)), _SCHEMA]
CompensatedLaw = Annotated[
    Friction | None, PlainValidator(lambda value, info: _read("compensation.law", value, info)), _SCHEMA
]
