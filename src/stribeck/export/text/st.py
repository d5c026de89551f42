"""``--target st``: a function block in IEC 61131-3 Structured Text."""

from __future__ import annotations

from collections.abc import Sequence

from stribeck.errors import InputError
from stribeck.export.c.ccode import ARGUMENTS, LawCode, render
from stribeck.export.c.sampling import resolution
from stribeck.export.request import Request, Target
from stribeck.expressions.emit import Dialect, Writer
from stribeck.expressions.graph import Expr
from stribeck.expressions.names import Names

TARGET = Target(
    "st",
    "text.st",
    "an IEC 61131-3 function block in Structured Text",
    ("law", "controller", "compensator"),
    folder=False,
)

_OWN = ("v", "dt", "reset", "f", "z", "ok")  # of the block itself; the language knows no case
# Keywords, types and standard functions of IEC 61131-3, which no variable may be called.
_LISTED = """
    abs acos add and any array asin at atan bool by byte case char concat configuration constant continue cos date delete
    dint div do dt dword else elsif end_case end_for end_function end_function_block end_if end_repeat end_var end_while eq
    exit exp expt false find for from function function_block ge goto gt if insert int interface interval le left len limit
    lint ln log lreal lt lword max method mid min mod move mul mux namespace ne not null of on or override private program
    protected public real ref repeat replace resource retain return right rol ror sel shl shr sin sint sqrt string struct sub
    super tan task then this time to tod trunc true type udint uint ulint until usint var var_external var_global
    var_in_out var_input var_output var_temp while wchar with word wstring xor
"""
WORDS = frozenset(_LISTED.split())
_PARTS = 16  # of a step, for laws whose dz/dt is not linear in z

# EXP, TANH and SIGN are functions of the file: the standard has no TANH, and controllers may stop on an overflow.
_DIALECT = Dialect(
    declare="",
    functions={
        "exp": "{n}_exp", "tanh": "{n}_tanh", "sign": "{n}_sign", "abs": "ABS", "atan": "ATAN", "sqrt": "SQRT",
        "sin": "SIN", "cos": "COS", "log": "LN", "pow": "EXPT",
    },
    both="AND",
    either="OR",
    where="SEL({0}, {2}, {1})",
    statement_end=";",
    where_precedence=0,
    loop=("WHILE {reach} > 1.0 DO", "END_WHILE;"),
)  # fmt: skip


class StWriter(Writer):
    """Variables are called w_..., unique whatever the case of letters; they are listed for their declaration."""

    def __init__(self, own: str, inputs: dict[str, str], names: Names) -> None:
        functions = {op: name.format(n=own) for op, name in _DIALECT.functions.items()}
        super().__init__(Dialect(**{**vars(_DIALECT), "functions": functions}), inputs, names=names)
        self.variables: list[str] = []

    def begin(self) -> None:
        """A new section: nothing that an earlier one computed can be used."""
        self.lines, self._text = [], {}

    def _name(self, label: str | None) -> str:
        base = name = f"w_{label or 't'}"
        count = 1
        while name.lower() in self.taken:
            count += 1
            name = f"{base}_{count}"
        self.taken.add(name.lower())
        self.variables.append(name)
        return name

    def _format(self, node: Expr) -> tuple[str, int]:
        text, precedence = super()._format(node)
        return (st_number(node.value), precedence) if isinstance(node.value, float) else (text, precedence)


def st_number(x: float) -> str:
    """A number as the standard writes it: with a point."""
    mantissa, e, exponent = repr(float(x)).partition("e")
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}{'E' if e else ''}{int(exponent) if e else ''}"


def unspeakable(name: str) -> bool:
    """Whether the language cannot call a variable so; it knows no case, and no two underscores in a row."""
    return name.lower() in WORDS or not name.isascii() or "__" in name or name.endswith("_")


def files(request: Request) -> dict[str, str | bytes]:
    """The function block, with the functions that it needs."""
    law, equations = request.law, LawCode(request.law)
    names = [*_OWN, *(name.lower() for name in request.constants)]
    if bad := [
        name for name in request.constants if names.count(name.lower()) > 1 or name in ARGUMENTS or unspeakable(name)
    ]:
        text = "a constant of this name cannot be exported to Structured Text: rename it"
        raise InputError([f"{name}: {text}" for name in bad])
    inputs = {name: name for name in request.constants} | {"v": "v", "z": "z", "rate": "w_rate"}
    writer = StWriter(request.name, inputs, equations.names)
    writer.taken.update(("w_rate", "w_slope", "w_drive", "w_x", "w_dz", "w_bound", "w_h"))

    def statements(outputs: Sequence[tuple[str, str]]) -> list[str]:
        writer.begin()
        lines = writer.write([(target, equations.expressions[name]) for target, name in outputs])
        return [line.replace(" = ", " := ", 1) for line in lines]

    hold = [("w_slope", "rate_z"), ("w_rate", "rate")]
    sections = {
        "equations": statements(hold) if law.has_z else [],
        "bound": statements([("w_bound", "bound")]) if equations.bounded else [],
        "force": [*(statements([("w_rate", "rate")]) if law.has_z else []), *statements([("F", "force_at_rate")])],
    }
    declared = request.declared
    constants = [(n, st_number(x), declared[n]) for n, x in request.constants.items()]
    text = render(
        "law.st", name=request.name, about=request.about(), law=law, eq=equations, constants=constants,
        u=request.unit, w=request.words,
        used={op for op in ("exp", "sign", "tanh") if equations.uses(op)} | ({"exp"} if law.has_z else set()),
        variables=list(dict.fromkeys(writer.variables)), parts=1 if equations.linear else _PARTS, **sections,
    )  # fmt: skip
    return {f"{request.name}.st": text}


def notes(request: Request) -> list[str]:
    """What is lost at the time step that was given."""
    return resolution(request)
