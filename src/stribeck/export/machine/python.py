"""``--part machine --target python``: the machine as one Python file, which NumPy and SciPy run without Stribeck."""

from __future__ import annotations

import builtins
import keyword
import textwrap
from collections.abc import Iterable

from stribeck.equations import Sample
from stribeck.export.c.ccode import render
from stribeck.export.machine.model import MachineModel, c_names
from stribeck.expressions.emit import PYTHON, Writer
from stribeck.expressions.graph import Expr, derivative, is_zero, symbol
from stribeck.expressions.names import Names
from stribeck.simulation.result import held_back

# What the file itself calls something.
_TAKEN = frozenset(
    """
    np abs exp log sqrt sin cos atan tanh sign floor pow where both either noise m p s t x solve_ivp Radau
    """.split()  # noqa: SIM905
) | {*dir(builtins), *keyword.kwlist}


def files(model: MachineModel) -> dict[str, str | bytes]:
    """One file."""
    return {f"{model.name}.py": render("machine_python.txt", **context(model))}


def context(model: MachineModel) -> dict[str, object]:
    """What the template needs."""
    scenario, machine, texts = model.scenario, model.machine, _Texts(model)
    called = Names()
    rates, names = machine.rates(called), [state.name for state in machine.states]
    slopes = {
        (i, k): entry for i, rate in enumerate(rates) for k, n in enumerate(names)
        if not is_zero(entry := derivative(rate, symbol(n)))
    }  # fmt: skip
    samples, pieces, atol = machine.samples(called), scenario.pieces(), scenario.atol()
    moved = machine.moved_energy()
    return {
        "about": model.about(), "m": model, "name": model.name,
        "parameters": [(each, texts.fields[i]) for i, each in enumerate(model.parameters)],
        "states": [(s, model.start[s.name], atol[s.name]) for s in machine.states],
        "rates": texts.written([(f"dx[{i}]", rate) for i, rate in enumerate(rates)], called),
        "jacobian": texts.written([(f"dfdx[{i}, {k}]", e) for (i, k), e in slopes.items()], called),
        "columns": texts.written(
            [(f"out[{i}]", e) for i, e in enumerate(machine.balance(exact=True, called=called).outputs().values())], called
        ),
        "moved": None if moved is None else texts.written([("energy", moved)], called),
        "samples": [texts.sample(each, called) for each in samples],
        "memory": [c_names(each.memory) for each in samples], "held": c_names(machine.held),
        "fields": c_names(machine.piece_fields), "pieces": pieces, "timing": [each.timing for each in samples],
        "noise": held_back(scenario.end, [scenario.sampling()])[1].tolist(), "limit": scenario.longest_step,
        "scenario": scenario, "index": names.index("E_in") if moved is not None else -1,
    }  # fmt: skip


class _Texts:
    """Statements of Python for expressions of the machine."""

    def __init__(self, model: MachineModel) -> None:
        machine = model.machine
        self.fields = [each.name for each in model.parameters]
        self.states = dict(zip((s.name for s in machine.states), c_names(s.name for s in machine.states), strict=True))
        inputs = {f"{o}.{n}": f"p.{f}" for (o, n), f in zip(machine.parameters, self.fields, strict=True)}
        several = (*machine.piece_fields, *machine.held)
        inputs |= {f"segment.{n}": f"s.{c}" for n, c in zip(several, c_names(several), strict=True)}
        for each in machine.samples():
            inputs |= {f"memory.{n}": f"m.{c}" for n, c in zip(each.memory, c_names(each.memory), strict=True)}
        self.inputs = inputs | {n: f"{c}_" if c in _TAKEN else c for n, c in self.states.items()}
        self.inputs |= {"t": "t", "noise": "noise"}

    @property
    def unpacked(self) -> str:
        """The states as variables."""
        names: Iterable[str] = (self.inputs[n] for n in self.states)
        return f"{', '.join(names)}{',' if len(self.states) == 1 else ''} = x"

    def written(self, outputs: list[tuple[str, Expr]], called: Names) -> str:
        """Statements that assign these, from p, s, t and x."""
        lines = Writer(PYTHON, self.inputs, taken=_TAKEN, names=called).write(outputs)
        return textwrap.indent("\n".join([self.unpacked, *lines]), "    ")

    def sample(self, each: Sample, called: Names) -> tuple[str, str]:
        """The name of a sampled controller, and its statements."""
        outputs = [("u", each.output)]
        outputs += [(f"after.{c}", x) for c, x in zip(c_names(each.memory), each.memory.values(), strict=True)]
        return each.name, self.written(outputs, called)
