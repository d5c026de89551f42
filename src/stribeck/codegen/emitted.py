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

from stribeck.codegen.elimination import eliminate
from stribeck.codegen.source import SystemCode, runtime_text
from stribeck.codegen.webassembly import (
    AGAIN,
    END,
    EQUAL_I32,
    F64,
    I32,
    IF,
    LOOP,
    NOT_I32,
    OPS,
    SPLAT,
    SUB_I32,
    TO_F64,
    V128,
    V_ADD,
    V_MUL,
    Function,
    call,
    extract,
    f64,
    get,
    integer,
    load,
    put,
    replace_second,
    store,
    tee,
    v_load,
    v_number,
    v_store,
)
from stribeck.expressions.emit import within_loops
from stribeck.expressions.graph import (
    BOUND,
    ROOT_REACH,
    ROOT_STEPS,
    ZERO,
    Expr,
    is_zero,
    ordered,
    symbol,
    symbols,
)
from stribeck.machine.equations import Equations

ADD, SUB, MUL, DIV = (OPS[name] for name in ("add", "sub", "mul", "div"))
STAGES = 8
# From so many states on, each stage calls the rates as a function, and the sums over stages are computed for two states
# at once. Cranelift allots registers badly to eight copies of the rates. For fewer states, pairs cost 1 to 8 %.
LARGE = 5
LINE = 64  # bytes: arrays begin on lines of their own
MOST_WATCHED = 64  # length of the arrays in runtime/any.c's struct Shape


@cache
def tables() -> dict[str, list[list[float]]]:
    """The coefficients of the integration method, read from runtime/method.c."""
    text = re.sub(r"/\*.*?\*/", "", runtime_text("method.c"), flags=re.DOTALL)
    numbers: dict[str, list[list[float]]] = {}
    for name in ("GAMMA", "NODE", "TIME", "A", "C", "DENSE", "CARRY_GAMMA", "CARRY"):
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
        calls: the names of called functions are added to this set.
        strict: compute the same bits on every processor, as sampled controllers need.
    """

    def __init__(
        self, function: Function, where: Mapping[str, bytes], runtime: Mapping[str, int], calls: set[str],
        strict: bool = False,
    ) -> None:  # fmt: skip
        self.f, self.where, self.runtime, self.calls, self.strict = function, where, runtime, calls, strict
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
        self.calls.add(name)
        return call(self.runtime[name])


class _Single:
    """A state whose sums over stages are computed alone."""

    add, mul = ADD, MUL

    def __init__(self, f: Function, i: int) -> None:
        self.f, self.i, self.stages = f, i, list[int]()  # locals with the stages' results

    def number(self, x: float) -> bytes:
        return f64(x)

    def splat(self, x: bytes) -> bytes:
        """A scalar in each lane."""
        return x

    def load(self, pointer: int) -> bytes:
        return load(pointer, 8 * self.i)

    def pack(self, locals_: Sequence[int]) -> bytes:
        """Push the value of the state."""
        return get(locals_[self.i])

    def unpack(self, locals_: Sequence[int]) -> bytes:
        """Pop a value into the local of the state."""
        return put(locals_[self.i])

    def terms(self, row: Sequence[float], onto: bool) -> bytes:
        """Push the sum of row[j] k[j]; ``onto``: add it to the top of the stack."""
        return b"".join(
            self.number(a) + get(k) + self.mul + (self.add if onto or j else b"")
            for j, (a, k) in enumerate(zip(row, self.stages, strict=True))
        )

    def keep(self, pointer: int | None, offset: int, k: Sequence[int]) -> bytes:
        """Store a stage's result in a local for later stages, and in memory for the runtime."""
        self.stages.append(self.f.local())
        return store(pointer, offset + 8 * self.i, self.pack(k) + tee(self.stages[-1]))


