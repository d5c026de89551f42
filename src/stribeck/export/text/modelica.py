"""A Modelica package: a block of the law, velocity in and force out, and a body that it holds back."""

from __future__ import annotations

import html
import re
from collections.abc import Mapping
from types import SimpleNamespace

from stribeck.constants import Constant, rotary_unit, rotary_words
from stribeck.errors import printable
from stribeck.export.request import Request, Target
from stribeck.expressions.emit import ADD, ATOM, UNARY, Dialect, Writer
from stribeck.expressions.graph import Expr, symbol, wrap
from stribeck.expressions.names import Names
from stribeck.laws.base import Law
from stribeck.plants.mass import Mass
from stribeck.version import __version__

TARGET = Target("modelica", "text.modelica", "a Modelica package", folder=False)

MODELICA = Dialect(
    declare="",
    functions={},
    both="and",
    either="or",
    where="noEvent(if {0} then {1} else {2})",  # the branches meet: no event is needed
    statement_end=";",
    where_precedence=ATOM,
)
_KEYWORDS = frozenset(  # and the names that the block itself uses
    """algorithm and annotation block break class connect connector constant constrainedby der discrete each else elseif
    elsewhen encapsulated end enumeration equation expandable extends external false final flow for function if import
    impure in initial inner input loop model not operator or outer output package parameter partial protected public
    pure record redeclare replaceable return stream then true type when while within time
    abs sign sqrt exp log sin cos atan tanh noEvent smooth Real u v y z F mass""".split()  # noqa: SIM905
)

_ICON = (
    "annotation(Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={"
    "Rectangle(extent={{-100,100},{100,-100}}, lineColor={0,0,127}, fillColor={255,255,255}, "
    "fillPattern=FillPattern.Solid), "
    "Line(points={{-80,-45},{-30,-35},{-4,-70},{0,0},{4,70},{30,35},{80,45}}, color={0,0,127}), "
    'Text(extent={{-150,150},{150,110}}, textString="%name")}));'
)


class _Writer(Writer):
    """Modelica has an operator for powers, and a sign only at the start of a sum."""

    def _format(self, node: Expr) -> tuple[str, int]:
        if node.op == "pow":
            return "^".join(self._arg(arg, ATOM) for arg in node.args), UNARY
        text, precedence = super()._format(node)
        return text, ADD if text.startswith("-") else precedence


def files(request: Request) -> dict[str, str]:
    """The package, by its file's name."""
    name = f"Friction{_class(request.law)}"
    return {f"{name}.mo": _package(request, name)}


def notes(request: Request) -> list[str]:
    """What a Modelica tool cannot keep."""
    if request.law.jumps_at_rest:
        return [
            f"law '{request.law.name}': F jumps at v = 0 and the block makes no event of it: a body will not come to rest"
        ]
    return []


def _class(law: Law) -> str:
    return re.sub(r"\W", "_", type(law).__name__, flags=re.ASCII)


def _package(request: Request, name: str) -> str:
    law, about = request.law, request.about()
    body = _block(law, request.constants)
    comment = "\n".join(f"// {line}".rstrip() for line in about)
    info = html.escape("\n".join(about), quote=False).replace("\\", "\\\\").replace('"', '\\"')
    mass = getattr(request.scenario, "mass", None) or 1.0
    made = f"""\
within;
package {name} "{_line(law)}"
  connector RealInput = input Real "a signal in, as Modelica.Blocks.Interfaces.RealInput";
  connector RealOutput = output Real "a signal out, as Modelica.Blocks.Interfaces.RealOutput";

{body}
  model Body "a body that a force pushes and this friction holds back"
    parameter Real mass(unit="kg", min=0) = {mass!r} "mass of the body";
    RealInput u(unit="N") "force on the body";
    RealOutput y(unit="m", start=0, fixed=true, nominal={_nominal(law)[0]!r}) "position";
    RealOutput v(unit="m/s", start=0, fixed=true, nominal={_nominal(law)[1]!r}) "velocity";
    {_class(law)} friction "friction on the body";
  equation
    friction.v = v;
    der(y) = v;
    der(v) = {_acceleration()};
  end Body;

  annotation(version="{__version__}", Documentation(info="<html><pre>{info}</pre></html>"));
end {name};
"""
    return f"{comment}\n{_turned(made) if request.rotary else made}"


