"""A machine drawn as a schematic: bodies, what is between them, what acts on them, with their numbers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from markupsafe import Markup, escape

from stribeck.errors import printable
from stribeck.machine.element import BetweenBodies
from stribeck.machine.elements.pressure_cascade import PressureCascade
from stribeck.machine.machine import Elements

_COLUMN, _BOX, _HEIGHT, _LANE = 250, 130, 56, 76  # widths and heights in px
_LISTS = ("amplitude", "waves", "phase")
_STYLE = """
svg{font:13px sans-serif} .n{font-weight:bold} .s{font-size:11px;fill:#333}
.l{stroke:#000;stroke-width:1.4;fill:none} .b{stroke:#000;stroke-width:1.6;fill:#f3f3f3}
.c{stroke:#D55E00;stroke-width:2;fill:none} .k{stroke:#0072B2;stroke-width:1.6;fill:none}
.m{stroke:#009E73;stroke-width:1.6;fill:#fff} .d{stroke:#666;stroke-width:1.2;stroke-dasharray:4 3;fill:none}
"""


def number(x: float) -> str:
    """A number in as many digits as tell it from its neighbors."""
    return f"{x:.4g}"


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
        shown = [f"{n} {number(x)}" for n in ("F_c", "F_s", "sigma_0") if (x := law.values.get(n)) is not None]
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
        stem, _, digits = name.rpartition("_")
        numbers, _ = shown.setdefault(stem if digits.isdigit() and stem in _LISTS else name, ([], unit))
        numbers.append(number(value))
    return tuple(f"{n} {', '.join(x)} {unit if unit != '1' else ''}".strip() for n, (x, unit) in shown.items())


def about_body(machine: Elements, name: str) -> tuple[str, ...]:
    """A body's numbers in short."""
    body = machine.system.elements.bodies[name]
    numbers = [x for x in _numbers(machine, body.path) if not x.startswith("ratio")]
    if body.tied_to is not None:
        numbers.append(f"tied to {body.tied_to}, ratio {number(machine.values.get((body.path, 'ratio'), 1.0))}")
    if body.velocity is not None:
        numbers.append(f"velocity: {machine.signals[next(body.signals())].kind}")
    start = [f"{q} {number(x)}" for q in "yv" if (x := machine.initial.get(f"{name}.{q}"))]
    return (*numbers, *(["starts at " + ", ".join(start)] if start else []))


# -- as text ---------------------------------------------------------------------------------------------------------


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


# -- as a picture ----------------------------------------------------------------------------------------------------


def _shown(text: str) -> Markup:
    return escape(printable(text))


@dataclass
class _Page:
    parts: list[str] = field(default_factory=list)

    def line(self, points: Iterable[tuple[float, float]], kind: str = "l", end: str = "") -> None:
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.parts.append(f'<polyline class="{kind}" points="{path}"{end}/>')

    def arrow(self, points: list[tuple[float, float]], kind: str = "l") -> None:
        self.line(points, kind, ' marker-end="url(#tip)"')

    def words(self, x: float, y: float, name: str, numbers: Iterable[str], anchor: str = "start") -> None:
        self.parts.append(f'<text class="n" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{_shown(name)}</text>')
        for i, row in enumerate(_wrapped(numbers)):
            place = f'x="{x:.1f}" y="{y + 13 * (i + 1):.1f}" text-anchor="{anchor}"'
            self.parts.append(f'<text class="s" {place}>{_shown(row)}</text>')

    def spring(self, x: float, y: float, vertical: bool) -> None:
        """A zigzag of 40 px about a point, over a white ground."""
        steps = [(-20.0, 0.0), *((-14 + 4 * i, 7.0 if i % 2 else -7.0) for i in range(8)), (20.0, 0.0)]
        self.parts.append(f'<rect x="{x - 20}" y="{y - 20}" width="40" height="40" fill="#fff"/>')
        self.line([(x + q, y + p) if vertical else (x + p, y + q) for p, q in steps], "k")

    def brush(self, x: float, y: float, vertical: bool) -> None:
        """Two surfaces with bristles between them."""
        self.parts.append(f'<rect x="{x - 20}" y="{y - 20}" width="40" height="40" fill="#fff"/>')
        for side in (-1, 1):
            self.line([(x - 16, y + 7 * side), (x + 16, y + 7 * side)], "c")
            off = (0.0, 20.0 * side) if vertical else (20.0 * side, 0.0)
            self.line([(x + (0 if vertical else 16 * side), y + 7 * side), (x + off[0], y + off[1])])
        for i in range(-3, 4):
            self.line([(x + 5 * i - 2, y - 7), (x + 5 * i + 2, y + 7)], "c")

    def symbol(self, kind: str, x: float, y: float, vertical: bool) -> None:
        (self.spring if kind == "link" else self.brush)(x, y, vertical)


def _wrapped(numbers: Iterable[str]) -> list[str]:
    rows: list[str] = []
    for each in numbers:
        if rows and len(rows[-1]) + len(each) < 22:
            rows[-1] += f", {each}"
        else:
            rows.append(each)
    return rows


class _Layout:
    """Where bodies stand: each has a column as wide as what stands above and below it."""

    def __init__(self, machine: Elements) -> None:
        self.elements, self.every = machine, entries(machine)
        names = [body.name for body in machine.system.bodies]
        names += [e.start for e in self.every if e.start.startswith("~")]
        of_motor = {e.name: e.start for e in self.every if e.kind == "motor"}
        self.below = {n: [e for e in self.every if e.start == n and e.end == "ground"] for n in names}
        self.above = {n: [e for e in self.every if e.start == n and e.kind in ("load", "motor")] for n in names}
        controllers = [e for e in self.every if e.kind == "controller"]
        self.control = {n: [e for e in controllers if of_motor.get(e.start, e.start) == n] for n in names}
        self.lanes = [e for e in self.every if e.kind in ("link", "contact") and e.end != "ground"]
        self.x: dict[str, float] = {}
        self.column: dict[str, tuple[float, float]] = {}
        left = 20.0
        for n in names:
            count = max(1, len(self.below[n]), len(self.above[n]), len(self.control[n]))
            self.column[n], self.x[n] = (left, count * _COLUMN), left + count * _COLUMN / 2
            left += count * _COLUMN
        self.width = left + 60
        self.ports: dict[str, int] = {}

    def slots(self, name: str, count: int) -> list[float]:
        """The places of ``count`` things side by side in a body's column."""
        left, width = self.column[name]
        return [left + width * (i + 0.5) / count for i in range(count)]


def svg(machine: Elements, name: str) -> str:
    """The machine as an SVG picture."""
    layout, page = _Layout(machine), _Page()
    springs = [e for e in layout.lanes if e.kind == "link"]
    rubs = [e for e in layout.lanes if e.kind == "contact"]
    y_control = 40.0
    y_above = y_control + (130 if any(layout.control.values()) else 0)
    y_links = y_above + (128 if any(layout.above.values()) else 40)
    y_box = y_links + _LANE * len(springs) + 24
    y_rub = y_box + _HEIGHT + 30
    y_ground = y_rub + _LANE * len(rubs) + (150 if any(layout.below.values()) else 30)
    _lanes(page, layout, springs, y_links, y_box)
    _lanes(page, layout, rubs, y_rub + 20, y_box + _HEIGHT)
    for body, x in layout.x.items():
        _ground(page, layout, body, y_box + _HEIGHT, y_ground)
        _top(page, layout, body, y_control, y_above, y_box)
        if not body.startswith("~") and (leader := machine.bodies[body].tied_to) is not None:
            for off in (-3, 3):  # a rod: what is tied moves with it
                page.line([(layout.x[leader], y_box + _HEIGHT / 2 + off), (x, y_box + _HEIGHT / 2 + off)])
    for body, x in layout.x.items():
        _body(page, machine, body, x, y_box)
    if any(layout.below.values()):
        page.line([(10, y_ground), (layout.width - 10, y_ground)])
        for i in range(int(layout.width // 16) - 1):
            page.line([(18 + 16 * i, y_ground), (10 + 16 * i, y_ground + 10)])
    height = y_ground + 20
    size = 'markerWidth="9" markerHeight="9" refX="8" refY="4" orient="auto"'
    tip = f'<marker id="tip" {size}><path d="M0,0 L9,4 L0,8 z"/></marker>'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{layout.width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {layout.width:.0f} {height:.0f}" role="img"><style>{_STYLE}</style><defs>{tip}</defs>'
        f'<rect width="100%" height="100%" fill="#fff"/><text class="n" x="12" y="20">{_shown(name)}</text>'
        f"{''.join(page.parts)}</svg>\n"
    )


def _body(page: _Page, machine: Elements, name: str, x: float, y: float) -> None:
    left = x - _BOX / 2
    if name.startswith("~"):  # a far end that a signal moves
        page.parts.append(f'<circle class="b" cx="{x}" cy="{y + _HEIGHT / 2}" r="8"/>')
        page.words(x, y + _HEIGHT / 2 + 24, "far end", ["moved by a signal"], "middle")
        return
    body = machine.bodies[name]
    radius = 22 if body.turns else 3
    place = f'x="{left:.1f}" y="{y:.1f}" width="{_BOX}" height="{_HEIGHT}" rx="{radius}"'
    page.parts.append(f'<rect class="b" {place}/>')
    page.words(x, y + 18, name, about_body(machine, name)[:2], "middle")


def _lanes(page: _Page, layout: _Layout, every: list[Entry], y: float, y_box: float) -> None:
    """Elements between two bodies, each on a line of its own."""
    for i, entry in enumerate(every):
        assert entry.end is not None
        lane, ends = y + _LANE * i, []
        for name in (entry.start, entry.end):
            count = layout.ports[name] = layout.ports.get(name, 0) + 1
            side = 1 if layout.x[entry.start] < layout.x[entry.end] else -1
            side = side if name == entry.start else -side
            ends.append(layout.x[name] + (0 if name.startswith("~") else side * max(52 - 9 * (count - 1), 4)))
        foot = y_box + (_HEIGHT / 2 - 8 if entry.start.startswith("~") else 0)
        page.line([(ends[0], foot), (ends[0], lane), (ends[1], lane), (ends[1], y_box)])
        middle = (ends[0] + ends[1]) / 2
        page.symbol(entry.kind, middle, lane, vertical=False)
        page.words(middle, lane - 14, entry.name, (), "middle")
        for row, words in enumerate(_wrapped(entry.numbers)[:4]):
            place = f'x="{middle:.1f}" y="{lane + 22 + 12 * row:.1f}" text-anchor="middle"'
            page.parts.append(f'<text class="s" {place}>{_shown(words)}</text>')


def _ground(page: _Page, layout: _Layout, body: str, y: float, y_ground: float) -> None:
    """Elements between a body and the ground."""
    entries_ = layout.below[body]
    for x, entry in zip(layout.slots(body, max(1, len(entries_))), entries_, strict=False):
        near = min(max(x, layout.x[body] - _BOX / 2 + 8), layout.x[body] + _BOX / 2 - 8)
        turn = y_ground - 126
        page.line([(near, y), (near, turn), (x, turn), (x, y_ground)])
        page.symbol(entry.kind, x, y_ground - 60, vertical=True)
        page.words(x + 24, y_ground - 100, entry.name, entry.numbers)


def _top(page: _Page, layout: _Layout, body: str, y_control: float, y_above: float, y_box: float) -> None:
    """The elements drawn above a body, and the controllers above them."""
    places: dict[str, float] = {}
    above = layout.above[body]
    for x, entry in zip(layout.slots(body, max(1, len(above))), above, strict=False):
        near = min(max(x, layout.x[body] - 24), layout.x[body] + 24)
        page.arrow([(x, y_above + 26), (x, y_above + 92), (near, y_above + 92), (near, y_box)])
        if entry.kind == "motor":
            places[entry.name] = x
            page.parts.append(f'<circle class="m" cx="{x}" cy="{y_above + 14}" r="14"/>')
            page.parts.append(f'<text x="{x}" y="{y_above + 19}" text-anchor="middle">M</text>')
        page.words(x + 20, y_above + 14, entry.name, entry.numbers)
    for x, entry in zip(layout.slots(body, max(1, len(layout.control[body]))), layout.control[body], strict=False):
        page.parts.append(f'<rect class="m" x="{x - 40}" y="{y_control}" width="80" height="28" rx="4"/>')
        page.parts.append(
            f'<text class="n" x="{x}" y="{y_control + 19}" text-anchor="middle">{_shown(entry.name)}</text>'
        )
        for row, words in enumerate(_wrapped(entry.numbers)):
            page.parts.append(f'<text class="s" x="{x + 46}" y="{y_control + 8 + 12 * row}">{_shown(words)}</text>')
        target = (places[entry.start], y_above) if entry.start in places else (layout.x[body], y_box)
        page.arrow([(x, y_control + 28), (x, y_above - 14), (target[0], y_above - 14), target])
        measured = layout.x[str(entry.end)] - _BOX / 2 + 10
        left = min(layout.slots(body, max(1, len(above))))  # of all that stands above: the line passes none of it
        side = min(x - 64, left - 16) - 6 * layout.control[body].index(entry)
        page.arrow([(measured, y_box), (measured, y_box - 12), (side, y_box - 12), (side, y_control + 14),
                    (x - 40, y_control + 14)], "d")  # fmt: skip


def describe(machine: Elements) -> dict[str, object]:
    """The same for programs."""
    return {
        "bodies": {body.name: list(about_body(machine, body.name)) for body in machine.system.bodies},
        "elements": [
            {"kind": e.kind, "name": e.name, "from": e.start, "to": e.end, "about": list(e.numbers)}
            for e in entries(machine)
        ],
    }
