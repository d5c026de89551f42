"""A system's equations as the WebAssembly functions that the runtime imports, straight from the expression graph.

The order of operations is that of the C that codegen/source.py writes, compiled as written. Hence the bits are those of
that C by clang, on every processor.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from stribeck.codegen.source import SystemCode, runtime_text
from stribeck.codegen.webassembly import (
    AGAIN,
    END,
    EQUAL_I32,
    F64,
    I32,
    IF,
    LOOP,
    OPS,
    SUB_I32,
    TO_F64,
    Function,
    call,
    f64,
    get,
    integer,
    load,
    put,
    store,
    tee,
)
from stribeck.expressions.emit import within_loops
from stribeck.expressions.graph import BOUND, ROOT_REACH, ROOT_STEPS, ZERO, Expr, is_zero, ordered, symbols
from stribeck.machine.system import MachineSystem

ADD, SUB, MUL, DIV = (OPS[name] for name in ("add", "sub", "mul", "div"))
STAGES = 8  # of Rodas5P
# From so many states on, each stage calls the rates as a function: Cranelift allots registers badly to eight copies of them.
LARGE = 5
LINE = 64  # bytes: arrays begin on lines of their own
MOST_WATCHED = 64  # length of the arrays in runtime/any.c's struct Shape


@cache
def tables() -> dict[str, list[list[float]]]:
    """The coefficients of the integration method, read from runtime/method.c."""
    text = re.sub(r"/\*.*?\*/", "", runtime_text("method.c"), flags=re.DOTALL)
    numbers: dict[str, list[list[float]]] = {}
    for name in ("GAMMA", "NODE", "TIME", "A", "C", "CARRY_GAMMA", "CARRY"):
        (body,) = re.findall(rf"static const double {name}(?:\[[^=]*)? = ([^;]*);", text)
        rows = re.findall(r"\{([^{}]*)\}", body) or [body]
        numbers[name] = [[float(x) for x in row.split(",")] for row in rows]
    return numbers


class _Code:
    """Writes expressions into a function: a node that is used more than once gets a local.

    Args:
        function: the function.
        where: the code that pushes each symbol.
        runtime: the indices of the runtime's functions.
        strict: compute the same bits on every processor, as sampled controllers need.
    """

    def __init__(
        self, function: Function, where: Mapping[str, bytes], runtime: Mapping[str, int], strict: bool = False
    ) -> None:
        self.f, self.where, self.runtime, self.strict = function, where, runtime, strict
        self.local: dict[Expr, int] = {}

    def value(self, outputs: Sequence[Expr]) -> list[bytes]:
        """The code of each output, to be run in this order."""
        uses = Counter(arg for node in ordered(outputs) for arg in node.args)
        uses.update(outputs)
        return [self._emit(expr, uses) for expr in outputs]

    def _emit(self, output: Expr, uses: Counter[Expr]) -> bytes:
        out: list[bytes] = []
        stack: list[tuple[Expr, bool]] = [(output, False)]
        while stack:
            node, ready = stack.pop()
            if ready:
                out.append(self._operation(node.op))
                if uses[node] > 1:
                    self.local[node] = self.f.local(I32 if node.op in ("lt", "le", "both", "either") else F64)
                    out.append(tee(self.local[node]))
            elif node in self.local:
                out.append(get(self.local[node]))
            elif node.op == "root":
                out.append(self._root(node, uses))
            elif node.op == "constant":
                assert isinstance(node.value, float)
                out.append(f64(node.value))
            elif node.op == "symbol":
                out.append(self.where[str(node.value)])
            else:
                stack.append((node, True))
                args = (node.args[1], node.args[2], node.args[0]) if node.op == "where" else node.args
                stack += [(arg, False) for arg in reversed(args)]
        return b"".join(out)

    def _root(self, node: Expr, uses: Counter[Expr]) -> bytes:
        """The search for a root, as expressions/emit.py writes it: its bracket is halved in the logarithm."""
        falls, start = node.args
        z, reach, tried, count = self.f.local(), self.f.local(), self.f.local(), self.f.local(I32)
        nodes = ordered([falls])
        within = within_loops(nodes)
        invariant = [x for x in nodes if x not in within and x.args and x not in self.local]
        outside = b""
        for each in invariant:  # computed once, before the search
            outside += self._emit(each, Counter())
            self.local[each] = self.f.local(I32 if each.op in ("lt", "le", "both", "either") else F64)
            outside += put(self.local[each])
        code = outside + self._emit(start, uses) + f64(1 / ROOT_REACH) + MUL + put(z)
        code += f64(ROOT_REACH) + put(reach) + integer(ROOT_STEPS) + put(count)
        self.local[BOUND] = tried
        inside = self._emit(falls, uses)
        for each in within:
            self.local.pop(each, None)
        code += LOOP + get(z) + get(reach) + MUL + put(tried)
        code += get(tried) + get(z) + inside + f64(0.0) + OPS["gt"] + OPS["where"] + put(z)
        code += get(reach) + OPS["sqrt"] + put(reach) + get(count) + integer(1) + SUB_I32 + tee(count) + AGAIN + END
        self.local[node] = z
        return code + get(z)

    def _operation(self, op: str) -> bytes:
        if op in OPS:
            return OPS[op]
        if op == "sign":  # (x > 0) - (x < 0)
            x, zero = self.f.local(), f64(0.0)
            return tee(x) + zero + OPS["gt"] + get(x) + zero + OPS["lt"] + SUB_I32 + TO_F64
        name = f"call_same_{op}" if self.strict and f"call_same_{op}" in self.runtime else f"call_{op}"
        return call(self.runtime[name])


@dataclass(frozen=True)
class Added:
    """A further function of a module, which stores its outputs one after the other.

    Args:
        parameters: names of the parameters; the last is a pointer to the outputs.
        kinds: a letter for each parameter: ``i`` for a pointer, ``d`` for a number.
        outputs: the expressions.
        places: for each pointer, the names of the values there, in order.
    """

    parameters: str
    kinds: str
    outputs: Sequence[Expr]
    places: Mapping[str, Sequence[str]]


class Emitted:
    """The functions of a system, and the sizes that the runtime needs.

    Args:
        system: its equations.
        runtime: the indices of the runtime's exported functions.
        rates: the index of the system's function ``rates``.
        begin: the first free address of memory.

    Attributes:
        functions: the functions by the name of their import.
        addresses: the address of each constant, coefficient, rate and Jacobian entry.
        k: the address of the stages' results.
        shape: the runtime's struct Shape (runtime/any.c): numbers of states, signals, outputs, events and forces.
        end: the first address that is free for others.
    """

    def __init__(self, system: MachineSystem, runtime: Mapping[str, int], rates: int, begin: int) -> None:
        self.system, self.runtime, self.rates = system, runtime, rates
        self.code = s = SystemCode(system, False)
        self.n = n = len(s.names)
        self.offset = {
            "piece": {f"segment.{name}": 8 * i for i, name in enumerate((*system.piece_fields, *system.held))},
            "x": {name: 8 * i for i, name in enumerate(s.names)},
            "m": {f"memory.{x}": 8 * i for i, x in enumerate(x for memory in s.memory for x in memory)},
            "dx": {f"change.{i}": 8 * i for i in range(n)},
            "e": {f"error.{i}": 8 * i for i in range(n)},
        }
        fixed = [
            *s.parameter_text, *(f"coefficient.{name}" for name in s.coefficients), *(f"rate.{i}" for i in range(2 * n)),
            *(f"jacobian.{name}" for name in s.jacobian),
        ]  # fmt: skip
        begin = -(-begin // LINE) * LINE
        self.addresses = {name: begin + 8 * i for i, name in enumerate(fixed)}
        self.k = -(-(begin + 8 * len(fixed)) // LINE) * LINE  # the stages
        self.end = self.k + 8 * STAGES * n
        self.functions = {
            "prepare": self._prepare(),
            "rates": self._stored("idii", "piece t x dx", s.rates, "dx"),
            "linearise": self._linearise([*s.rates, *s.by_time, *s.jacobian.values()]),
            "attempt": _Attempt(self).function(),
            "observe": self._observe(),
            "carry": self._carry(),
            "watch": self._stored("idii", "piece t x w", s.watched, "w"),
            "watch_dense": self._stored("ii", "dx dw", s.changes(), "dw"),
            "moved_energy": self._moved_energy(),
            "sample": self._sample(),
            "find_timing": self._find_timing(),
        }
        used = symbols(s.watched)
        watched = [i for i, name in enumerate(s.names) if name in used]
        moved = s.names.index("E_in") if s.moved else -1
        self.shape = [
            n, len(system.piece_fields), len(system.held), len(system.shown), len(s.watched), len(watched),
            sum(s.curved), moved, len(s.forces), self.k, *_padded(watched), *_padded([int(x) for x in s.curved]),
        ]  # fmt: skip

    def added(self, each: Added) -> Function:
        """A further function that the module exports."""
        f, where = Function(each.kinds), dict[str, bytes]()
        names = each.parameters.split()
        for place, name in enumerate(names):
            if name in each.places:
                where |= {key: load(place, 8 * i) for i, key in enumerate(each.places[name])}
            else:
                where[name] = get(place)
        values = self.values(f, where, each.outputs)
        f.code += b"".join(store(len(names) - 1, 8 * i, value) for i, value in enumerate(values))
        return f

    def inputs_of(self, names: str) -> dict[str, bytes]:
        """The code that pushes each input of a function whose parameters have these names."""
        code = {name: load(None, address) for name, address in self.addresses.items()}
        for place, name in enumerate(names.split()):
            if name in self.offset:
                code |= {key: load(place, offset) for key, offset in self.offset[name].items()}
            else:
                code[name] = get(place)
        return code

    def values(
        self, f: Function, where: Mapping[str, bytes], outputs: Sequence[Expr], strict: bool = False
    ) -> list[bytes]:
        """The code of each output, as part of a function."""
        return _Code(f, where, self.runtime, strict).value(outputs)

    def put_factors(self, f: Function, where: dict[str, bytes]) -> None:
        """Compute the factors of the stages' matrix, each in a local, as further inputs."""
        for name, node in self.code.factors.items():
            local = f.local()
            f.code += self.values(f, where, [node])[0] + put(local)
            where[f"factor.{name}"] = get(local)

    def _stored(self, kinds: str, names: str, outputs: Sequence[Expr], to: str) -> Function:
        """A function that stores its outputs one after the other."""
        f, target = Function(kinds), names.split().index(to)
        values = self.values(f, self.inputs_of(names), outputs)
        f.code += b"".join(store(target, 8 * i, value) for i, value in enumerate(values))
        return f

    def _prepare(self) -> Function:
        """Constants and coefficients of a run."""
        f, names = Function("i"), list(self.code.parameter_text)
        f.code += b"".join(store(None, self.addresses[name], load(0, 8 * i)) for i, name in enumerate(names))
        for name, value in zip(self.code.coefficients, self.values(f, self.inputs_of("p"), [*self.code.coefficients.values()]),
                               strict=True):  # fmt: skip
            f.code += store(None, self.addresses[f"coefficient.{name}"], value)
        return f

    def _linearise(self, derivatives: Sequence[Expr]) -> Function:
        f, first = Function("idi"), self.addresses["rate.0"]
        values = self.values(f, self.inputs_of("piece t x"), derivatives)
        f.code += b"".join(store(None, first + 8 * i, value) for i, value in enumerate(values))
        return f

    def _observe(self) -> Function:
        """The friction forces, their errors, and the sizes of the errors' terms, in one array each."""
        names = "e force force_error force_terms"
        f = Function("iiii")
        values = self.values(f, self.inputs_of(names), [node for _, node in self.code.observed])
        for (target, _), value in zip(self.code.observed, values, strict=True):
            array, _, place = target.rstrip("]").partition("[")
            f.code += store(names.split().index(array), 8 * int(place), value)
        return f

    def _carry(self) -> Function:
        """The errors after a time (carry_for() of runtime/stages.c)."""
        f, (gamma,), (of_a, of_b) = Function("di"), tables()["CARRY_GAMMA"][0], tables()["CARRY"][0]
        inv_shift, shift = f.local(), f.local()
        f.code += get(0) + f64(gamma) + MUL + put(inv_shift) + f64(1.0) + get(inv_shift) + DIV + put(shift)
        where = self.inputs_of("h e") | {"shift": get(shift), "inv_shift": get(inv_shift)}
        self.put_factors(f, where)
        right, a, b = ([f.local() for _ in range(self.n)] for _ in range(3))
        where |= {f"right.{name}": get(local) for name, local in zip(self.code.names, right, strict=True)}
        solved = self.values(f, where, self.code.solution)
        for begin, end in ((None, a), (a, b)):
            for i in range(self.n):
                f.code += get(shift) + (load(1, 8 * i) if begin is None else get(begin[i])) + MUL + put(right[i])
            f.code += b"".join(value + put(local) for value, local in zip(solved, end, strict=True))
        for i in range(self.n):
            f.code += store(1, 8 * i, f64(of_a) + get(a[i]) + MUL + f64(of_b) + get(b[i]) + MUL + ADD)
        return f

    def _moved_energy(self) -> Function:
        f = Function("idi", "d")
        f.code += self.values(f, self.inputs_of("piece t x"), self.code.moved or [ZERO])[0]
        return f

    def _sample(self) -> Function:
        """The difference equations of each controller: all new values are computed before one is written."""
        f, begin, m = Function("iididii"), 0, 0
        for which, memory in enumerate(self.code.memory):
            nodes = self.code.samples[begin : begin + 1 + len(memory)]
            begin += len(nodes)
            values = self.values(f, self.inputs_of("which piece t x noise m u"), nodes, strict=True)
            f.code += get(0) + integer(which) + EQUAL_I32 + IF
            new = [f.local() for _ in nodes]
            f.code += b"".join(value + put(local) for local, value in zip(new, values, strict=True))
            f.code += store(6, 0, get(new[0]))
            f.code += b"".join(store(5, 8 * (m + i), get(local)) for i, local in enumerate(new[1:]))
            f.code += END
            m += len(memory)
        return f

    def _find_timing(self) -> Function:
        f, samples = Function("i"), self.system.samples()
        for k, what in enumerate(("period", "delay")):
            for i, each in enumerate(samples):
                value = load(None, self.addresses[f"{each.timing}.{what}"])
                f.code += store(0, 8 * (k * len(samples) + i), value)
        return f


