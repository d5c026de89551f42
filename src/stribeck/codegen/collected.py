"""All expressions of a system's code with their derivatives; those that are constant in a run are separated."""

from __future__ import annotations

from collections.abc import Collection

from stribeck.expressions.graph import ONE, ZERO, Expr, derivative, ordered, rewrite, substitute, symbol, symbols
from stribeck.expressions.names import Names
from stribeck.machine.system import MachineSystem


def collect(system: MachineSystem, called: Names) -> tuple[dict[str, list[Expr]], list[bool]]:
    """The system's expressions, and for each watched quantity whether it is not linear in states and time.

    They come as lists that are rewritten together:

    - ``rates``: time derivatives of the states; ``by_state`` (row by row) and ``by_time``: their derivatives.
    - ``watched``: quantities whose zeros are events; ``forces``: friction forces; ``watched_by``, ``forces_by``: their
      derivatives by each state.
    - ``moved``: the energy that changes where a signal jumps; empty if energy is not computed.
    - ``samples``: output and stored values of each sampled controller.

    Names of intermediate results are added to ``called``.
    """
    rates, names = system.rates(called), [state.name for state in system.states]
    states, t = [symbol(name) for name in names], symbol("t")
    known: list[dict[Expr, Expr]] = [{} for _ in (*states, t)]

    def slopes(expression: Expr) -> list[Expr]:
        uses = symbols([expression])
        return [
            derivative(expression, by, known[i]) if str(by.value) in uses else ZERO for i, by in enumerate((*states, t))
        ]

    of_rates = [slopes(rate) for rate in rates]
    watched = [watch.value for watch in system.watches(called)]
    of_watched = [slopes(value) for value in watched]
    forces = system.forces(called)
    samples = system.samples(called)
    moved = system.moved_energy()
    lists = {
        "rates": list(rates),
        "by_state": [entry for row in of_rates for entry in row[:-1]],
        "by_time": [row[-1] for row in of_rates],
        "watched": watched,
        "watched_by": [entry for row in of_watched for entry in row[:-1]],
        "forces": forces,
        "forces_by": [entry for force in forces for entry in slopes(force)[:-1]],
        "moved": [] if moved is None else [moved],
        "samples": [expr for each in samples for expr in (each.output, *each.memory.values())],
    }
    return lists, [bool(symbols(row) & {*names, "t"}) for row in of_watched]


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
