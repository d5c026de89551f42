"""The C source of a system: its equations, Jacobian and linear algebra as straight-line code, then the runtime's solver."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import lru_cache
from importlib.resources import files

from stribeck.codegen.collected import collect, hoist
from stribeck.codegen.elimination import eliminate
from stribeck.errors import unbroken
from stribeck.expressions.emit import C_FUNCTIONS, C_WORDS, C, Writer
from stribeck.expressions.graph import ONE, ZERO, Expr, is_zero, ordered, symbol, symbols
from stribeck.expressions.names import Names
from stribeck.machine.system import MachineSystem

# Words of C, and names that the generated functions use themselves.
_RESERVED = (
    C_WORDS
    | C_FUNCTIONS
    | frozenset(
        """
    p c t x dx piece jac fac shift inv_shift df_dt
    abs_of sign_of exp_of log_of sqrt_of sin_of cos_of atan_of tanh_of pow_of real mask choose splat any
    floor_of piece_ w dw m u e force force_error force_terms which noise memory timing sample watch moved_energy
    N FORCES WATCHES WATCHED CURVED PIECE HELD SHOWN MOVED BY_TIME LANES GROUPS BY_LANE EXPORT HUGE_VAL M_PI M_E UNUSED
    """.split()  # noqa: SIM905
    )
)


@lru_cache(maxsize=64)
def source(system: MachineSystem, lanes: bool = False) -> str:
    """One C file for the system: compile it alone, as a shared library.

    With ``lanes`` it solves several trajectories at once, each in a lane of the widest vectors that it is compiled for.
    """
    return SystemCode(system, lanes).text()


def with_columns(system: MachineSystem, columns: Callable[[], dict[str, Expr]]) -> str:
    """The C file of the system for a stand-alone program, with static functions only.

    A further function ``columns`` computes all output columns."""
    code = SystemCode(system, False, PRIVATE)
    text = code.text()
    outputs = [(f"out[{i}]", node) for i, node in enumerate(columns().values())]
    memory = ", const Memory *m" if code.memory else ""
    arguments = f"const Parameters *p, const Segment *piece, real t, const real *x{memory}, real *out"
    return f"{text}\n\n{code.function('Every column of the output.', 'columns', arguments, outputs)}\n"


def parameter_names(system: MachineSystem) -> list[str]:
    """Names of the run-time constants in the generated code, in order."""
    return _unique([system.field(owner, name) for owner, name in system.parameters])


class SystemCode:
    """A system as C: its collected equations, with their names in the code."""

    def __init__(self, system: MachineSystem, lanes: bool, marks: str = "") -> None:
        self.system, self.lanes, self.marks = system, lanes, marks or PORTABLE
        self.names = [state.name for state in system.states]
        self.c_names = _unique(self.names)
        self.fields = parameter_names(system)
        self.parameter_text = {
            f"{group}.{name}": f"p->{field}"
            for (group, name), field in zip(system.parameters, self.fields, strict=True)
        }
        self.called, n = Names(), len(self.names)
        lists, self.curved = collect(system, self.called)
        as_written = {} if lanes else {"samples": lists.pop("samples")}  # the same bits on every processor
        flat, self.coefficients = hoist(
            [node for part in lists.values() for node in part], self.parameter_text.keys(),
            {*_RESERVED, *self.fields}, self.called,
        )  # fmt: skip
        new = iter(flat)
        lists = {name: [next(new) for _ in part] for name, part in lists.items()} | as_written
        self.rates, self.by_time, self.watched = lists["rates"], lists["by_time"], lists["watched"]
        self.forces, self.moved, self.samples = lists["forces"], lists["moved"], lists["samples"]
        self.by_state, self.watched_by, self.forces_by = (
            [lists[name][i : i + n] for i in range(0, len(lists[name]), n)]
            for name in ("by_state", "watched_by", "forces_by")
        )
        self.memory = [tuple(each.memory) for each in system.samples()]
        self.jacobian: dict[str, Expr] = {}
        self.factors: dict[str, Expr] = {}
        rows, self.observed = self._matrix(), self._observed()
        right = [symbol(f"right.{name}") for name in self.names]
        self.solution = eliminate(rows, self.c_names, right, self._keep_factor)

    # -- the file ------------------------------------------------------------------------------------------------

    def text(self) -> str:
        """The whole file."""
        parts = [
            self._head(),
            runtime_text("vector.c" if self.lanes else "scalar.c"),
            *([STRICT + runtime_text("portable.c")] if self.memory and not self.lanes else []),
            self._struct("Parameters", self.fields, [f"{owner}|{name}" for owner, name in self.system.parameters]),
            self._struct("Coefficients", list(self.coefficients), None),
            "/* The current pieces of the signals, and what sampled controllers hold. */\n"
            + self._struct("Segment", [_c_name(n) for n in (*self.system.piece_fields, *self.system.held)], None),
            self._struct("Jacobian", list(self.jacobian), None),
            self._struct("Factors", list(self.factors), None),
            self.function(
                "Constants of a run.", "prepare", "const Parameters *p, Coefficients *c",
                [(f"c->{name}", node) for name, node in self.coefficients.items()],
            ),
            self.function(
                "Time derivatives of the states.", "rates",
                f"{_COMMON}, {_NOW}, real *dx",
                [(f"dx[{i}]", rate) for i, rate in enumerate(self.rates)],
            ),
            self.function(
                "Their derivatives: by the states (the entries that vary) and by time.", "jacobian",
                f"{_COMMON}, {_NOW}, Jacobian *jac, real *df_dt",
                [*((f"jac->{name}", node) for name, node in self.jacobian.items()),
                 *((f"df_dt[{i}]", node) for i, node in enumerate(self.by_time))],
            ),
            self.function(
                "The friction forces, and how much errors of the states change them.", "observe",
                f"{_COMMON}, const Jacobian *jac, const real *e, real *force, real *force_error, real *force_terms",
                self.observed,
            ),
            self.function(
                "Factors of shift I - J.", "factorise",
                f"{_COMMON}, const Jacobian *jac, real shift, real inv_shift, Factors *fac",
                [(f"fac->{name}", node) for name, node in self.factors.items()],
            ),
            self.function(
                "Solve (shift I - J) k = r.", "solve",
                f"{_COMMON}, const Jacobian *jac, real shift, real inv_shift, const Factors *fac, const real *right, real *k",
                [(f"k[{i}]", node) for i, node in enumerate(self.solution)],
            ),
            *self._watching(),
            *self._sampling(),
            *map(runtime_text, ("method.c", "stages.c", "events.c")),
            *map(runtime_text, ("lanes.c", "batch.c") if self.lanes else ("known.c", "run.c")),
        ]  # fmt: skip
        return "\n\n".join(parts)

    def _watching(self) -> list[str]:
        """Functions of events: watched quantities, their change along the dense output, and the energy of signal jumps."""
        parts = []
        if self.watched:
            parts = [
                self.function(
                    "Quantities whose level crossings are events.", "watch", f"{_COMMON}, {_NOW}, real *w",
                    [(f"w[{j}]", node) for j, node in enumerate(self.watched)],
                ),
                self.function(
                    "How it changes with the states, where it does so in proportion.", "watch_dense",
                    f"{_COMMON}, const real *dx, real *dw",
                    [(f"dw[{j}]", change) for j, change in enumerate(self.changes())],
                ),
            ]  # fmt: skip
        if self.moved:
            parts.append(
                self.function(
                    "The energy that changes where a signal jumps.", "moved_energy", f"{_COMMON}, {_NOW}",
                    [("const real moved", self.moved[0])], "return moved;", "real",
                )
            )  # fmt: skip
        return parts

    def _sampling(self) -> list[str]:
        """The difference equations of sampled controllers."""
        if not self.memory:
            return []
        fields = [_c_name(name) for memory in self.memory for name in memory]
        parts = ["/* What sampled controllers remember. */\n" + self._struct("Memory", fields, None)]
        first, samples = 0, self.system.samples()
        names = [sample.name for sample in samples]
        for name, memory in zip(names, self.memory, strict=True):
            nodes = self.samples[first : first + 1 + len(memory)]
            first += len(nodes)
            outputs = [
                ("*u", nodes[0]),
                *((f"m->{_c_name(n)}", node) for n, node in zip(memory, nodes[1:], strict=True)),
            ]
            parts.append(
                self.function(
                    f"Controller {name} at one of its instants: its output, and what it remembers then.",
                    f"sample_{name}", f"{_COMMON}, {_NOW}, real noise, Memory *m, real *u", outputs, late=True,
                    strict=True,
                )
            )  # fmt: skip
        calls = "".join(
            f"    if (which == {i}) sample_{name}(p, c, piece, t, x, noise, m, u);\n" for i, name in enumerate(names)
        )
        times = "".join(
            f"    timing[{k * len(samples) + i}] = {self.parameter_text[f'{sample.timing}.{what}']};\n"
            for i, sample in enumerate(samples) for k, what in enumerate(("period", "delay"))
        )  # fmt: skip
        return [
            *parts,
            f"static void sample(int which, {_COMMON}, {_NOW}, real noise, Memory *m, real *u)\n{{\n{calls}}}",
            "/* When samples are taken, each controller's period; then how much later their outputs act. */\n"
            f"static inline void find_timing(const Parameters *p, real *timing)\n{{\n{times}}}",
        ]

    def changes(self) -> list[Expr]:
        """The change of each watched quantity along the dense output; 0 if it is curved."""
        sums = [sum((entry * symbol(f"change.{i}") for i, entry in enumerate(row)), ZERO) for row in self.watched_by]
        return [ZERO if curved else total for total, curved in zip(sums, self.curved, strict=True)]

    def _matrix(self) -> list[list[Expr]]:
        """a I - J, with the entries of J that vary as symbols."""
        n, a = len(self.names), symbol("shift")
        known = {*self.parameter_text, *(f"coefficient.{name}" for name in self.coefficients)}
        matrix = []
        for i in range(n):
            row = []
            for k in range(n):
                entry = self.by_state[i][k]
                if is_zero(entry):
                    row.append(a if i == k else entry)
                    continue
                plain = entry.args[0] if entry.op == "neg" else entry
                if not (plain.op == "constant" or (plain.op == "symbol" and str(plain.value) in known)):
                    entry = symbol(f"jacobian.{_kept(self.jacobian, f'{self.c_names[i]}_{self.c_names[k]}', entry)}")
                row.append(a - entry if i == k else -entry)
            matrix.append(row)
        return matrix

    def _observed(self) -> list[tuple[str, Expr]]:
        """The friction forces, their first-order change and the size of its terms, from entries that the Jacobian's
        function stores."""
        known = {*self.parameter_text, *(f"coefficient.{name}" for name in self.coefficients)}

        def stored(name: str, entry: Expr) -> Expr:
            return entry if symbols([entry]) <= known else symbol(f"jacobian.{_kept(self.jacobian, name, entry)}")

        entries = [(f"force[{k}]", stored(f"F_{k}", force)) for k, force in enumerate(self.forces)]
        for k, row in enumerate(self.forces_by):
            total = size = ZERO
            for i, entry in enumerate(row):
                if not is_zero(entry):
                    term = stored(f"F_{k}_{self.c_names[i]}", entry) * symbol(f"error.{i}")
                    total, size = total + term, size + abs(term)
            entries += [(f"force_error[{k}]", total), (f"force_terms[{k}]", size)]
        return entries

    def _keep_factor(self, name: str, entry: Expr) -> Expr:
        """Store an entry of the factors and return its symbol; a cheap entry is returned unchanged."""
        cheap = entry.op in ("constant", "symbol") or (entry.op == "neg" and entry.args[0].op in ("constant", "symbol"))
        if cheap or is_zero(entry):
            return entry
        if entry is ONE / symbol("shift"):  # the step's length times a constant: known without a division
            return symbol("inv_shift")
        for other, known in self.factors.items():
            if known is entry:
                return symbol(f"factor.{other}")
        return symbol(f"factor.{_kept(self.factors, name, entry)}")

    def _head(self) -> str:
        states = "".join(
            f"   x[{i}] = {s.name:<14} {s.unit:<6} {s.meaning}\n" for i, s in enumerate(self.system.states)
        )
        used = symbols(self.watched)
        moving = [i for i, name in enumerate(self.names) if name in used]
        tables = ""
        if self.watched:
            curved = ", ".join(str(int(x)) for x in self.curved)
            tables = f"""
