"""Documents of laws and of the library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from stribeck.constants import DECIDED, rotary_words
from stribeck.laws.base import PARAMETERS, Law
from stribeck.laws.render import equations
from stribeck.mouth.document import PAGE, Cell, Chapter, Document, Table
from stribeck.parameter_sets import ParameterSet
from stribeck.parameter_sets.library import MachineSet

if TYPE_CHECKING:
    from stribeck.laws.library import Library

_NO_CLAIMS = {True: "none stated", False: "no internal state, so none of the five properties"}


def chapter(law: Law, key: str = "law", of: str = "") -> Chapter:
    """A law with its constants, as a chapter of a page; ``of``: words for where it acts."""
    declared = law.constants()
    words = rotary_words if law.rotary else str
    rows = [
        (n, f"{x:g}" if isinstance(x, float) else str(x), declared[n].unit_for(law.rotary) or "1", words(declared[n].meaning))
        for n, x in (law.p.numbers | law.p.words).items()
    ]  # fmt: skip
    about = " ".join((type(law).__doc__ or "").split())
    return Chapter(
        key,
        f"The law{of}: {law.name}" if of else f"The law {law.name}",
        [about, f"Source: {law.source}."],
        [Table(["constant", "value", "unit", "meaning"], rows, prose=True)],
        code="\n".join(each.text for each in equations(type(law), law.form)),
        on=PAGE,
    )


def shelf(library: Library) -> Document:
    """All entries of the library, a line each."""
    laws = [[name, " ".join((each.__doc__ or "").split())] for name, each in library.laws.items()]
    sets = [[each.name, each.title] for each in library.sets.values()]
    machines = [[m.name, f"{m.title} ({m.origin}; {m.license})"] for m in library.machines.values()]
    return Document(
        "library",
        f"{len(laws)} laws, {len(sets)} parameter sets, {len(machines)} machines",
        ["'stribeck library NAME' shows the details; for a machine, --out FILE.toml writes its file"],
        [
            _listed("laws", "law", laws),
            _listed("sets", 'parameter set (parameters = "NAME")', sets),
            _listed("machines", "machine", machines),
        ],
    )


def _listed(key: str, what: str, rows: Sequence[Sequence[Cell]]) -> Chapter:
    return Chapter(key, what.capitalize(), tables=[Table([what, "description"], rows, prose=True)])


def law(description: Mapping[str, Any]) -> Document:
    """A law from :func:`stribeck.laws.library.described`: equations, claims, constants, source."""
    facts = [f"claims: {_claims(description['guarantees']) or _NO_CLAIMS[description['has_z']]}"]
    for form, changed in description["with"].items():
        parts = [*(e["text"] for e in changed["equations"]), _claims(changed["guarantees"])]
        facts.append(f"with {form}: {'; '.join(part for part in parts if part)}")
    rows = [
        [n, p["allowed"] if p["allowed"].startswith("one of") else p["unit"], p["where"], p["meaning"]]
        for n, p in description["parameters"].items()
    ]
    table = Table(["constant", "unit", "table", "meaning"], rows, prose=True)
    code = "\n".join(each["text"] for each in description["equations"])
    return Document(
        description["name"],
        description["summary"],
        [f"source: {description['source']}"],
        [Chapter("equations", "Equations", facts=facts, code=code), Chapter("constants", "Constants", tables=[table])],
    )


def _claims(guarantees: Mapping[str, object]) -> str:
    words = []
    for name, claim in guarantees.items():
        if claim is not None:
            text = f"if {claim['if']['text']}" if isinstance(claim, dict) else DECIDED[bool(claim)]
            words.append(f"{name.replace('_', '-')}: {text}")
    return "; ".join(words)


def parameter_set(parameters: ParameterSet) -> Document:
    """A law's parameters as published."""
    words = rotary_words if parameters.rotary else str
    rows: list[list[Cell]] = [
        [n, x, PARAMETERS[n].unit_for(parameters.rotary), words(PARAMETERS[n].meaning)]
        for n, x in parameters.values.items()
    ]
    return Document(
        parameters.name,
        f"{parameters.title} ({parameters.motion})",
        [f"source: {parameters.source}"],
        [Chapter("values", "Values", tables=[Table(["constant", "value", "unit", "meaning"], rows)])],
    )


def machine(machine_set: MachineSet) -> Document:
    """A machine with its values and their sources."""
    rows: list[list[Cell]] = [
        [
            path,
            *(cast(Cell, p.get(key)) for key in ("value", "low", "high", "unit")),
            cast(Cell, p.get("state", p.get("verdict"))),
        ]
        for path, p in machine_set.parameters.items()
    ]
    words = ("holds", "source", "record", "license", "origin", "date", "command")
    table = Table(["number", "value", "from", "to", "unit", "state"], rows)
    return Document(
        machine_set.name,
        machine_set.title,
        [f"{word}: {text}" for word in words if (text := getattr(machine_set, word))],
        [Chapter("numbers", "Numbers", tables=[table])],
    )
