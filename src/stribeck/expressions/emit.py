"""Expressions as straight-line code: C for the simulator and the exports, Python for evaluation."""

from __future__ import annotations

import builtins
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from stribeck.expressions import ops
from stribeck.expressions.graph import BOUND, ROOT_REACH, ROOT_STEPS, ZERO, Expr, constant, ordered
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value

ATOM, UNARY, MUL, ADD, COMPARE, AND, OR, TERNARY = range(8)
# Operations in one statement: about a line of 110 letters with the names of the built-in laws. Counted, not measured as
# text: the length of names must not change bits.
_MOST_OPERATIONS = 8


RETURN = "return"  # a target: the value is returned


@dataclass(frozen=True)
class Dialect:
    """The syntax in which the languages differ."""

    declare: str
    functions: Mapping[str, str]
    both: str
    either: str
    where: str
    statement_end: str
    where_precedence: int = TERNARY
    value: str = "{0}"  # a number that is no operand of an operator
    variable: str = ""  # declares a variable that is assigned more than once
    loop: tuple[str, str] = ("while ({reach} > 1) {{", "}")  # ends after ROOT_STEPS square roots of ROOT_REACH


# What no variable, member or constant can be called in C: its words, what its headers define, and two macros of compilers.
C_WORDS = frozenset(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    INFINITY NAN unix linux
    """.split()  # noqa: SIM905
)
C_FUNCTIONS = frozenset({"exp", "log", "sqrt", "sin", "cos", "atan", "tanh", "fabs", "pow"})

# ``real`` is a number, or a vector of numbers for several trajectories: runtime/scalar.c, runtime/vector.c.
_FUNCTIONS = ("abs", "sign", "exp", "log", "sqrt", "sin", "cos", "atan", "tanh", "pow", "floor")
C = Dialect(
    declare="const real ",
    functions={name: f"{name}_of" for name in _FUNCTIONS},
    both="&",
    either="|",
    where="choose({0}, {1}, {2})",
    statement_end=";",
    where_precedence=ATOM,
    value="splat({0})",
    variable="real ",
    loop=(f"for (int {{count}} = 0; {{count}} < {ROOT_STEPS}; {{count}}++) {{{{", "}"),
)
PYTHON = Dialect(
    declare="", functions={}, both="", either="", where="where({0}, {1}, {2})", statement_end="", where_precedence=ATOM,
    loop=("while {reach} > 1:", ""),
)  # fmt: skip


def within_loops(nodes: Sequence[Expr]) -> set[Expr]:
    """Of nodes in order, those that change during the search for a root."""
    changing = {BOUND}
    for node in nodes:
        if node.op != "root" and any(arg in changing for arg in node.args):
            changing.add(node)
    return changing


def _literal(x: float) -> str:
    if x != x:
        return "NAN"
    return "INFINITY" if x == float("inf") else "-INFINITY" if x == float("-inf") else repr(x)


class Writer:
    """Writes statements that compute outputs.

    A node becomes a variable if it is used more than once, has a name in ``names``, or consists of many operations. All
    others are written where they are used.
    """

    def __init__(
        self, dialect: Dialect, inputs: Mapping[str, str], taken: Iterable[str] = (), names: Names | None = None
    ) -> None:
        self.dialect, self.inputs, self.names = dialect, inputs, Names() if names is None else names
        self.taken = set(taken) | {text for text in inputs.values() if text.isidentifier()}
        self.lines: list[str] = []
        self._text: dict[Expr, tuple[str, int]] = {}
        self._size: dict[Expr, int] = {}  # operations in the text

    def write(self, outputs: Sequence[tuple[str, Expr]]) -> list[str]:
        """The statements that assign each output expression to its target, or return it, in order."""
        self.taken.update(target for target, _ in outputs)
        nodes = ordered(expr for _, expr in outputs)
        uses = Counter(arg for node in nodes for arg in node.args)
        uses.update(expr for _, expr in outputs)
        within = within_loops(nodes)
        for target, expr in outputs:
            for node in ordered([expr], self._text):
                if node.op == "root":
                    self._text[node] = self._loop(node, uses, within)
                elif node not in within:
                    self._text[node] = self._statement(node, uses[node])
            how = target if target == RETURN else f"{target} ="
            self.lines.append(f"{how} {self._value(expr, TERNARY)}{self.dialect.statement_end}")
        return self.lines

    def _statement(self, node: Expr, uses: int) -> tuple[str, int]:
        text, precedence = self._format(node)
        size = self._size[node] = (1 if node.args else 0) + sum(self._size[arg] for arg in node.args)
        if node.op in ("symbol", "constant", "lt", "le", "both", "either"):
            return text, precedence
        called = self.names.get(node)
        if uses == 1 and called is None and size <= _MOST_OPERATIONS:
            return text, precedence
        self._size[node] = 0
        name = self._name(called)
        self.lines.append(f"{self.dialect.declare}{name} = {text}{self.dialect.statement_end}")
        return name, ATOM

    def _loop(self, node: Expr, uses: Counter[Expr], within: set[Expr]) -> tuple[str, int]:
        """The search for a root: z and the reach of the bracket above it, halved in the logarithm."""
        falls, start = node.args
        z, reach, tried = (self._name(name) for name in (self.names.get(node) or "z", "reach", "tried"))
        d, end = self.dialect, self.dialect.statement_end
        lowest = self._format(constant(1 / ROOT_REACH))[0]
        self.lines.append(f"{d.variable}{z} = {self._arg(start, MUL)} * {lowest}{end}")
        self.lines.append(f"{d.variable}{reach} = {d.value.format(self._format(constant(ROOT_REACH))[0])}{end}")
        self.lines.append(d.loop[0].format(reach=reach, count=f"{reach}_i"))
        outside, first = dict(self._text), len(self.lines)
        self.lines.append(f"{d.declare}{tried} = {z} * {reach}{end}")
        self._text[BOUND], self._size[BOUND] = (tried, ATOM), 0
        for inner in ordered([falls]):
            if inner in within and inner is not BOUND:
                self._text[inner] = self._statement(inner, uses[inner])
        zero = self._format(ZERO)[0]
        chosen = d.where.format(f"{self._arg(falls, ADD)} > {zero}", tried, z)
        self.lines.append(f"{z} = {chosen}{end}")
        self.lines.append(f"{reach} = {d.functions.get('sqrt', 'sqrt')}({reach}){end}")
        self.lines[first:] = [f"    {line}" for line in self.lines[first:]]
        self.lines += [d.loop[1]] if d.loop[1] else []
        self._text = outside
        self._size[node] = 0
        return z, ATOM

    def _name(self, label: str | None) -> str:
        base = label or "t"
        base = f"n{base}" if base[:1].isdigit() else base  # of an element whose name begins with a digit
        name, count = base, 1
        while name in self.taken or (label is None and name == "t"):
            name, count = f"{base}{count}" if label is None else f"{base}_{count + 1}", count + 1
        self.taken.add(name)
        return name

    def _arg(self, node: Expr, limit: int) -> str:
        text, precedence = self._text[node]
        return text if precedence <= limit else f"({text})"

    def _value(self, node: Expr, limit: int) -> str:
        text = self._arg(node, limit)
        return self.dialect.value.format(text) if node.op == "constant" else text

    def _format(self, node: Expr) -> tuple[str, int]:
        op, args = node.op, node.args
        if op == "symbol":
            return self.inputs[str(node.value)], ATOM
        if op == "constant":
            assert isinstance(node.value, float)
            return _literal(node.value), ATOM if node.value >= 0 else UNARY
        if op in ("add", "sub"):
            return f"{self._arg(args[0], ADD)} {'+' if op == 'add' else '-'} {self._arg(args[1], MUL)}", ADD
        if op in ("mul", "div"):
            return f"{self._arg(args[0], MUL)} {'*' if op == 'mul' else '/'} {self._arg(args[1], UNARY)}", MUL
        if op == "neg":
            return f"-{self._arg(args[0], ATOM)}", UNARY
        if op in ("lt", "le"):
            return f"{self._arg(args[0], ADD)} {'<' if op == 'lt' else '<='} {self._arg(args[1], ADD)}", COMPARE
        if op in ("both", "either"):
            sign = getattr(self.dialect, op)
            if not sign:
                return f"{op}({self._arg(args[0], OR)}, {self._arg(args[1], OR)})", ATOM
            level = AND if op == "both" else OR
            return f"{self._arg(args[0], ATOM)} {sign} {self._arg(args[1], ATOM)}", level
        if op == "where":
            texts = (self._arg(args[0], OR), self._value(args[1], ADD), self._value(args[2], ADD))
            return self.dialect.where.format(*texts), self.dialect.where_precedence
        name = self.dialect.functions.get(op, op)
        return f"{name}({', '.join(self._value(a, TERNARY) for a in args)})", ATOM


def python_function(inputs: Sequence[str], outputs: Sequence[Expr]) -> Callable[..., tuple[Value, ...]]:
    """A Python function of the named inputs that returns the outputs; works on numbers and arrays.

    The names of the inputs may contain dots; arguments are positional.
    """
    arguments = [f"a{i}" for i in range(len(inputs))]
    writer = Writer(PYTHON, dict(zip(inputs, arguments, strict=True)), taken=(*dir(ops), *dir(builtins)))
    lines = writer.write([(f"r{i}", expr) for i, expr in enumerate(outputs)])
    results = "".join(f"r{i}, " for i in range(len(outputs)))
    source = f"def f({', '.join(arguments)}):\n" + "".join(f"    {line}\n" for line in [*lines, f"return ({results})"])
    names = {name: getattr(ops, name) for name in ("exp", "log", "sqrt", "sin", "cos", "atan", "tanh", "sign", "floor")}
    scope: dict[str, Value] = {
        **names, "where": ops.where, "both": ops.both, "either": ops.either, "abs": abs, "pow": pow,
        "INFINITY": float("inf"), "NAN": float("nan"),
    }  # fmt: skip
    exec(compile(source, "<stribeck equations>", "exec"), scope)
    function: Callable[..., tuple[Value, ...]] = scope["f"]
    return function