class _Pair(_Single):
    """Two states whose sums over stages are computed as one vector.

    Each local is a vector, since loading two halves that were stored as one vector stalls the processor.
    """

    add, mul = V_ADD, V_MUL

    def __init__(self, f: Function, i: int) -> None:
        super().__init__(f, i)
        self.both = f.local(V128)

    def number(self, x: float) -> bytes:
        return v_number(x)

    def splat(self, x: bytes) -> bytes:
        return x + SPLAT

    def load(self, pointer: int) -> bytes:
        return v_load(pointer, 8 * self.i)

    def pack(self, locals_: Sequence[int]) -> bytes:
        return get(locals_[self.i]) + SPLAT + get(locals_[self.i + 1]) + replace_second()

    def unpack(self, locals_: Sequence[int]) -> bytes:
        first, second = extract(0) + put(locals_[self.i]), extract(1) + put(locals_[self.i + 1])
        return tee(self.both) + first + get(self.both) + second

    def keep(self, pointer: int | None, offset: int, k: Sequence[int]) -> bytes:
        self.stages.append(self.f.local(V128))
        return v_store(pointer, offset + 8 * self.i, self.pack(k) + tee(self.stages[-1]))


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
        calls: the runtime's functions that they call.
        addresses: the address of each constant, coefficient, rate and Jacobian entry.
        k: the address of the stages' results.
        shape: the runtime's struct Shape (runtime/any.c): numbers of states, signals, outputs, events and forces.
        end: the first address that is free for others.
    """

    def __init__(self, system: Equations, runtime: Mapping[str, int], rates: int, begin: int) -> None:
        self.system, self.runtime, self.rates = system, runtime, rates
        self.code = s = SystemCode(system, False)
        s.jacobian, s.factors = {}, {}
        right = [symbol(f"right.{name}") for name in s.names]
        rows, observed = s.matrix(), s.observed()
        solution = eliminate(rows, s.c_names, right, s.keep_factor)
        self.n = n = len(s.names)
        self.calls: set[str] = set()
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
            "attempt": _Attempt(self, solution).function(),
            "observe": self._observe(observed),
            "carry": self._carry(solution),
            "dense": self._dense(),
            "within": self._within(),
            "may_cross": _MayCross(self).function(),
            "watch": self._stored("idii", "piece t x w", s.watched, "w"),
            "watch_dense": self._stored("ii", "dx dw", self.changes(), "dw"),
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
        return _Code(f, where, self.runtime, self.calls, strict).value(outputs)

    def changes(self) -> list[Expr]:
        """The change of each watched quantity along the dense output; 0 if it is curved."""
        sums = []
        for j, row in enumerate(self.code.watched_by):
            total = ZERO
            for i, entry in enumerate(row):
                total = total + entry * symbol(f"change.{i}")
            sums.append(ZERO if self.code.curved[j] else total)
        return sums

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

    def _observe(self, observed: Sequence[tuple[str, Expr]]) -> Function:
        """The friction forces, their errors, and the sizes of the errors' terms, in one array each."""
        names = "e force force_error force_terms"
        f = Function("iiii")
        values = self.values(f, self.inputs_of(names), [node for _, node in observed])
        for (target, _), value in zip(observed, values, strict=True):
            array, _, place = target.rstrip("]").partition("[")
            f.code += store(names.split().index(array), 8 * int(place), value)
        return f

    def _carry(self, solution: Sequence[Expr]) -> Function:
        """The errors after a time (carry_for() of runtime/stages.c)."""
        f, (gamma,), (of_a, of_b) = Function("di"), tables()["CARRY_GAMMA"][0], tables()["CARRY"][0]
        inv_shift, shift = f.local(), f.local()
        f.code += get(0) + f64(gamma) + MUL + put(inv_shift) + f64(1.0) + get(inv_shift) + DIV + put(shift)
        where = self.inputs_of("h e") | {"shift": get(shift), "inv_shift": get(inv_shift)}
        for name, node in self.code.factors.items():
            local = f.local()
            f.code += self.values(f, where, [node])[0] + put(local)
            where[f"factor.{name}"] = get(local)
        right, a, b = ([f.local() for _ in range(self.n)] for _ in range(3))
        where |= {f"right.{name}": get(local) for name, local in zip(self.code.names, right, strict=True)}
        solved = self.values(f, where, solution)
        for begin, end in ((None, a), (a, b)):
            for i in range(self.n):
                f.code += get(shift) + (load(1, 8 * i) if begin is None else get(begin[i])) + MUL + put(right[i])
            f.code += b"".join(value + put(local) for value, local in zip(solved, end, strict=True))
        for i in range(self.n):
            f.code += store(1, 8 * i, f64(of_a) + get(a[i]) + MUL + f64(of_b) + get(b[i]) + MUL + ADD)
        return f

    def _dense(self) -> Function:
        """The dense output's three coefficients of each state."""
        f = Function("i")
        for i in range(self.n):
            f.code += b"".join(store(0, 8 * (3 * i + m), self.dense_coefficient(i, m)) for m in range(3))
        return f

    def dense_coefficient(self, i: int, m: int) -> bytes:
        """dense() of runtime/method.c."""
        return b"".join(
            f64(factor) + load(None, self.k + 8 * (stage * self.n + i)) + MUL + (ADD if stage else b"")
            for stage, factor in enumerate(tables()["DENSE"][m])
        )

    def _within(self) -> Function:
        """The states after a share of a step: interpolate() of runtime/method.c."""
        f = Function("diiii")
        s, rest = get(0), f.local()
        f.code += f64(1.0) + s + SUB + put(rest)
        for i in range(self.n):
            d0, d1, d2 = (load(3, 8 * (3 * i + m)) for m in range(3))
            bent = get(rest) + d0 + s + d1 + s + d2 + MUL + ADD + MUL + ADD + MUL
            value = get(rest) + load(1, 8 * i) + MUL + s + load(2, 8 * i) + bent + ADD + MUL + ADD
            f.code += store(4, 8 * i, value)
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

    def __init__(self, emitted: Emitted, solution: Sequence[Expr]) -> None:
        self.emitted, self.s, self.n = emitted, emitted.code, emitted.n
        self.f = f = Function("ididiid", "d")
        self.P = {name: i for i, name in enumerate(self.NAMES.split())}
        self.large = self.n >= LARGE
        self.inv_h, self.shift, self.inv_shift, self.time = (f.local() for _ in range(4))
        self.states, self.new, self.right, self.k = ([f.local() for _ in range(self.n)] for _ in range(4))
        self.inputs = emitted.inputs_of(self.NAMES) | {"shift": get(self.shift), "inv_shift": get(self.inv_shift)}
        self.solution = solution

    def function(self) -> Function:
        """The function."""
        f, n, emitted = self.f, self.n, self.emitted
        self._factors()
        self.inputs |= {f"right.{name}": get(self.right[i]) for i, name in enumerate(self.s.names)}
        in_solve = self.emitted.values(f, self.inputs, self.solution)
        self.inputs |= {"t": get(self.time)} | {name: get(self.states[i]) for i, name in enumerate(self.s.names)}
        in_rates = [] if self.large else self.emitted.values(f, self.inputs, self.s.rates)
        paired = n - n % 2 if self.large else 0
        sums = [_Pair(f, i) for i in range(0, paired, 2)] + [_Single(f, i) for i in range(paired, n)]
        for stage in range(STAGES):
            self._stage(stage, sums, in_rates)
            f.code += b"".join(value + put(self.k[i]) for i, value in enumerate(in_solve))
            f.code += b"".join(each.keep(None, emitted.k + 8 * stage * n, self.k) for each in sums)
        for i in range(n):
            end = get(self.new[i]) + get(self.k[i]) + ADD + put(self.new[i])
            f.code += end + store(self.P["x_new"], 8 * i, get(self.new[i]))
        self._error()
        return f

    def _factors(self) -> None:
        f, h, gamma = self.f, get(self.P["h"]), tables()["GAMMA"][0][0]
        f.code += f64(1.0) + h + DIV + tee(self.inv_h) + f64(1 / gamma) + MUL + put(self.shift)
        f.code += h + f64(gamma) + MUL + put(self.inv_shift)
        for name, node in self.s.factors.items():
            local = f.local()
            f.code += self.emitted.values(f, self.inputs, [node])[0] + put(local)
            self.inputs[f"factor.{name}"] = get(local)

    def _stage(self, stage: int, sums: Sequence[_Single], in_rates: Sequence[bytes]) -> None:
        """The right-hand side of a stage's linear equations. The last two stages begin where the one before ended."""
        f, n, T, P = self.f, self.n, tables(), self.P
        states, new, k, right = self.states, self.new, self.k, self.right
        if stage == 0:
            f.code += b"".join(load(None, self.emitted.addresses[f"rate.{i}"]) + put(right[i]) for i in range(n))
        else:
            if stage > STAGES - 3:
                f.code += b"".join(get(new[i]) + get(k[i]) + ADD + tee(states[i]) + put(new[i]) for i in range(n))
            else:
                f.code += b"".join(
                    each.load(P["x"]) + each.terms(T["A"][stage][:stage], onto=True) + each.unpack(states)
                    for each in sums
                )
            if stage == STAGES - 3:
                f.code += b"".join(get(states[i]) + put(new[i]) for i in range(n))
            f.code += get(P["t"]) + f64(T["NODE"][0][stage]) + get(P["h"]) + MUL + ADD + put(self.time)
            f.code += self._called_rates(stage) if self.large else b""
            f.code += b"".join(value + put(right[i]) for i, value in enumerate(in_rates))
            for each in sums:
                f.code += each.pack(right) + each.terms(T["C"][stage][:stage], onto=False)
                f.code += each.splat(get(self.inv_h)) + each.mul + each.add + each.unpack(right)
        for i in range(n):
            if T["TIME"][0][stage] and not is_zero(self.s.by_time[i]):
                change = (
                    f64(T["TIME"][0][stage])
                    + get(P["h"])
                    + MUL
                    + load(None, self.emitted.addresses[f"rate.{n + i}"])
                    + MUL
                )
                f.code += get(right[i]) + change + ADD + put(right[i])

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


