"""The numbers of a scenario for the page: path, meaning, and range of the slider."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace

from stribeck.constants import Constant
from stribeck.errors import printable, unbroken
from stribeck.laws.base import PARAMETERS
from stribeck.scenario import Scenario
from stribeck.scenario.tables import Output, Solve
from stribeck.waveforms import FileSignal, PointsSignal
from stribeck.waveforms.piecewise import OfSignal

MOST_POINTS = 12  # a signal with more points is a curve, and gets no sliders

_REACH, _STEEP = (
    10.0,
    1e3,
)  # factor from the value to both ends of a slider; the same of a steepness, whose effect is small


@dataclass(frozen=True)
class Number:
    """One number: its path in the file, and its slider."""

    path: str
    name: str
    group: str
    value: float
    unit: str
    meaning: str
    low: float
    high: float
    log: bool
    above: float | None  # must be greater than
    at_least: float | None
    target: str = ""  # the system's constant that it sets: ``group.name``
    whole: bool = False
    closed: bool = False  # only between the slider's ends
    # of a machine's number: array, entry, change by that of the number
    effects: tuple[tuple[str, int, float], ...] = ()

    def as_data(self) -> dict[str, object]:
        """The number's data for the page."""
        return asdict(self) | {"unit": printable(self.unit), "meaning": unbroken(self.meaning)}


def of_law(scenario: Scenario) -> list[Number]:
    """The numbers of the scenario's law: its own constants, then the machine's."""
    law, rotary, (path,) = scenario.law, scenario.rotary, scenario.elements.laws
    values = {**law.values, **law.machine}
    declared = {**law.own_constants(), **PARAMETERS}
    law_numbers = []
    for name, constant in declared.items():
        value = values.get(name)
        if value is not None and not constant.choices:
            group = "law.parameters" if name in PARAMETERS else "law"
            target = f"{path}.{name}" if name in law.numbers(law.form) else ""
            reach = _STEEP if name == "k_v" else _REACH
            law_numbers.append(number_of(group, name, value, constant.of_motion(rotary), 0.0, target, reach))
    return law_numbers


def beside_law(scenario: Scenario) -> Iterator[Number]:
    """The scenario's other numbers, in the order of the file."""
    scales, to_file = scenario.law.scales(scenario.law.p), scenario.called.to_file
    e, system = scenario.elements, scenario.system
    sizes = {"y": 10 * scales.length, "v": 10 * scales.speed, "z": scales.length}
    starts = [*e.bodies[""].own_states(e), *e.contacts[""].own_states(e)]
    for each in (x for x in e if x.section != "contacts"):
        for leaf in (x for x in each.leaves(each.path) if ".signal." not in x.path):
            group, _, name = to_file(leaf.path).rpartition(".")
            size = 0.0 if each.section == "bodies" else 1.0
            yield number_of(group, name, leaf.value, system.constant(*leaf.key), size, ".".join(leaf.key))
        for start in starts if each.section == "bodies" else ():
            constant = Constant(start.unit, f"{start.meaning} at t = 0")
            yield number_of("plant.initial", start.name, start.start, constant, sizes.get(start.name, 1.0), "")
    yield from _of_signal(scenario)
    yield from of_run(scenario)


def of_run(scenario: Scenario) -> Iterator[Number]:
    """The numbers of the solver and the output."""
    end, step = Solve.model_fields["t_end"], Output.model_fields["step"]
    time = Constant("s", str(end.description).removesuffix(", s"), above=0)
    yield number_of("solve", "t_end", scenario.solve.t_end, time, 0.0, "", 10)
    yield number_of("solve", "rtol", scenario.solve.rtol, Constant("", "relative tolerance", above=0), 0.0, "", 1e4)
    for name, value in scenario.solve.atol.items():
        yield number_of("solve.atol", name, value, Constant("", f"absolute tolerance of {name}", above=0), 0.0, "", 1e4)
    steps = Constant("", str(Solve.model_fields["max_steps"].description), at_least=1)
    number = number_of("solve", "max_steps", scenario.solve.max_steps, steps, 0.0, "", 1e4)
    yield replace(number, whole=True)
    row_spacing = Constant("s", str(step.description).partition(",")[0], above=0)
    yield number_of("output", "step", scenario.output.step, row_spacing, 0.0, "", 10)


def _of_signal(scenario: Scenario) -> Iterator[Number]:
    signal, group, (use,) = scenario.signal, "drive.signal", scenario.elements.signals
    speed = next(c.unit for c in scenario.system.columns if c.name == "v")
    unit = next((column.unit for column, _ in scenario.called.columns), speed)
    table = scenario.data["drive"]["signal"]
    for name, constant in signal.constants.items():
        value = float(table.get(name, constant.default if constant.default is not None else 0.0))
        with_unit = constant.in_unit(unit) if isinstance(constant, OfSignal) else constant
        yield number_of(group, name, value, with_unit, 1.0, f"{use.path}.{name}" if signal.smooth else "")
    if isinstance(signal, PointsSignal) and not isinstance(signal, FileSignal) and len(signal.t) <= MOST_POINTS:
        for i, (t, value) in enumerate(zip(signal.t, signal.value, strict=True)):
            size = float(max(abs(signal.value))) or 1.0
            yield number_of(
                group, f"t[{i}]", float(t), Constant("s", f"time of point {i + 1}"), scenario.solve.t_end, ""
            )
            yield number_of(
                group, f"value[{i}]", float(value), Constant(unit, f"the signal at point {i + 1}"), size, ""
            )


def number_of(
    group: str, name: str, value: float, constant: Constant, size: float, target: str, reach: float = _REACH
) -> Number:
    """A number with its slider: from value/``reach`` to value*``reach`` if positive, otherwise to twice its magnitude, or to
    ``size`` if it is 0."""
    positive = constant.above is not None or constant.at_least is not None or value > 0
    log = positive and value > 0
    if log:
        low, high = value / reach, value * reach
    else:
        far = 2 * abs(value) or size or 1.0
        low, high = (0.0 if positive else -far), far
    return Number(
        f"{group}.{name}", name, group, float(value), constant.unit, constant.meaning, low, high, log,
        constant.above, constant.at_least, target,
    )  # fmt: skip
