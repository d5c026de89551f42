"""A file of schema 1 as tables of schema 2: the first act of loading. Nothing after it knows schema 1.

Its elements have no names, for each is the only one of its section: what a machine calls ``body.y`` is ``y`` here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from stribeck import parameter_sets
from stribeck.constants import Column, kind_of, show
from stribeck.errors import InputError, corrected, nearest
from stribeck.kinds import in_a_file
from stribeck.laws.base import Law
from stribeck.machine.elements.bodies import MASS as OF_BODY
from stribeck.machine.law import unknown
from stribeck.machine.table import Problem, no_table, table_path

Table = Mapping[str, object]
Sections = dict[str, dict[str, dict[str, object]]]
TOP = ("schema", "name", "rotary", "law", "plant", "drive", "solve", "output")
SIGNALS = {
    "force": "force on the body, N",
    "spring": "position of the spring's far end, m",
    "pid": "setpoint, m",
    "velocity": "velocity, m/s",
    "cascade": "desired position, m",
}  # by kind of drive
CONSTANTS = {"force": (), "spring": ("stiffness",), "pid": ("K_p", "K_i", "K_d"), "velocity": ()}
MASS, PNEUMATIC = "mass", "pneumatic"  # the kinds of plants
_STARTS = {MASS: ("y", "v", "z"), PNEUMATIC: ("y", "v", "p_1", "p_2", "z")}
NOT_OF_A_PISTON = ("inertia", "tied_to", "ratio", "velocity", "rotary", "name")
# The columns that a drive adds, and what the machine calls their quantities.
_COLUMNS = {
    "force": ((Column("u", "N", "force on the body"), "f"),),
    "spring": (
        (Column("x", "m", "position of the spring's far end"), "x"),
        (Column("u", "N", "force of the spring on the body"), "f"),
    ),
    "pid": (
        (Column("r", "m", "setpoint"), "r"),
        (Column("u", "N", "force of the controller on the body"), "u"),
        (Column("I", "m s", "integral of y - r"), "I"),
    ),
}
_ORDER = (
    "y", "v", "p_1", "p_2", "z", "z_hat", "e", "s", "p_err", "u", "F", "F_hat", "V", "sigma_0_hat", "sigma_1_hat", "sigma_2_hat",
    "F_c_hat",
)  # of the columns of a servo  # fmt: skip


@dataclass(frozen=True)
class Called:
    """Names of a file that differ from those of its machine.

    Attributes:
        paths: pairs of the machine's path and the file's; the first that a path begins with counts.
        columns: those that the drive adds, with the names of their quantities in the machine.
        order: of all columns, where it is not that of other drives.
        drive: its kind; empty for a file of schema 2.
    """

    paths: tuple[tuple[str, str], ...] = ()
    columns: tuple[tuple[Column, str], ...] = ()
    order: tuple[str, ...] = ()
    drive: str = ""

    def to_file(self, path: str) -> str:
        """A machine's path as the file has it."""
        return _swapped(path, self.paths)

    def to_machine(self, path: str) -> str:
        """A file's path as the machine has it."""
        return _swapped(path, tuple((file, machine) for machine, file in self.paths))


def _swapped(path: str, pairs: tuple[tuple[str, str], ...]) -> str:
    for old, new in pairs:
        if path == old or path.startswith((f"{old}.", f"{old}[")):
            return new + path.removeprefix(old)
    return path


@dataclass(frozen=True)
class ElementNames:
    """The names of the body, the contact and the drive; empty in a file of schema 1."""

    body: str = ""
    contact: str = ""
    mover: str = ""

    @classmethod
    def by_drive(cls, drive: str) -> ElementNames:
        """Those of the machine that is the same."""
        return cls("body", "contact", drive if drive in ("force", "spring") else "controller")