class _MayCross:
    """Whether a watched quantity may pass its threshold in a step, by bounding Bernstein coefficients (runtime/events.c).

    Only then is the crossing searched.
    """

    NAMES = "piece t x h x_new thresholds"
    # The coefficients of the quartic through five values at equal distances: bernstein_of_values of runtime/events.c.
    OF_VALUES = (((-13, 48, -36, 16, -3), 12), ((13, -64, 120, -64, 13), 18), ((-3, 16, -36, 48, -13), 12))

    def __init__(self, emitted: Emitted) -> None:
        self.emitted, self.s, self.n = emitted, emitted.code, emitted.n
        self.f = Function("ididii", "i")
        self.P = {name: i for i, name in enumerate(self.NAMES.split())}
        self.before = emitted.inputs_of(self.NAMES)

    def function(self) -> Function:
        """The function."""
        s, f, P = self.s, self.f, self.P
        after = self._inputs_after(1.0, {name: load(P["x_new"], 8 * i) for i, name in enumerate(s.names)})
        change = self._dense()
        inside = [self._inside(share, change) for share in (0.25, 0.5, 0.75)] if any(s.curved) else []
        f.code += integer(0)
        for j, (value, bent) in enumerate(zip(s.watched, self.emitted.changes(), strict=True)):
            v0, v1 = self._run(self.before, value), self._run(after, value)
            if s.curved[j]:
                coefficients = self._of_values([v0, *(self._run(where, value) for where in inside), v1])
            else:
                coefficients = self._of_dense(v0, v1, [self._run(change[m], bent) for m in range(3)])
            self._compare(j, v0, [*coefficients, v1])
        return f

    def _run(self, where: Mapping[str, bytes], node: Expr) -> bytes:
        local = self.f.local()
        self.f.code += self.emitted.values(self.f, where, [node])[0] + put(local)
        return get(local)

    def _inputs_after(self, share: float, states: dict[str, bytes]) -> dict[str, bytes]:
        """The inputs after a share of the step."""
        local, h = self.f.local(), get(self.P["h"])
        self.f.code += get(self.P["t"]) + (h if share == 1 else f64(share) + h + MUL) + ADD + put(local)
        return {**self.before, "t": get(local), **states}

    def _dense(self) -> list[dict[str, bytes]]:
        """The dense output's three coefficients of each state that events depend on."""
        used = symbols(self.s.watched)
        change: list[dict[str, bytes]] = [dict(self.before) for _ in range(3)]
        for i, name in enumerate(self.s.names):
            for m in range(3):
                change[m][f"change.{i}"] = f64(0.0)
                if name in used:
                    local = self.f.local()
                    self.f.code += self.emitted.dense_coefficient(i, m) + put(local)
                    change[m][f"change.{i}"] = get(local)
        return change

    def _inside(self, share: float, change: list[dict[str, bytes]]) -> dict[str, bytes]:
        """The inputs within the step: interpolate() of runtime/method.c."""
        used, states = symbols(self.s.watched), dict[str, bytes]()
        for i, name in enumerate(self.s.names):
            if name in used:
                d0, d1, d2 = (change[m][f"change.{i}"] for m in range(3))
                rest, local = f64(1 - share), self.f.local()
                bent = rest + d0 + f64(share) + d1 + f64(share) + d2 + MUL + ADD + MUL + ADD + MUL
                x0, x1 = load(self.P["x"], 8 * i), load(self.P["x_new"], 8 * i)
                self.f.code += rest + x0 + MUL + f64(share) + x1 + bent + ADD + MUL + ADD + put(local)
                states[name] = get(local)
        return self._inputs_after(share, states)

    def _of_values(self, v: Sequence[bytes]) -> list[bytes]:
        return [
            b"".join(f64(a) + x + MUL + (ADD if m else b"") for m, (a, x) in enumerate(zip(row, v, strict=True)))
            + f64(by) + DIV
            for row, by in self.OF_VALUES
        ]  # fmt: skip

    def _of_dense(self, v0: bytes, v1: bytes, d: Sequence[bytes]) -> list[bytes]:
        """bernstein_of_dense of runtime/events.c."""
        rise, (d0, d1, d2) = v1 + v0 + SUB, d
        return [
            v0 + f64(0.25) + rise + MUL + ADD + f64(0.25) + d0 + MUL + ADD,
            f64(0.5) + v0 + v1 + ADD + MUL + d0 + f64(3.0) + DIV + ADD + d1 + f64(6.0) + DIV + ADD,
            v0 + f64(0.75) + rise + MUL + ADD + f64(0.25) + d0 + d1 + ADD + d2 + ADD + MUL + ADD,
        ]

    def _compare(self, j: int, v0: bytes, coefficients: Sequence[bytes]) -> None:
        """Combine the top of the stack (or) with whether the coefficients allow a crossing."""
        b, low, high, limit = (self.f.local() for _ in range(4))
        code = v0 + tee(low) + put(high)
        for coefficient in coefficients:
            code += coefficient + tee(b) + get(low) + OPS["min"] + put(low)
            code += get(b) + get(high) + OPS["max"] + put(high)
        code += load(self.P["thresholds"], 8 * j) + put(limit)
        minus = get(limit) + OPS["neg"]
        within = get(low) + minus + OPS["gt"] + get(high) + get(limit) + OPS["lt"] + OPS["both"]
        beyond = get(low) + get(limit) + OPS["ge"] + get(high) + minus + OPS["le"] + OPS["either"]
        off = get(limit) + f64(0.0) + OPS["gt"] + NOT_I32
        self.f.code += code + within + beyond + OPS["either"] + off + OPS["either"] + NOT_I32 + OPS["either"]
