"""The C source of a system: its equations, Jacobian and linear algebra as straight lines, then the runtime's solver."""

from __future__ import annotations

import textwrap
import threading
from collections.abc import Iterable, Sequence
from functools import lru_cache
from importlib.resources import files

from stribeck.codegen.elimination import eliminate
from stribeck.codegen.interface import Equations
from stribeck.expressions.emit import C, Writer
from stribeck.expressions.graph import ONE, Expr, derivative, is_zero, ordered, rewrite, substitute, symbol

# Words of C, and names that the generated functions use themselves.
_RESERVED = frozenset(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    p c t x dx piece jac fac shift df_dt exp log sqrt sin cos atan tanh fabs pow
    abs_of sign_of exp_of log_of sqrt_of sin_of cos_of atan_of tanh_of pow_of real mask choose splat any
    N V_STATE LANES BY_LANE EXPORT INFINITY NAN HUGE_VAL M_PI M_E UNUSED unix linux
    """.split()  # noqa: SIM905
)


# Nodes are shared, and so are their labels: the code of a system must not depend on what else there is.
_one_at_a_time = threading.Lock()


@lru_cache(maxsize=64)
def source(system: Equations, lanes: bool = False) -> str:
    """One C file for the system: compile it alone, as a shared library.

    With ``lanes`` it solves several trajectories at once, each in a lane of the widest vectors that it is compiled for.
    """
    with _one_at_a_time:
        return _Source(system, lanes).text()


class _Source:
    def __init__(self, system: Equations, lanes: bool) -> None:
        self.system, self.lanes = system, lanes
        self.names = [state.name for state in system.states]
        self.fields = _unique([name for _, name in system.parameters])
        self.parameter_text = {
            f"{group}.{name}": f"p->{field}"
            for (group, name), field in zip(system.parameters, self.fields, strict=True)
        }
        rates = system.rates()
        n, t = len(rates), symbol("t")
        by_state = [[derivative(rate, symbol(name)) for name in self.names] for rate in rates]
        by_time = [derivative(rate, t) for rate in rates]
        outputs = [*rates, *(entry for row in by_state for entry in row), *by_time]
        for node in ordered(outputs):
            node.label = None
        system.rates()  # sets the labels of this system
        flat = self._hoist(outputs)
        self.rates, self.by_time = flat[:n], flat[n + n * n :]
        self.by_state = [flat[n + i * n : n + (i + 1) * n] for i in range(n)]

    # -- constant subexpressions ---------------------------------------------------------------------------------

    def _constant(self, node: Expr, known: dict[Expr, bool]) -> bool:
        for each in () if node in known else ordered([node]):
            if each not in known:
                is_parameter = each.op == "constant" or (each.op == "symbol" and str(each.value) in self.parameter_text)
                known[each] = is_parameter or (bool(each.args) and all(known[a] for a in each.args))
        return known[node]

    def _hoist(self, outputs: list[Expr]) -> list[Expr]:
        """Subexpressions of constants alone become coefficients, computed once a run; so do reciprocals of divisors."""
        known: dict[Expr, bool] = {}

        def multiply(node: Expr) -> Expr:
            if node.op == "mul" and node.args[0].op == "div" and node.args[1].op == "symbol":
                # a state is there from the start: divided first, it does not wait for exp or atan
                (a, b), state = node.args[0].args, node.args[1]
                if not self._constant(b, known) and not self._constant(state, known):
                    return a * (state / b)
            if node.op != "div" or not self._constant(node.args[1], known) or self._constant(node.args[0], known):
                return node
            product = node.args[0] * (ONE / node.args[1])
            if product.op == "mul" and product.label is None:
                product.label = node.label
            return product

        outputs = rewrite(outputs, multiply)
        self.coefficients: dict[str, Expr] = {}
        found: dict[Expr, Expr] = {}
        taken = set(_RESERVED) | set(self.fields)
        stack, seen = list(reversed(outputs)), set()
        while stack:
            node = stack.pop()
            if node in seen:
                continue
            seen.add(node)
            trivial = node.op in ("symbol", "constant") or (node.op == "neg" and node.args[0].op == "symbol")
            if trivial:
                continue
            if self._constant(node, known) and node.op not in ("lt", "le", "both", "either"):
                name = node.label or _coefficient_name(node, len(self.coefficients))
                while name in taken:
                    name += "_"
                taken.add(name)
                self.coefficients[name] = node
                found[node] = symbol(f"coefficient.{name}")
            else:
                stack.extend(reversed(node.args))
        return substitute(outputs, found)

    # -- the file ------------------------------------------------------------------------------------------------

    def text(self) -> str:
        self.jacobian: dict[str, Expr] = {}
        self.factors: dict[str, Expr] = {}
        matrix = self._matrix()
        right = [symbol(f"right.{name}") for name in self.names]
        solution = eliminate(matrix, self.names, right, self._keep_factor)
        parts = [
            self._head(),
            _runtime("vector.c" if self.lanes else "scalar.c"),
            self._struct("Parameters", self.fields, [f"{owner}.{name}" for owner, name in self.system.parameters]),
            self._struct("Coefficients", list(self.coefficients), None),
            "/* The current straight piece of the signal. */\ntypedef struct { real start, value, slope; } Segment;",
            self._struct("Jacobian", list(self.jacobian), None),
            self._struct("Factors", list(self.factors), None),
            self._function(
                "Constants of a run.", "prepare", "const Parameters *p, Coefficients *c",
                [(f"c->{name}", node) for name, node in self.coefficients.items()],
            ),
            self._function(
                "Time derivatives of the states.", "rates",
                f"{_COMMON}, const Segment *piece, real t, const real *x, real *dx",
                [(f"dx[{i}]", rate) for i, rate in enumerate(self.rates)],
            ),
            self._function(
                "Their derivatives: by the states (the entries that vary) and by time.", "jacobian",
                f"{_COMMON}, const Segment *piece, real t, const real *x, Jacobian *jac, real *df_dt",
                [*((f"jac->{name}", node) for name, node in self.jacobian.items()),
                 *((f"df_dt[{i}]", node) for i, node in enumerate(self.by_time))],
            ),
            self._function(
                "Factors of shift I - J.", "factorise", f"{_COMMON}, const Jacobian *jac, real shift, Factors *fac",
                [(f"fac->{name}", node) for name, node in self.factors.items()],
            ),
            self._function(
                "Solve (shift I - J) k = r.", "solve",
                f"{_COMMON}, const Jacobian *jac, real shift, const Factors *fac, const real *right, real *k",
                [(f"k[{i}]", node) for i, node in enumerate(solution)],
            ),
            _runtime("method.c"),
            _runtime("events.c"),
            _runtime("lanes.c" if self.lanes else "run.c"),
        ]  # fmt: skip
        return "\n\n".join(parts)

    def _matrix(self) -> list[list[Expr]]:
        """a I - J, with the entries of J that vary as symbols."""
        n, a = len(self.names), symbol("shift")
        matrix = []
        for i in range(n):
            row = []
            for k in range(n):
                entry = self.by_state[i][k]
                fixed = entry.op in ("constant", "symbol") and str(entry.value) not in (*self.names, "t")
                fixed = fixed or (
                    entry.op == "neg" and entry.args[0].op == "symbol" and "." in str(entry.args[0].value)
                )
                if not fixed:
                    name = f"{self.names[i]}_{self.names[k]}"
                    self.jacobian[name] = entry
                    entry = symbol(f"jacobian.{name}")
                row.append(a - entry if i == k else -entry)
            matrix.append(row)
        return matrix

    def _keep_factor(self, name: str, entry: Expr) -> Expr:
        cheap = entry.op in ("constant", "symbol") or (entry.op == "neg" and entry.args[0].op in ("constant", "symbol"))
        if cheap or is_zero(entry):
            return entry
        for other, known in self.factors.items():
            if known is entry:
                return symbol(f"factor.{other}")
        self.factors[name] = entry
        return symbol(f"factor.{name}")

    def _head(self) -> str:
        states = "".join(
            f"   x[{i}] = {s.name:<14} {s.unit:<6} {s.meaning}\n" for i, s in enumerate(self.system.states)
        )
        speed = self.names.index("v") if "v" in self.names else -1
        return (
            f"/* Generated by Stribeck: a simulation as straight-line C.\n"
            f"{''.join(f'   {_comment(line)}' + chr(10) for line in self.system.heading)}"
            f"   States, SI units:\n{states}*/\n"
            f"#include <math.h>\n#include <stddef.h>\n#include <stdint.h>\n{PORTABLE}\n"
            f"#define N {len(self.names)} /* states */\n"
            f"#define V_STATE {speed} /* the state that is the velocity, or -1 */"
        )

    def _struct(self, name: str, fields: Sequence[str], comments: Sequence[str] | None) -> str:
        if not fields:
            return f"typedef struct {{ real none; }} {name};"
        if comments is None:
            body = (
                textwrap.fill(", ".join(fields), 100, initial_indent="    real ", subsequent_indent="        ") + ";\n"
            )
        else:
            width = max(map(len, fields))
            body = "".join(
                f"    real {field + ';':<{width + 1}} /* {self._unit(path)} */\n"
                for field, path in zip(fields, comments, strict=True)
            )
        return f"typedef struct {{\n{body}}} {name};"

    def _unit(self, path: str) -> str:
        owner, _, name = path.partition(".")
        constant = self.system.constant(owner, name)
        return _comment(f"{constant.unit or '1'}, {constant.meaning} ({path})")

    def _function(self, what: str, name: str, arguments: str, outputs: list[tuple[str, Expr]]) -> str:
        inputs = {
            **self.parameter_text,
            **{f"coefficient.{n}": f"c->{n}" for n in self.coefficients},
            **{f"segment.{n}": f"piece->{n}" for n in ("start", "value", "slope")},
            **{f"jacobian.{n}": f"jac->{n}" for n in self.jacobian},
            **{f"factor.{n}": f"fac->{n}" for n in self.factors},
            **{f"right.{n}": f"right[{i}]" for i, n in enumerate(self.names)},
            "t": "t", "shift": "shift",
        }  # fmt: skip
        local = dict(zip(self.names, _unique(self.names), strict=True))
        used = {str(node.value) for node in ordered(e for _, e in outputs) if node.op == "symbol"}
        lines = [f"const real {local[n]} = x[{i}];" for i, n in enumerate(self.names) if n in used]
        lines += Writer(C, {**inputs, **local}, taken=_RESERVED).write(outputs)
        body = "".join(f"    {line}\n" for line in lines)
        unused = "".join(f"    (void){word};\n" for word in _argument_names(arguments) if not _mentions(body, word))
        return f"/* {what} */\nstatic inline void {name}({arguments})\n{{\n{unused}{body}}}"


PORTABLE = """\
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
#if defined(__GNUC__)
#define UNUSED __attribute__((unused))
#else
#define UNUSED
#endif
"""
_COMMON = "const Parameters *p, const Coefficients *c"


def _runtime(name: str) -> str:
    return files("stribeck.runtime").joinpath(name).read_text(encoding="utf-8")


def _argument_names(arguments: str) -> list[str]:
    return [argument.replace("*", " ").split()[-1] for argument in arguments.split(",")]


def _mentions(body: str, word: str) -> bool:
    import re

    return re.search(rf"\b{word}\b", body) is not None


def _unique(names: Iterable[str]) -> list[str]:
    """The names as C identifiers, each once."""
    result: list[str] = []
    for name in names:
        field = name if name.isidentifier() and name.isascii() and name not in _RESERVED else f"{name}_"
        while field in result:
            field += "_"
        result.append(field)
    return result


def _coefficient_name(node: Expr, count: int) -> str:
    if node.op == "div" and node.args[0] is ONE and node.args[1].op == "symbol":
        return f"inv_{str(node.args[1].value).split('.')[-1]}"
    return f"c{count}"


def _comment(text: str | None) -> str:
    return " ".join((text or "").split()).replace("*/", "* /")
