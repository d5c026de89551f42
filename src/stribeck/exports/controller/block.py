"""A sampled controller, or its compensation alone, as a block with inputs, outputs and states.

The equations are those that the simulation samples.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property

from stribeck.constants import Column, Constant, which_controller
from stribeck.errors import InputError, arg
from stribeck.exports.c.ccode import WORDS, c_conditions
from stribeck.exports.request import PLAIN, Options, ascii_only, identifier, made_by, valued
from stribeck.expressions.emit import within_loops
from stribeck.expressions.graph import ROOT_STEPS, Expr, ordered, symbol, symbols, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import sign
from stribeck.laws.render import equations
from stribeck.machine.elements.controllers import Controller
from stribeck.machine.elements.dither import PHASE
from stribeck.machine.elements.sampling import Sampling
from stribeck.machine.machine import Elements
from stribeck.machine.observed import observed
from stribeck.machine.sampled import PERIOD
from stribeck.scenario import Scenario
from stribeck.waveforms.pieces import Reference, fields, pieces

_CALLED = ("exp", "tanh", "atan", "sin", "cos", "sqrt", "log", "pow")
_COUNTED = {"add": "addition", "sub": "addition", "neg": "addition", "mul": "multiplication", "div": "division"}


@dataclass(frozen=True)
class Block:
    """A block: one call is one sample.

    Attributes:
        scenario: the machine.
        controller: the sampled controller.
        part: "controller" (all of it) or "compensator" (its friction compensation only).
        step: sample time, s: the file's, or a given one for a continuous controller.
        origin: source of the values, for the header.
        options: of some targets only.
    """

    scenario: Scenario
    controller: Controller
    part: str
    step: float
    origin: str = ""
    options: Options = PLAIN

    # -- names -----------------------------------------------------------------------------------------------------

    @cached_property
    def name(self) -> str:
        """The prefix of all names."""
        part = "_friction" if self.part == "compensator" else ""
        return identifier(f"{self.scenario.name}_{self.controller.name}{part}".lower(), "controller")

    @property
    def rotary(self) -> bool:
        """Whether the measured body is rotary."""
        return self._elements.bodies[self.controller.body].turns

    @property
    def _elements(self) -> Elements:
        """The elements of the machine, with symbols for constants."""
        return self.scenario.system.elements

    def _column(self, name: str, unit: str, meaning: str) -> Column:
        constant = Constant(unit, meaning).of_motion(self.rotary)
        return Column(name, constant.unit, constant.meaning)

    @cached_property
    def inputs(self) -> tuple[Column, ...]:
        """The inputs at a sample that the equations use."""
        every = (
            self._column("r", "m", "reference: commanded position"),
            self._column("r_rate", "m/s", "its first derivative"),
            self._column("r_second", "m/s^2", "its second derivative"),
            self._column("y", "m", "position as the encoder reads it"),
            self._column("v", "m/s", "measured velocity"),
        )
        used = symbols(self._by_input.values())
        return tuple(column for column in every if f"input.{column.name}" in used)

    @cached_property
    def path_columns(self) -> tuple[Column, ...]:
        """The inputs for the reference."""
        return tuple(c for c in self.inputs if c.name in ("r", "r_rate", "r_second"))

    @cached_property
    def outputs(self) -> tuple[Column, ...]:
        """The outputs."""
        if self.part == "compensator":
            return (self._column("F", "N", "force to add against friction"),)
        return (self._column("u", "N", "output: commanded force"),)

    @cached_property
    def states(self) -> tuple[Column, ...]:
        """The states, which start at 0."""
        meanings = {
            "readings": ("1", "samples so far"), "last": ("m", "reading of the sample before"),
            "filter_y": ("m", "filtered position"), "filter_v": ("m/s", "filtered velocity"),
            "z_hat": ("m", "deflection of the friction observer"), PHASE: ("1", "share of the dither's wave that has passed"),
            **{s.name: (s.unit, s.meaning) for s in self.controller.states},
        }  # fmt: skip
        names = self.controller.memory(self._elements) if self.part == "controller" else self._observed
        used = symbols(self.expressions.values())
        return tuple(self._column(n, *meanings.get(n, ("1", n))) for n in names if f"state.{n}" in used)

    @property
    def _observed(self) -> tuple[str, ...]:
        compensation = self.controller.compensation
        return ("z_hat",) if compensation is not None and compensation.observes(self._elements) else ()

    # -- equations -------------------------------------------------------------------------------------------------

    @cached_property
    def called(self) -> Names:
        """The names of the symbols in the equations."""
        return Names()

    @cached_property
    def _by_input(self) -> dict[str, Expr]:
        """Outputs and next states of inputs and states."""
        rate = symbol("input.r_rate")
        r = Reference(symbol("input.r"), rate, symbol("input.r_second"), sign(rate))
        if self.part == "compensator":
            return self._compensation(r)
        memory = {n: symbol(f"state.{n}") for n in self.controller.memory(self._elements)}
        u, after = self.controller.stepped(self._elements, symbol("input.y"), r, memory, self.called)
        return {"u": u, **{f"next.{n}": x for n, x in after.items()}}

    def _compensation(self, r: Reference) -> dict[str, Expr]:
        each = self.controller
        assert each.compensation is not None
        v, z = symbol("input.v"), symbol("state.z_hat")
        force, rate = each.compensation.force(self._elements, r, v, z, self.called, exact=True)
        if rate is None or not self._observed:
            return {"F": wrap(force)}
        period = symbol(f"{each.path}.sampling.period")
        return {
            "F": wrap(force),
            "next.z_hat": observed(each.compensation.friction(self._elements), rate, z, v, period, self.called),
        }

    @cached_property
    def expressions(self) -> dict[str, Expr]:
        """Outputs by name, ``next.STATE``, and for a controller ``path.INPUT``, the file's signal at time t."""
        if self.part == "compensator":
            return self._by_input
        return self._by_input | {f"path.{c.name}": self._path[c.name] for c in self.path_columns}

    @cached_property
    def _path(self) -> dict[str, Expr]:
        path = replace(self.controller.use, turns=False).reference(symbol("t"))
        return {"r": wrap(path.value), "r_rate": wrap(path.rate), "r_second": wrap(path.second)}

    @cached_property
    def pieces(self) -> list[list[float]]:
        """The values of the signal's pieces, each after its start."""
        table = pieces(self.scenario.elements.signals[self.controller.use])
        rows = zip(table.start.tolist(), table.rows.tolist(), strict=True)
        return [[start, *row] for start, row in rows] if self.piece_fields else []

    @property
    def piece_fields(self) -> tuple[str, ...]:
        """The names of the values in a piece."""
        return fields(self.controller.use.kind)

    # -- constants -------------------------------------------------------------------------------------------------

    @cached_property
    def constants(self) -> dict[str, tuple[Constant, float, str]]:
        """Declaration, value and path of each constant that the equations use, by its name in the block."""
        machine, each = self.scenario.elements, self.controller
        values: dict[str, tuple[Constant, float]] = {
            f"{path}.{n}": (machine.system.constant(path, n), machine.values[path, n])
            for path, n in machine.system.parameters
        }
        values[f"{each.path}.sampling.period"] = (PERIOD, self.step)
        used = symbols(self.expressions.values())
        constants = {}
        for path, (constant, value) in values.items():
            if path in used:
                constants[self._constant_name(path)] = (constant, value, path)
        return constants

    def _constant_name(self, path: str) -> str:
        owner, _, name = path.rpartition(".")
        signal = self.controller.use
        if owner == signal.path:
            return f"signal_{name}"
        if self.controller.compensation is not None and owner == self.controller.friction_path:
            return f"friction_{name}"
        if owner == f"{self.controller.path}.dither":
            return f"dither_{name}"
        return "inertia" if owner.endswith(".feedforward") else name

    @cached_property
    def relations(self) -> list[tuple[str, str, str]]:
        """The constant at fault, the allowed values and the condition in C on ``p``, for relations of the friction law."""
        compensation = self.controller.compensation
        if compensation is None or self.controller.friction_path not in self.scenario.elements.laws:
            return []
        law = self.scenario.elements.laws[self.controller.friction_path]
        places = {n: f"p->friction_{n}" for n in law.constants() if f"friction_{n}" in self.constants}
        return [(f"friction_{key}", allowed, text) for key, allowed, text in c_conditions(law, places)]

    def of_symbols(self) -> dict[str, str]:
        """The text of each constant, by its symbol."""
        return {path: f"p->{name}" for name, (_, _, path) in self.constants.items()}

    # -- words -----------------------------------------------------------------------------------------------------

    def operations(self) -> str:
        """The largest number of operations of one sample."""
        nodes = ordered(self._by_input.values())
        within = within_loops(nodes)
        ops = [node.op for node in nodes for _ in range(ROOT_STEPS if node in within else 1)]
        count = Counter(_COUNTED[op] for op in ops if op in _COUNTED)
        calls = Counter(op for op in ops if op in _CALLED)
        terms = [f"{n} {word}{'s' if n > 1 else ''}" for word, n in count.items()]
        terms += [f"{n} call{'s' if n > 1 else ''} of {op}" for op, n in calls.items()]
        return ", ".join(terms) or "nothing"

    def about(self) -> list[str]:
        """Lines for the header."""
        each, scenario = self.controller, self.scenario
        how = {"reference": "the steady curve at the reference's speed", "measured": "the law at the measured speed"}
        first = (
            f"{self.name}: {each.kind} controller '{each.name}' of the machine {scenario.name}, sampled."
            if self.part == "controller"
            else f"{self.name}: friction compensation of the controller '{each.name}' of the machine {scenario.name}."
        )
        lines = [first, ""]
        if self.part == "controller":
            lines += [f"  {' '.join((type(each).__doc__ or '').split())}"]
        if each.compensation is not None:
            law = each.compensation.friction(self._elements)
            lines += [f"  Friction: {law.kind.name}, {how[each.compensation.speed]}:"]
            lines += [f"    {x.text}" for x in equations(law.kind, law.form)]
        lines += ["", f"Parameters: {self.origin or f'scenario {scenario.name}'}"]
        lines += [valued(name, value, constant) for name, (constant, value, _) in self.constants.items()]
        return [ascii_only(line) for line in (*lines, made_by())]

    def notes(self) -> list[str]:
        """Notes on differences from the file."""
        machine, notes = self.scenario.elements, []
        controller = next(c for c in machine.system.controllers if c.name == self.controller.name)
        if controller.sampling is None:
            notes.append(
                f"controllers.{controller.name} is continuous in the file: to simulate the exported one, set "
                f"sampling = {{ period = {self.step:g} }}"
            )
            return notes
        sampling = f"{controller.path}.sampling"
        delay = machine.values[sampling, "delay"]
        if delay:
            notes.append(
                f"the controller's output must act {delay:g} s after the sample, as in the file ({sampling}.delay)"
            )
        sensor = [n for n in ("resolution", "noise") if machine.values.get((sampling, n))]
        if sensor:
            sensor += ["seed"] if "noise" in sensor else []
            names = ", ".join(f"{sampling}.{n}" for n in sensor)
            notes.append(f"{names}: not in the export, because the encoder itself has this effect")
        return notes


