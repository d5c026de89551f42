"""A machine's picture: nothing lies on anything else or outside, and every line ends at what it joins."""

from itertools import combinations, pairwise
from xml.etree import ElementTree

import pytest

from stribeck import Scenario, examples
from stribeck.scenario import schematic
from tests.exports.test_machines import EVERY

ROUND = 0.06  # px: coordinates are written with one place
MACHINES = {"every": EVERY, **{name: examples.path(name) for name in ("arm", "axis_hunts", "gear")}}


class Drawn:
    """Boxes (left, top, right, bottom), texts as boxes, and lines (points) of a picture, by their classes."""

    def __init__(self, text: str) -> None:
        self.root = ElementTree.fromstring(text)
        self.width, self.height = (float(self.root.attrib[n]) for n in ("width", "height"))
        self.boxes = {kind: [self.box(e) for e in self.of(("rect", "circle"), kind)] for kind in "bm"}
        self.texts = [(e.text, self.written(e)) for e in self.of(("text",))]
        self.lines = {kind: [self.points(e) for e in self.of(("polyline",), kind)] for kind in "lckd"}

    def of(self, tags, kind=None):
        wanted = [e for e in self.root.iter() if e.tag.rpartition("}")[2] in tags]
        return [e for e in wanted if kind is None or e.get("class") == kind]

    @staticmethod
    def box(e):
        if "r" in e.attrib:
            x, y, r = (float(e.attrib[n]) for n in ("cx", "cy", "r"))
            return x - r, y - r, x + r, y + r
        x, y, w, h = (float(e.attrib[n]) for n in ("x", "y", "width", "height"))
        return x, y, x + w, y + h

    @staticmethod
    def written(e):
        """The place of a text, by the letters of its size."""
        bold = e.get("class") != "s"
        x, y, width = float(e.attrib["x"]), float(e.attrib["y"]), len(e.text) * (6.5 if bold else 5.0)
        left = x - width / 2 if e.get("text-anchor") == "middle" else x
        return left, y - (9 if bold else 8), left + width, y

    @staticmethod
    def points(e):
        return [tuple(map(float, pair.split(","))) for pair in e.attrib["points"].split()]


def overlap(a, b):
    return min(a[2], b[2]) - max(a[0], b[0]) > ROUND and min(a[3], b[3]) - max(a[1], b[1]) > ROUND


def touches(point, box):
    """Whether a point lies on the border of a box."""
    (x, y), (left, top, right, bottom) = point, box
    within = left - ROUND <= x <= right + ROUND and top - ROUND <= y <= bottom + ROUND
    return within and min(abs(x - left), abs(x - right), abs(y - top), abs(y - bottom)) <= ROUND


@pytest.fixture(params=MACHINES)
def drawn(request):
    return Drawn(schematic.svg(Scenario.of(MACHINES[request.param]).elements, request.param))


def test_nothing_lies_on_anything_else_or_outside(drawn):
    boxes = [*drawn.boxes["b"], *drawn.boxes["m"]]
    assert not [(a, b) for a, b in combinations(boxes, 2) if overlap(a, b)]
    assert not [(a[0], b[0]) for a, b in combinations(drawn.texts, 2) if overlap(a[1], b[1])]
    lines = [(x, y, x, y) for kind in drawn.lines.values() for points in kind for x, y in points]
    for left, top, right, bottom in [*boxes, *(box for _, box in drawn.texts), *lines]:
        assert left >= 0
        assert top >= 0
        assert right <= drawn.width
        assert bottom <= drawn.height


def test_lines_end_at_what_they_join(drawn):
    boxes = [*drawn.boxes["b"], *drawn.boxes["m"]]
    ground = [p for line in drawn.lines["l"] if len(line) == 2 for p in line]
    floor = max((y for _, y in ground), default=0.0) - 10
    joined = [line for kind in "ld" for line in drawn.lines[kind] if len(line) >= 4]
    assert joined
    for line in joined:
        assert all(a[0] == b[0] or a[1] == b[1] for a, b in pairwise(line)), line
        ends = [end for end in (line[0], line[-1]) if not any(touches(end, box) for box in boxes)]
        assert all(abs(y - floor) <= ROUND or end_of_load(drawn, (x, y)) for x, y in ends), (line, ends)


def end_of_load(drawn, point):
    """Whether an arrow begins below its load's name."""
    x, y = point
    return any(abs(box[0] - 20 - x) <= ROUND and abs(box[3] + 12 - y) <= ROUND for _, box in drawn.texts)