def _padded(numbers: list[int]) -> list[int]:
    return [*numbers, *(MOST_WATCHED * [0])][:MOST_WATCHED]


class _Attempt:
    """All stages of a step as straight-line code (runtime/stages.c), and the squared error over the tolerances.

    Values shared by stages are locals.
    """

    NAMES = "piece t x h x_new atol rtol"

    def __init__(self, emitted: Emitted) -> None:
        self.emitted, self.s, self.n = emitted, emitted.code, emitted.n
        self.f = f = Function("ididiid", "d")
        self.P = {name: i for i, name in enumerate(self.NAMES.split())}
        self.large = self.n >= LARGE
        self.inv_h, self.shift, self.inv_shift, self.time = (f.local() for _ in range(4))
        self.states, self.new, self.right, self.k = ([f.local() for _ in range(self.n)] for _ in range(4))
        self.stages: list[list[int]] = []  # the results of each stage
        self.inputs = emitted.inputs_of(self.NAMES) | {"shift": get(self.shift), "inv_shift": get(self.inv_shift)}

    def function(self) -> Function:
        """The function."""
        f, n, emitted = self.f, self.n, self.emitted
        self._factors()
        self.inputs |= {f"right.{name}": get(self.right[i]) for i, name in enumerate(self.s.names)}
        in_solve = self.emitted.values(f, self.inputs, self.s.solution)
        self.inputs |= {"t": get(self.time)} | {name: get(self.states[i]) for i, name in enumerate(self.s.names)}
        in_rates = [] if self.large else self.emitted.values(f, self.inputs, self.s.rates)
        for stage in range(STAGES):
            self._stage(stage, in_rates)
            f.code += b"".join(value + put(self.k[i]) for i, value in enumerate(in_solve))
            self.stages.append([f.local() for _ in range(n)])  # for later stages; in memory for the runtime
            for i, kept in enumerate(self.stages[-1]):
                f.code += store(None, emitted.k + 8 * (stage * n + i), get(self.k[i]) + tee(kept))
        for i in range(n):
            end = get(self.new[i]) + get(self.k[i]) + ADD + put(self.new[i])
            f.code += end + store(self.P["x_new"], 8 * i, get(self.new[i]))
        self._error()
        return f

    def _factors(self) -> None:
        f, h, gamma = self.f, get(self.P["h"]), tables()["GAMMA"][0][0]
        f.code += f64(1.0) + h + DIV + tee(self.inv_h) + f64(1 / gamma) + MUL + put(self.shift)
        f.code += h + f64(gamma) + MUL + put(self.inv_shift)
        self.emitted.put_factors(f, self.inputs)

    def _terms(self, row: Sequence[float], i: int) -> list[bytes]:
        """The terms of the sum of row[j] k[j] over the stages so far, for state i."""
        return [f64(a) + get(k[i]) + MUL for a, k in zip(row, self.stages, strict=True)]

    def _stage(self, stage: int, in_rates: Sequence[bytes]) -> None:
        """The right-hand side of a stage's linear equations. The last two stages begin where the one before ended."""
        f, n, T, P = self.f, self.n, tables(), self.P
        states, new, k, right = self.states, self.new, self.k, self.right
        if stage == 0:
            f.code += b"".join(load(None, self.emitted.addresses[f"rate.{i}"]) + put(right[i]) for i in range(n))
        else:
            if stage > STAGES - 3:
                f.code += b"".join(get(new[i]) + get(k[i]) + ADD + tee(states[i]) + put(new[i]) for i in range(n))
            else:
                for i in range(n):
                    f.code += load(P["x"], 8 * i) + b"".join(term + ADD for term in self._terms(T["A"][stage], i))
                    f.code += put(states[i])
            if stage == STAGES - 3:
                f.code += b"".join(get(states[i]) + put(new[i]) for i in range(n))
            f.code += get(P["t"]) + f64(T["NODE"][0][stage]) + get(P["h"]) + MUL + ADD + put(self.time)
            f.code += self._called_rates(stage) if self.large else b""
            f.code += b"".join(value + put(right[i]) for i, value in enumerate(in_rates))
            for i in range(n):
                first, *others = self._terms(T["C"][stage], i)
                f.code += get(right[i]) + first + b"".join(term + ADD for term in others)
                f.code += get(self.inv_h) + MUL + ADD + put(right[i])
        for i in range(n):
            if T["TIME"][0][stage] and not is_zero(self.s.by_time[i]):
                by_time = load(None, self.emitted.addresses[f"rate.{n + i}"])
                f.code += (
                    get(right[i]) + f64(T["TIME"][0][stage]) + get(P["h"]) + MUL + by_time + MUL + ADD + put(right[i])
                )

    def _called_rates(self, stage: int) -> bytes:
        """Call the function of the rates; the stage's place in k, and x_new, are free until the stage is solved."""
        n, P, place = self.n, self.P, self.emitted.k + 8 * stage * self.n
        states = b"".join(store(None, place + 8 * i, get(self.states[i])) for i in range(n))
        arguments = get(P["piece"]) + get(self.time) + integer(place) + get(P["x_new"])
        results = b"".join(load(P["x_new"], 8 * i) + put(self.right[i]) for i in range(n))
        return states + arguments + call(self.emitted.rates) + results

    def _error(self) -> None:
        """scaled_square of runtime/method.c."""
        f, P = self.f, self.P
        for i in range(self.n):
            a, b, ratio = self.states[i], self.right[i], self.right[i]
            f.code += load(P["x"], 8 * i) + OPS["abs"] + tee(a) + get(self.new[i]) + OPS["abs"] + tee(b)
            f.code += get(a) + get(b) + OPS["gt"] + OPS["where"] + put(a)
            f.code += get(self.k[i]) + load(P["atol"], 8 * i) + get(P["rtol"]) + get(a) + MUL + ADD + DIV
            f.code += tee(ratio) + get(ratio) + MUL + (ADD if i else b"")
        f.code += f64(1.0 / self.n) + MUL