def block_of(
    scenario: Scenario | None, part: str, controller: str | None = None, step: float | None = None, origin: str = "",
    options: Options = PLAIN,
) -> Block:  # fmt: skip
    """The block of a machine's controller.

    Args:
        scenario: a machine (schema = 2) with a controller.
        part: "controller" or "compensator".
        controller: its name; the only one unless given.
        step: sample time for a controller that is continuous in the file, s.
        origin: source of the values.
        options: of some targets only.

    Raises:
        InputError: there is no such controller, no sample time, or no compensation.
    """
    if scenario is None or scenario.elements.unnamed or not scenario.system.controllers:
        given = "" if scenario is None else f"{scenario.name!r}: "
        text = f"part '{part}' needs a machine (schema = 2) with a controller"
        raise InputError(f"{arg('scenario')}: {given}{text}")
    machine = scenario.elements
    known = [each.name for each in machine.system.controllers]
    name = which_controller(controller, known)
    each = next(c for c in machine.system.controllers if c.name == name)
    if part == "compensator" and each.compensation is None:
        raise InputError(
            f"{each.path}.compensation: missing: part 'compensator' needs one; 'stribeck design --out DIR' writes the "
            "machine with the best"
        )
    timed = part == "controller" or (each.compensation is not None and each.compensation.observes(machine))
    if each.sampling is not None:
        period_in_file = machine.values[f"{each.path}.sampling", "period"]
        if step is not None and step != period_in_file:
            raise InputError(
                f"{arg('step')}: {step:g}: must be left out: {each.path}.sampling.period = {period_in_file:g} holds"
            )
        step = period_in_file
    elif step is None and timed:
        raise InputError(f"{arg('step')}: missing: {each.path} has no sampling: give its sample time, s")
    else:
        period = symbol(f"{each.path}.sampling.period")
        each = each.model_copy(update={"sampling": Sampling.model_construct(period=period)})
    block = Block(scenario, each, part, step or 0.0, origin, options)
    if bad := [name for name in block.constants if name in WORDS or not name.isascii()]:
        raise InputError([f"{name}: a constant of this name cannot be exported: rename it" for name in bad])
    return block