static const int WATCHED_STATES[] = {{{", ".join(map(str, moving or [0]))}}}; /* that they depend on */
UNUSED static const int IS_CURVED[] = {{{curved}}}; /* those that are no linear function of states and time */"""
        return (
            f"/* Generated by Stribeck: a simulation as straight-line C.\n"
            f"{''.join(f'   {_comment(line)}' + chr(10) for line in self.system.heading)}"
            f"   States, SI units:\n{states}*/\n"
            f"#include <math.h>\n#include <stddef.h>\n#include <stdint.h>\n{self.marks}\n"
            f"#define N {len(self.names)} /* states */\n"
            f"#define PIECE {len(self.system.piece_fields)} /* numbers of the signals' pieces */\n"
            f"#define HELD {len(self.system.held)} /* outputs of sampled controllers */\n"
            f"#define SHOWN {len(self.system.shown)} /* of what they remember, how much the rows have */\n"
            f"#define FORCES {len(self.forces)} /* friction forces */\n"
            f"#define WATCHES {len(self.watched)} /* quantities whose level crossings are events */\n"
            f"#define WATCHED {len(moving)}\n"
            f"#define CURVED {sum(self.curved)}\n"
            "#define MAY_WATCH (WATCHES > 0)\n#define MAY_CURVE (CURVED > 0)\n#define MAY_HOLD (HELD > 0)\n"
            "#define MAY_SHOW (SHOWN > 0)\n#define MAY_MOVE (MOVED >= 0)\n#define MAY_OBSERVE (FORCES > 0)\n"
            f"static const int BY_TIME[N] = {{{', '.join(str(int(not is_zero(x))) for x in self.by_time)}}};"
            " /* states whose rates depend on time itself */\n"
            f"#define MOVED {self.names.index('E_in') if self.moved else -1} /* the state of the energy put in, or -1 */"
            f"{tables}"
        )

    def _struct(self, name: str, fields: Sequence[str], comments: Sequence[str] | None) -> str:
        if not fields:
            return f"typedef struct {{ real none; }} {name};"
        if comments is None:
            body = "".join(f"    real {field};\n" for field in fields)
        else:
            width = max(map(len, fields))
            body = "".join(
                f"    real {field + ';':<{width + 1}} /* {self._unit(path)} */\n"
                for field, path in zip(fields, comments, strict=True)
            )
        return f"typedef struct {{\n{body}}} {name};"

    def _unit(self, path: str) -> str:
        owner, _, name = path.partition("|")
        constant = self.system.constant(owner, name)
        return _comment(f"{constant.unit or '1'}, {constant.meaning} ({owner}.{name})")

    def function(
        self, what: str, name: str, arguments: str, outputs: list[tuple[str, Expr]], end: str = "", result: str = "void",
        late: bool = False, strict: bool = False,
    ) -> str:  # fmt: skip
        """A C function that computes the outputs.

        Args:
            what: its comment.
            name: its name.
            arguments: its parameters.
            outputs: targets and expressions.
            end: a last statement.
            result: the type of the result.
            late: compute all outputs before one is written, since their places are also inputs.
            strict: compute the same bits on every processor.
        """
        strict = strict and not self.lanes
        dialect = _STRICT_C if strict else C
        inputs = {
            **self.parameter_text,
            **{f"coefficient.{n}": f"c->{n}" for n in self.coefficients},
            **{f"segment.{n}": f"piece->{_c_name(n)}" for n in (*self.system.piece_fields, *self.system.held)},
            **{f"memory.{n}": f"m->{_c_name(n)}" for memory in self.memory for n in memory},
            **{f"change.{i}": f"dx[{i}]" for i in range(len(self.names))},
            **{f"error.{i}": f"e[{i}]" for i in range(len(self.names))},
            **{f"jacobian.{n}": f"jac->{n}" for n in self.jacobian},
            **{f"factor.{n}": f"fac->{n}" for n in self.factors},
            **{f"right.{n}": f"right[{i}]" for i, n in enumerate(self.names)},
            "t": "t", "shift": "shift", "inv_shift": "inv_shift", "noise": "noise",
        }  # fmt: skip
        local = dict(zip(self.names, self.c_names, strict=True))
        used = {str(node.value) for node in ordered(e for _, e in outputs) if node.op == "symbol"}
        loads = [f"const real {local[n]} = x[{i}];" for i, n in enumerate(self.names) if n in used]
        if late:
            locals_ = [(f"const real new_{i}", node) for i, (_, node) in enumerate(outputs)]
            lines = Writer(dialect, {**inputs, **local}, taken=_RESERVED, names=self.called).write(locals_)
            lines += [f"{target} = new_{i};" for i, (target, _) in enumerate(outputs)]
        else:
            lines = Writer(dialect, {**inputs, **local}, taken=_RESERVED, names=self.called).write(outputs)
        lines = [*loads, *lines, *([end] if end else [])]
        body = "".join(f"    {line}\n" for line in [*_unused(arguments, lines), *lines])
        how, first = ("STRICT static", "    STRICT_BODY\n") if strict else ("static inline", "")
        return f"/* {what} */\n{how} {result} {name}({arguments})\n{{\n{first}{body}}}"


_UNUSED = """\
#if defined(__GNUC__)
#define UNUSED __attribute__((unused))
#define NOINLINE __attribute__((noinline))
#else
#define UNUSED
#define NOINLINE
#endif
"""
# How functions are marked: those of a shared library for who calls them; those of a program's file for nobody outside.
PORTABLE = f"""\
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
{_UNUSED}"""
PRIVATE = f"{_UNUSED}#define EXPORT UNUSED static\n"
# Sampled controllers compute the same bits here and on their processor: sums in the order written, no fused operations.
STRICT = """\
#if defined(__clang__) && __clang_major__ >= 18
#define STRICT
#define STRICT_BODY _Pragma("clang fp contract(off) reassociate(off) reciprocal(off)")
#elif defined(__clang__)
#define STRICT
#define STRICT_BODY _Pragma("clang fp contract(off) reassociate(off)")
#elif defined(__GNUC__)
#define STRICT __attribute__((noinline, optimize("no-associative-math,no-reciprocal-math,fp-contract=off")))
#define STRICT_BODY
#else
#define STRICT
#define STRICT_BODY
#endif
"""
SAME = {f"{name}": f"same_{name}" for name in ("exp", "tanh", "atan", "sin", "cos")}  # runtime/portable.c
_STRICT_C = replace(C, functions={**C.functions, **SAME})
_COMMON = "const Parameters *p, const Coefficients *c"
_NOW = "const Segment *piece, real t, const real *x"


def runtime_text(name: str) -> str:
    """A file of ``runtime/``: the code that is the same for every system."""
    return files("stribeck.codegen.runtime").joinpath(name).read_text(encoding="utf-8")


def _kept(entries: dict[str, Expr], name: str, entry: Expr) -> str:
    """Keep an entry under a name that is free; the name."""
    while name in entries:
        name += "_"
    entries[name] = entry
    return name


def _c_name(name: str) -> str:
    name = name.replace(".", "_")
    return f"n{name}" if name[:1].isdigit() else name


def _unique(names: Iterable[str]) -> list[str]:
    """The names as C identifiers, each once."""
    result: list[str] = []
    for name in map(_c_name, names):
        field = name if name.isidentifier() and name.isascii() and name not in _RESERVED else f"{name}_"
        while field in result:
            field += "_"
        result.append(field)
    return result


def _unused(arguments: str, body: Sequence[str]) -> list[str]:
    """Statements that mention those parameters of a function which its body does not."""
    words = {word for line in body for word in re.findall(r"(?<![\w>.])[A-Za-z_]\w*", line)}
    names = [argument.replace("*", " ").split()[-1] for argument in arguments.split(",")]
    return [f"(void){name};" for name in names if name not in words]


def _comment(text: str) -> str:
    return unbroken(text).replace("*/", "* /")