def _acceleration() -> str:
    """dv/dt of the body, from the equation that is simulated."""
    value = Mass.acceleration(SimpleNamespace(mass=symbol("mass")), symbol("u"), symbol("F"))
    line = _Writer(MODELICA, {"mass": "mass", "u": "u", "F": "friction.F"}).write([("a", wrap(value))])[-1]
    return line.removeprefix("a = ").removesuffix(";")


def _turned(text: str) -> str:
    """The package of a machine that turns: its units, and the words beside them."""

    def unit(found: re.Match[str]) -> str:
        turned = rotary_unit(found[1].replace(".", " ")).replace(" ", ".")
        return f'unit="{turned}"'

    text = re.sub(r'unit="([^"]+)"', unit, text)
    return re.sub(r'(?<!=)"([^"]*)"(?= annotation|;|\n)', lambda found: f'"{rotary_words(found[1])}"', text)


def _block(law: Law, constants: Mapping[str, float]) -> str:
    declared, names = law.constants(), {name: _name(name) for name in constants}
    called = Names()
    p, v, z = law.symbolic(symbol, law.form, called.term), symbol("v"), symbol("z")
    rate = wrap(law.dz_dt(p, v, z))
    outputs: list[tuple[str, Expr]] = [("der(z)", rate)] if law.has_z else []
    outputs.append(("F", wrap(law.friction(p, v, z, rate))))
    lines = _Writer(MODELICA, {**names, "v": "v", "z": "z"}, taken=_KEYWORDS, names=called).write(outputs)
    helpers = [left for left in (line.split(" = ")[0] for line in lines) if left not in ("der(z)", "F")]
    length, _ = _nominal(law)
    rows = [_parameter(names[n], declared[n], x) for n, x in constants.items()]
    rows.append('RealInput v(unit="m/s") "velocity" ' + _place(-1))
    rows.append('RealOutput F(unit="N") "friction force, positive when it opposes positive velocity" ' + _place(1))
    if law.has_z:
        rows.append(f'Real z(unit="m", start=0, fixed=true, nominal={length!r}) "mean bristle deflection";')
    text = [f'  block {_class(law)} "{_line(law)}"', *(f"    {row}" for row in rows)]
    if helpers:
        text += ["  protected", *(f"    Real {name};" for name in helpers)]
    text += ["  equation", *(f"    {line}" for line in lines), f"    {_ICON}", f"  end {_class(law)};", ""]
    return "\n".join(text) + "\n"


def _parameter(name: str, constant: Constant, value: float) -> str:
    low = constant.above if constant.above is not None else constant.at_least
    least = "" if low is None else f", min={low:g}"
    unit = _quoted(constant.unit).replace(" ", ".") or "1"
    return f'parameter Real {name}(unit="{unit}"{least}) = {value!r} "{_quoted(constant.meaning)}";'


def _place(side: int) -> str:
    corners = "{{-140,-20},{-100,20}}" if side < 0 else "{{100,-10},{120,10}}"
    return f"annotation(Placement(transformation(extent={corners})));"


def _nominal(law: Law) -> tuple[float, float]:
    scales = law.scales(law.p)
    return float(scales.length), float(scales.speed)


def _name(constant: str) -> str:
    return f"{constant}_" if constant in _KEYWORDS else re.sub(r"\W", "_", constant, flags=re.ASCII)


def _line(law: Law) -> str:
    return _quoted(law.__doc__ or law.name)


def _quoted(text: str) -> str:
    """A text as it may stand in a string of one line."""
    return printable(" ".join(text.split())).replace("\\", "/").replace('"', "'")
