"""A small interpreter of Structured Text over the tree that blark parses: enough to run a function block."""

import math

_BUILT_IN = {
    "ABS": abs, "ATAN": math.atan, "EXP": math.exp, "SQRT": math.sqrt, "SIN": math.sin, "COS": math.cos, "LN": math.log,
    "MAX": max, "LIMIT": lambda low, x, high: min(max(low, x), high), "SEL": lambda c, a, b: b if c else a,
    "INT_TO_LREAL": float, "EXPT": lambda a, b: a**b,
}  # fmt: skip
_OPERATIONS = {
    "+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b, "/": lambda a, b: a / b,
    "<": lambda a, b: a < b, "<=": lambda a, b: a <= b, ">": lambda a, b: a > b, "AND": lambda a, b: a and b,
    "OR": lambda a, b: a or b,
}  # fmt: skip


def parse(text):
    """The functions and function blocks of a source, by name, as blark's tree."""
    import blark.parse

    return {str(item.name): item for item in blark.parse.parse_source_code(text).transform().items}


def declared(block):
    """The variables of a block with their first values."""
    found = {}
    for section in block.declarations:
        for item in section.items:
            first = getattr(item.init, "value", None)
            for variable in item.variables:
                found[str(variable.name)] = evaluate(first, {}, {}) if first is not None else 0.0
    return found


def run(name, blocks, values):
    """One call of a block: its variables are changed."""
    _statements(blocks[name].body.statements, values, blocks)


def _statements(statements, x, blocks):
    for each in statements:
        kind = type(each).__name__
        if kind == "AssignmentStatement":
            (target,) = each.variables
            assert str(target.name) in x, f"{target.name} is not declared"
            x[str(target.name)] = evaluate(each.expression, x, blocks)
        elif kind == "IfStatement":
            assert not each.else_ifs
            if evaluate(each.if_expression, x, blocks):
                _statements(each.statements.statements, x, blocks)
            elif each.else_clause is not None:
                _statements(each.else_clause.statements.statements, x, blocks)
        elif kind == "ForStatement":
            step = evaluate(each.step, x, blocks) if each.step is not None else 1
            first, last = evaluate(each.from_, x, blocks), evaluate(each.to, x, blocks)
            for i in range(first, last + (1 if step > 0 else -1), step):
                x[str(each.control.name)] = i
                _statements(each.statements.statements, x, blocks)
        elif kind == "WhileStatement":
            while evaluate(each.expression, x, blocks):
                _statements(each.statements.statements, x, blocks)
        else:
            raise AssertionError(kind)


def evaluate(node, x, blocks):
    kind = type(node).__name__
    if kind == "Real":
        return float(node.value)
    if kind == "Integer":
        return int(node.value)
    if kind == "SimpleVariable":
        return x[str(node.name)]
    if kind == "ParenthesizedExpression":
        return evaluate(node.expr, x, blocks)
    if kind == "UnaryOperation":
        value = evaluate(node.expr, x, blocks)
        return {"-": lambda: -value, "NOT": lambda: not value}[str(node.op)]()
    if kind == "BinaryOperation":
        return _OPERATIONS[str(node.op)](evaluate(node.left, x, blocks), evaluate(node.right, x, blocks))
    assert kind == "FunctionCall", kind
    name, arguments = str(node.name.name), [evaluate(p.value, x, blocks) for p in node.parameters]
    if name not in blocks:
        return _BUILT_IN[name](*arguments)
    inside = dict(zip(declared(blocks[name]), arguments, strict=True)) | {name: 0.0}
    run(name, blocks, inside)
    return inside[name]
