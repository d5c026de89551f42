"""A machine as a schematic of text: bodies, what is between them, what acts on them, with their numbers."""

from __future__ import annotations

from dataclasses import dataclass

from stribeck.errors import printable
from stribeck.machine.element import BetweenBodies
from stribeck.machine.elements.controllers.pressure_cascade import PressureCascade
from stribeck.machine.machine import Elements
from stribeck.mouth.cells import digits

_DIGITS = 4  # of a number: as many as tell it from its neighbors
_LISTS = ("amplitude", "waves", "phase")


@dataclass(frozen=True)
class Entry:
    """One element: its name, what it is, its ends, and its numbers in short."""

    kind: str
    name: str
    start: str
    end: str | None
    numbers: tuple[str, ...]


def entries(machine: Elements) -> list[Entry]:
    """Every element of a machine, in the file's order."""
    elements = [
        Entry("link", link.name, _start(link), link.end, _numbers(machine, link.path)) for link in machine.system.links
    ]
    for contact in machine.system.contacts:
        law = machine.laws[contact.law_path]
        shown = [f"{n} {digits(x, _DIGITS)}" for n in ("F_c", "F_s", "sigma_0") if (x := law.values.get(n)) is not None]
        shown += [f"load: {', '.join(level.weights)}" for level in contact.loads]
        shown += [f"{constant} varies" for constant in contact.factors]
        numbers = (law.name, *shown, *_numbers(machine, contact.path))
        elements.append(Entry("contact", contact.name, _start(contact), contact.end, numbers))
    for load in machine.system.loads:
        use = next(load.signals(), None)
        how = f"{load.kind}: {machine.signals[use].kind}" if use is not None else load.kind
        elements.append(Entry("load", load.name, load.on, None, (how, *_numbers(machine, load.path))))
    for motor in machine.system.motors:
        driven = (f"V: {machine.signals[motor.use].kind}",) if motor.signal else ()
        elements.append(Entry("motor", motor.name, motor.on, None, (*driven, *_numbers(machine, motor.path))))
    for each in machine.system.controllers:
        about = [each.kind, machine.signals[each.use].kind, *_numbers(machine, each.path)]
        if each.compensation is not None:
            about.append(f"compensation: {machine.laws[each.friction_path].name}, {each.compensation.speed}")
        if each.dither is not None:
            about += [f"dither: {each.dither.kind}", *_numbers(machine, f"{each.path}.dither")]
        if each.sampling is not None:
            about += ["sampled", *_numbers(machine, f"{each.path}.sampling")]
        elements.append(Entry("controller", each.name, each.on, each.measures, tuple(about)))
    for valve in (x for x in machine.system.elements.controllers.values() if isinstance(x, PressureCascade)):
        about = ["pressure cascade", machine.signals[valve.use].kind, f"observer: {valve.observer_name}"]
        about += _numbers(machine, valve.path)
        about += ["sampled", *_numbers(machine, f"{valve.path}.sampling")] if valve.sampling is not None else []
        elements.append(Entry("controller", valve.name, valve.on, valve.on, tuple(about)))
    return elements


def _start(each: BetweenBodies) -> str:
    return str(each.start) if each.far is None else f"~{each.name}"


def _numbers(machine: Elements, path: str) -> tuple[str, ...]:
    """The constants of a table that differ from their defaults, lists as lists."""
    constants, rotary = machine.system.tables.get(path, ({}, False))
    shown: dict[str, tuple[list[str], str]] = {}
    for name, constant in constants.items():
        value = machine.values[path, name]
        if constant.default is not None and value == constant.default:
            continue
        unit = constant.unit_for(rotary)
        stem, _, index = name.rpartition("_")
        numbers, _ = shown.setdefault(stem if index.isdigit() and stem in _LISTS else name, ([], unit))
        numbers.append(digits(value, _DIGITS))
    return tuple(f"{n} {', '.join(x)} {unit if unit != '1' else ''}".strip() for n, (x, unit) in shown.items())


def about_body(machine: Elements, name: str) -> tuple[str, ...]:
    """A body's numbers in short."""
    body = machine.system.elements.bodies[name]
    numbers = [x for x in _numbers(machine, body.path) if not x.startswith("ratio")]
    if body.tied_to is not None:
        numbers.append(
            f"tied to {body.tied_to}, ratio {digits(machine.values.get((body.path, 'ratio'), 1.0), _DIGITS)}"
        )
    if body.velocity is not None:
        numbers.append(f"velocity: {machine.signals[next(body.signals())].kind}")
    start = [f"{q} {digits(x, _DIGITS)}" for q in "yv" if (x := machine.initial.get(f"{name}.{q}"))]
    return (*numbers, *(["starts at " + ", ".join(start)] if start else []))


def text(machine: Elements, name: str) -> str:
    """The machine in the terminal: bodies, then each element between its ends."""
    system, every = machine.system, entries(machine)
    width = max(len(body.name) for body in system.bodies)
    lines = [name, "", "bodies"]
    for body in system.bodies:
        sign = "(o)" if body.turns else "[=]" if body.velocity is None else "-->"
        lines.append(f"  {sign} {body.name:{width}}  {', '.join(about_body(machine, body.name))}")
    drawn = {"link": ("links", "/\\/\\/"), "contact": ("contacts", "~~~~~")}
    for kind, (title, sign) in drawn.items():
        rows = [(f"{x.start} --{sign}-- {x.end}", x) for x in every if x.kind == kind]
        lines += _section(title, rows)
    lines += _section("loads", [(f"--> {x.start}", x) for x in every if x.kind == "load"])
    lines += _section("motors", [(f"(M) {x.start}", x) for x in every if x.kind == "motor"])
    rows = [(f"{x.end} ..> [{x.name}] --> {x.start}", x) for x in every if x.kind == "controller"]
    return "\n".join(map(printable, [*lines, *_section("controllers", rows)]))


def _section(title: str, rows: list[tuple[str, Entry]]) -> list[str]:
    if not rows:
        return []
    name, ends = max(len(x.name) for _, x in rows), max(len(ends) for ends, _ in rows)
    return ["", title, *(f"  {x.name:{name}}  {e:{ends}}  {', '.join(x.numbers)}" for e, x in rows)]


def describe(machine: Elements) -> dict[str, object]:
    """The machine as plain data, as ``stribeck run --show --json`` prints it."""
    return {
        "bodies": {body.name: list(about_body(machine, body.name)) for body in machine.system.bodies},
        "elements": [
            {"kind": e.kind, "name": e.name, "from": e.start, "to": e.end, "about": list(e.numbers)}
            for e in entries(machine)
        ],
    }