def turns(data: Table, folder: Path) -> bool:
    """Whether the body of such a file turns: it says so, or its set of parameters does."""
    law = data.get("law")
    if "rotary" in data:
        return data["rotary"] is True
    named = law.get("parameters") if isinstance(law, Mapping) else None
    if not isinstance(named, str):
        return isinstance(law, Law) and law.rotary
    try:
        return parameter_sets.load(named, folder, ()).rotary
    except InputError:  # which the law's table says
        return False


def translated(data: Table, rotary: bool, names: ElementNames | None = None) -> tuple[Sections, Called, list[Problem]]:
    """The sections of the machine, the file's names of its elements, and problems of the file's own structure.

    Everything else is checked as in a machine.

    Args:
        data: the tables of the file.
        rotary: whether the body turns.
        names: of the elements.
    """
    problems = list[Problem]()
    if not isinstance(given := data.get("rotary", False), bool):
        problems.append(("rotary", f"{show(given)}: must be true or false, not {kind_of(given)}"))
    drive, kind = _drive(data, problems)
    plant = _plant(data, kind, problems)
    if kind == "cascade" and rotary:
        problems.append(("rotary", "true: must be left out: the piston of a cylinder does not turn"))
    called = names or ElementNames()
    body, start = _body(plant, kind, rotary, problems)
    if "law" not in data:
        problems.append(("law", "missing: the table [law] must be given (with name and parameters)"))
    law = {"law": data["law"]} if "law" in data else {}
    contact = {"from": called.body, **law, **({"initial": start} if start else {})}
    sections: Sections = {"bodies": {called.body: body}, "contacts": {called.contact: contact}}
    settings = {n: x for n, x in drive.items() if n not in ("kind", "signal") and x is not None}
    signal = {"signal": drive["signal"]} if "signal" in drive else {}
    bodies, contacts = table_path("bodies", called.body), table_path("contacts", called.contact)
    paths = [
        (f"{contacts}.initial.z", "plant.initial.z"), (f"{bodies}.initial", "plant.initial"),
        (f"{contacts}.initial", "plant.initial"), (f"{contacts}.law", "law"),
        *([(f"{bodies}.inertia", "plant.mass")] if rotary else []), (bodies, "plant"),
    ]  # fmt: skip
    if kind == "velocity":
        sections["bodies"][called.body] = {
            "velocity": signal, **{n: x for n, x in body.items() if n == "initial"}, **({"rotary": True} if rotary else {})
        }  # fmt: skip
        paths = [(f"{bodies}.velocity.signal", "drive.signal"), (f"{bodies}.velocity", "drive"), *paths]
    elif kind == "spring":
        sections["links"] = {called.mover: {"from": signal, "to": called.body, **settings}}
        links = table_path("links", called.mover)
        paths += [(f"{links}.from.signal", "drive.signal"), (links, "drive")]
    elif kind == "pid" or (kind == "cascade" and "kind" in body):
        words = {"kind": "pid" if kind == "pid" else "pressure_cascade", "on": called.body}
        sections["controllers"] = {called.mover: {**words, **signal, **settings}}
        paths.append((table_path("controllers", called.mover), "drive"))
    elif kind == "force" or signal:
        sections["loads"] = {called.mover: {"on": called.body, "kind": "signal", **signal, **settings}}
        paths.append((table_path("loads", called.mover), "drive"))
    columns = tuple((c.of_motion(rotary), name) for c, name in _COLUMNS.get(kind, ()))
    return sections, Called(tuple(paths), columns, _ORDER if kind == "cascade" else (), kind), problems


def constants_of(kind: str) -> tuple[str, ...]:
    """The keys of [drive] beside kind and signal, by its kind."""
    if kind != "cascade":
        return CONSTANTS[kind]
    from stribeck.machine.elements.controllers.pressure_cascade import PressureCascade  # some milliseconds of a start

    return tuple(key for key in PressureCascade.file_keys() if key not in ("kind", "on", "signal"))


