"""The model of an exported machine: generated C, values as tables, and names."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

from stribeck.codegen import parameter_names, with_columns
from stribeck.constants import Column, Constant
from stribeck.errors import InputError, arg
from stribeck.exports.c.ccode import c_conditions
from stribeck.exports.request import PLAIN, Options, ascii_only, identifier, made_by, valued
from stribeck.machine.signal import INPUT, SignalUse
from stribeck.machine.system import MachineSystem
from stribeck.machine.table import SYMBOLS
from stribeck.scenario import Scenario
from stribeck.simulation.promise import SAMPLED_SHARE, step_share
from stribeck.simulation.result import held_back


@dataclass(frozen=True)
class RunTimeConstant:
    """A run-time constant: its path in the file, its name in C, its declaration and value."""

    path: str
    name: str
    constant: Constant
    value: float


class MachineModel:
    """A machine's export; ``scenario`` must be one of ``schema = 2``.

    Raises:
        InputError: there is no scenario, or it is no machine.
    """

    def __init__(self, scenario: Scenario | None, origin: str = "", options: Options = PLAIN) -> None:
        if scenario is None or scenario.elements.unnamed:
            given = "" if scenario is None else f"{scenario.name!r}: "
            raise InputError(f"{arg('scenario')}: {given}part 'machine' needs a machine (schema = 2)")
        self.scenario, self.origin, self.options = scenario, origin, options
        self.machine = MachineSystem(scenario.elements.carrying(replace(SYMBOLS, open=True)))

    @cached_property
    def name(self) -> str:
        """The machine's name as an identifier of C."""
        return identifier(self.scenario.name.lower())

    @cached_property
    def code(self) -> str:
        """The equations, the solver, and the columns of the output."""
        machine = self.machine
        return with_columns(machine, lambda: machine.outputs).encode("ascii", "replace").decode()

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of the output after t."""
        return self.machine.columns

    @cached_property
    def parameters(self) -> list[RunTimeConstant]:
        """Every run-time constant, in the order in which the code takes them; inputs among them."""
        values = {
            **self.scenario.elements.values,
            **dict.fromkeys([p for p in self.machine.parameters if p[1] == INPUT], 0.0),
        }
        names = parameter_names(self.machine)
        return [
            RunTimeConstant(f"{path}.{n}", c, self.machine.constant(path, n), float(values[path, n]))
            for (path, n), c in zip(self.machine.parameters, names, strict=True)
        ]

    @cached_property
    def inputs(self) -> dict[int, Column]:
        """Path and unit of each signal to which something can be added, by the place of that among the constants."""
        place, meaning = self.machine.parameters.index, "added to the signal of the file, held over a step"
        return {
            place((use.path, INPUT)): Column(use.path, _unit_of(self.machine, use), meaning)
            for use in self.machine.signals
            if use.open
        }

    @cached_property
    def tunable(self) -> list[RunTimeConstant]:
        """The constants that are no inputs."""
        return [each for i, each in enumerate(self.parameters) if i not in self.inputs]

    @property
    def conditions(self) -> list[tuple[RunTimeConstant, str, str]]:
        """(a constant, what is allowed in words, the condition in C on ``p``)."""
        conditions = []
        for each in self.tunable:
            c, x = each.constant, f"p->{each.name}"
            tests = [f"isfinite({x})"]
            tests += [f"{x} > {c.above!r}"] if c.above is not None else []
            tests += [f"{x} >= {c.at_least!r}"] if c.at_least is not None else []
            tests += [f"{x} != 0"] if c.largest is not None else []
            conditions.append((each, c.allowed, " && ".join(tests)))
        by_path = {each.path: each for each in self.tunable}
        for path, law in self.scenario.elements.laws.items():
            places = {n: f"p->{by_path[f'{path}.{n}'].name}" for n in law.constants() if f"{path}.{n}" in by_path}
            for key, allowed, text in c_conditions(law, places):
                conditions.append((by_path[f"{path}.{key}"], allowed, text))
        return conditions

    @cached_property
    def start(self) -> dict[str, float]:
        """The state at t = 0, by name."""
        return {s.name: float(self.scenario.initial.get(s.name, 0.0)) for s in self.machine.states}

    def about(self) -> list[str]:
        """Lines for the header."""
        first, *rest = self.machine.heading
        lines = [f"{self.name}: {first[0].lower()}{first[1:]}", "", *(f"  {line}" for line in rest), ""]
        lines.append(f"Parameters: {self.origin or f'scenario {self.scenario.name}'}.")
        lines += [valued(each.path, each.value, each.constant) for each in self.tunable]
        return [ascii_only(line) for line in (*lines, made_by())]

    def context(self) -> dict[str, object]:
        """Values for the templates."""
        scenario, machine, held = self.scenario, self.machine, len(self.machine.held)
        pieces, share = scenario.pieces, step_share(scenario)
        room, noise = held_back(scenario.end, [scenario.elements.sampling()])
        atol = scenario.atol()
        limit = scenario.elements.longest_step
        low, high, power = SAMPLED_SHARE
        return {
            "low": low, "high": high, "power": power,
            "P": self.name, "model": self.name, "about": self.about(), "m": self, "code": self.code,
            "held": held, "memory": sum(map(len, machine.memory.values())),
            "starts": numbers(self.start.values()), "values": numbers(p.value for p in self.parameters),
            "atol": numbers(share * atol[s.name] for s in machine.states),
            "fixed": ", ".join("1" if s.name in scenario.solve.atol else "0" for s in machine.states),
            "rtol": repr(share * scenario.solve.rtol),
            "wanted": repr(scenario.solve.rtol), "piece_start": numbers(pieces.start),
            "piece_rows": numbers(pieces.rows.ravel()), "piece_restart": ", ".join(map(str, pieces.restart.tolist())),
            "pieces": len(pieces.start), "room": room, "noise": numbers(noise.ravel()), "noise_room": noise.shape[1],
            "noise_end": scenario.end if noise.shape[1] else None,
            "limit": repr(limit) if limit < float("inf") else "INFINITY", "max_steps": int(scenario.solve.max_steps),
            "t_end": repr(float(scenario.end)), "step": repr(float(scenario.output.step)),
            "period": None, "with_energy": machine.energy,
        }  # fmt: skip

    def notes(self) -> list[str]:
        """Notes about differences from the simulation."""
        if any(each.sampling is not None and each.sampling.noise is not None for each in self.machine.controllers):
            return [f"measurement noise is exported up to t = {self.scenario.end:g} s; later readings have none"]
        return []

    @cached_property
    def state_names(self) -> dict[str, str]:
        """The names of the states in C, after ``X_``."""
        return _c_names(s.name for s in self.machine.states)

    @cached_property
    def column_names(self) -> dict[str, str]:
        """The names of the columns in C; none is that of a state or constant, with the letter before it."""
        others = [*(f"X_{name}" for name in self.state_names.values()), *(f"P_{each.name}" for each in self.parameters)]
        return _c_names((c.name for c in self.columns), others)


def _c_names(names: Iterable[str], taken: Iterable[str] = ()) -> dict[str, str]:
    """Names as parts of identifiers, each once."""
    used, identifiers = {*taken}, {}
    for name in names:
        text = re.sub(r"\W", "_", name)
        while text in used:
            text += "_"
        used.add(text)
        identifiers[name] = text
    return identifiers


def numbers(values: Iterable[float]) -> str:
    """Numbers for an initializer in C, a few on each line; never none."""
    texts = [_number(float(x)) for x in values] or ["0"]
    lines = [", ".join(texts[i : i + 6]) for i in range(0, len(texts), 6)]
    return ",\n    ".join(lines)


def _number(x: float) -> str:
    return repr(x) if abs(x) < float("inf") else "INFINITY" if x > 0 else "-INFINITY"


def _unit_of(machine: MachineSystem, use: SignalUse) -> str:
    """The unit of a signal, by its table."""
    section, name, *_rest = use.path.split(".")
    if section == "motors":
        return "V"
    element = getattr(machine.elements, section).get(name)  # None: a pressure cascade, whose piston does not turn
    turns = element is not None and element.turning(machine.elements)
    units = {"bodies": ("m/s", "rad/s"), "loads": ("N", "N m")}
    return units.get(section, ("m", "rad"))[turns]
