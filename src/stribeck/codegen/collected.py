"""All expressions of a system's code with their derivatives; those that are constant in a run are separated."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from stribeck.expressions.graph import ONE, ZERO, Expr, derivative, ordered, rewrite, substitute, symbol, symbols
from stribeck.expressions.names import Names
from stribeck.machine.equations import Equations


@dataclass
class Collected:
    """The expressions of a system, as lists that are rewritten together.

    Attributes:
        rates: time derivatives of the states.
        by_state, by_time: their derivatives by each state (row by row), and by time.
        watched, watched_by: quantities whose zeros are events, and their derivatives by each state.
        forces, forces_by: friction forces, and their derivatives by each state.
        moved: the energy that changes where a signal jumps; empty if energy is not computed.
        samples: output and stored values of each sampled controller.
        curved: for each watched quantity, whether it is not linear in states and time.
        memory: names of the stored values of each sampled controller.
        called: names of intermediate results.
        as_written: whether the samples keep the order of operations of their equations.
    """

    rates: list[Expr]
    by_state: list[Expr]
    by_time: list[Expr]
    watched: list[Expr]
    watched_by: list[Expr]
    forces: list[Expr]
    forces_by: list[Expr]
    moved: list[Expr]
    samples: list[Expr]
    curved: list[bool]
    memory: list[tuple[str, ...]]
    called: Names
    as_written: bool = False

    @property
    def lists(self) -> list[list[Expr]]:
        """The lists that are rewritten together."""
        samples = [] if self.as_written else [self.samples]
        forces = (self.forces, self.forces_by)
        return [self.rates, self.by_state, self.by_time, self.watched, self.watched_by, *forces, self.moved, *samples]

    @property
    def all_expressions(self) -> list[Expr]:
        """The expressions of all lists."""
        return [node for part in self.lists for node in part]

    def replace(self, flat: Iterable[Expr]) -> None:
        """Replace the expressions of all lists, in the same order."""
        new = iter(flat)
        for part in self.lists:
            part[:] = [next(new) for _ in part]


def collect(system: Equations, as_written: bool = False) -> Collected:
    """All expressions of the system and their derivatives."""
    called = Names()
    rates, names = system.rates(called), [state.name for state in system.states]
    states, t = [symbol(name) for name in names], symbol("t")
    known: list[dict[Expr, Expr]] = [{} for _ in (*states, t)]

    def slopes(expression: Expr) -> list[Expr]:
        uses = symbols([expression])
        return [
            derivative(expression, by, known[i]) if str(by.value) in uses else ZERO for i, by in enumerate((*states, t))
        ]

    rows = [slopes(rate) for rate in rates]
    watched = [watch.value for watch in system.watches(called)]
    of_watched = [slopes(value) for value in watched]
    forces = system.forces(called)
    moving = {*names, "t"}
    samples = system.samples(called)
    moved = system.moved_energy()
    return Collected(
        rates=list(rates),
        by_state=[entry for row in rows for entry in row[:-1]],
        by_time=[row[-1] for row in rows],
        watched=watched,
        watched_by=[entry for row in of_watched for entry in row[:-1]],
        forces=forces,
        forces_by=[entry for force in forces for entry in slopes(force)[:-1]],
        moved=[] if moved is None else [moved],
        samples=[expr for each in samples for expr in (each.output, *each.memory.values())],
        curved=[bool(symbols(row) & moving) for row in of_watched],
        memory=[tuple(each.memory) for each in samples],
        called=called,
        as_written=as_written,
    )


def _constant(node: Expr, parameters: Collection[str], known: dict[Expr, bool]) -> bool:
    for each in () if node in known else ordered([node]):
        if each not in known:
            is_parameter = each.op == "constant" or (each.op == "symbol" and str(each.value) in parameters)
            known[each] = is_parameter or (bool(each.args) and all(known[a] for a in each.args))
    return known[node]


def hoist(
    outputs: list[Expr], parameters: Collection[str], reserved: set[str], called: Names
) -> tuple[list[Expr], dict[str, Expr]]:
    """Hoist coefficients out of the outputs: subexpressions of ``parameters`` alone, and reciprocals of divisors.

    Returns the new outputs, and the coefficients by name, which are computed once a run.

    Args:
        outputs: the expressions.
        parameters: names of the symbols that are constant in a run.
        reserved: names that a coefficient must not have; the new ones are added.
        called: names of intermediate results; rewritten nodes keep theirs.
    """
    known: dict[Expr, bool] = {}

    def multiply(node: Expr) -> Expr:
        if node.op == "mul" and node.args[0].op == "div" and node.args[1].op == "symbol":
            # a state is known from the start: divided first, it does not wait for exp or atan
            (a, b), state = node.args[0].args, node.args[1]
            if not _constant(b, parameters, known) and not _constant(state, parameters, known):
                return a * (state / b)
        if (
            node.op != "div"
            or not _constant(node.args[1], parameters, known)
            or _constant(node.args[0], parameters, known)
        ):
            return node
        product = node.args[0] * (ONE / node.args[1])
        return called.hand_on(node, product) if product.op == "mul" else product

    outputs = rewrite(outputs, multiply, called)
    coefficients: dict[str, Expr] = {}
    replacements: dict[Expr, Expr] = {}
    stack, seen = list(reversed(outputs)), set()
    while stack:
        node = stack.pop()
        if node in seen:
            continue
        seen.add(node)
        trivial = node.op in ("symbol", "constant") or (node.op == "neg" and node.args[0].op == "symbol")
        if trivial:
            continue
        if _constant(node, parameters, known) and node.op not in ("lt", "le", "both", "either"):
            name = called.get(node) or _coefficient_name(node, len(coefficients))
            while name in reserved:
                name += "_"
            reserved.add(name)
            coefficients[name] = node
            replacements[node] = symbol(f"coefficient.{name}")
        else:
            stack.extend(reversed(node.args))
    return substitute(outputs, replacements, called), coefficients


def _coefficient_name(node: Expr, count: int) -> str:
    if node.op == "div" and node.args[0] is ONE and node.args[1].op == "symbol":
        return f"inv_{str(node.args[1].value).split('.')[-1]}"
    return f"c{count}"