def _drive(data: Table, problems: list[Problem]) -> tuple[dict[str, object], str]:
    """[drive] with the keys that it may have, and its kind; empty where it has none that is known."""
    table = data.get("drive")
    if not isinstance(table, Mapping):
        text = f"missing: the table [drive] must be given (with kind, one of {', '.join(SIGNALS)}, and signal)"
        problems.append(("drive", text if table is None else no_table(table)))
        return {}, ""
    kind = corrected(table, ("kind",)).get("kind")
    if not (isinstance(kind, str) and kind in SIGNALS):
        every = dict.fromkeys(("kind", *(n for each in SIGNALS for n in constants_of(each)), "signal"))
        problems += unknown({n: x for n, x in table.items() if n not in every}, "drive", every)
        allowed = f"one of {', '.join(SIGNALS)}"
        guess = nearest(kind, SIGNALS) if isinstance(kind, str) else ""
        text = f"{show(kind)}: must be {allowed}{guess}" if "kind" in table else f"missing: must be given ({allowed})"
        problems.append(("drive.kind", text))
        return {"signal": table["signal"]} if "signal" in table else {}, ""
    known = ("kind", *constants_of(kind), "signal")
    problems += unknown(table, "drive", known)
    table = corrected(table, known)
    if "signal" not in table:
        problems.append(("drive.signal", f"missing: must be given ({SIGNALS[kind]})"))
    return {n: x for n, x in table.items() if n in known}, kind


def _plant(data: Table, drive: str, problems: list[Problem]) -> dict[str, object]:
    """[plant] with the keys that it may have."""
    table = data.get("plant")
    if not isinstance(table, Mapping):
        if table is not None:
            problems.append(("plant", no_table(table)))
        elif drive not in ("", "velocity"):
            problems.append(("plant", "missing: the table [plant] must be given (with mass)"))
        return {"mass": 1.0}  # in its place
    table = {n: x for n, x in table.items() if x is not None}
    kind, allowed = corrected(table, ("kind",)).get("kind"), PNEUMATIC if drive == "cascade" else MASS
    if in_a_file(kind) and drive != "cascade":
        return table
    if (kind is not None or drive == "cascade") and kind != allowed:
        text = f"{show(kind)}: must be {allowed!r}" if kind is not None else f"missing: must be given ({allowed})"
        problems.append(("plant.kind", text))
    if drive == "cascade":
        foreign = {n: x for n, x in table.items() if n in NOT_OF_A_PISTON}
        problems += unknown(foreign, "plant", ())
        return {n: x for n, x in table.items() if n not in foreign} | {"kind": PNEUMATIC}
    known = ("kind", "mass", "initial")
    problems += unknown(table, "plant", known)
    table = corrected(table, known)
    if "mass" not in table and drive != "velocity":
        if drive:  # whether a mass must be given depends on the drive
            problems.append(("plant.mass", "missing: must be given (mass of the body, kg)"))
        table["mass"] = 1.0
    return {n: x for n, x in table.items() if n in ("mass", "initial")}


def _body(
    plant: Table, drive: str, rotary: bool, problems: list[Problem]
) -> tuple[dict[str, object], dict[str, object]]:
    """The table of the body, and where the bristles start."""
    body, start = dict(plant), plant.get("initial")
    if drive == "velocity" and "mass" in body and (text := OF_BODY.problem(body["mass"])):
        problems.append(("plant.mass", f"{show(body['mass'])}: {text}"))
    if rotary and "mass" in body:
        body["inertia"] = body.pop("mass")
    if not isinstance(start, Mapping):
        return body, {}
    known = _STARTS.get(str(plant.get("kind", MASS)))
    if known is not None:
        problems += unknown(start, "plant.initial", [n for n in known if n != "v" or drive != "velocity"] + (
            ["v"] if drive == "velocity" and "v" in start else []
        ))  # fmt: skip
        start = {n: x for n, x in corrected(start, known).items() if n in known}
    body["initial"] = {n: x for n, x in start.items() if n != "z"}
    return body, {n: x for n, x in start.items() if n == "z"}
