"""MuJoCo: a model with the law as an actuator, and the callback that computes it.

MuJoCo's ``dcmotor`` has LuGre friction. Its attribute ``lugre`` holds sigma_0, sigma_1, F_c, F_s and v_s, as stiffness,
damping, coulomb, static and stribeck. Its attribute ``damping`` is sigma_2. ``dahl`` is the same with F_s = F_c and no
damping. It advances z exactly at held velocity, but takes the force from the z before: the contact answers a step late.
The callback has every law, and looks a step ahead.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from stribeck.errors import InputError
from stribeck.exports.c.ccode import LawCode, render
from stribeck.exports.request import Content, Part, Request, Target, wrapped
from stribeck.expressions.emit import PYTHON, Writer
from stribeck.expressions.graph import substitute, symbol, wrap
from stribeck.laws.base import Law
from stribeck.laws.dahl import Dahl
from stribeck.laws.lugre import LuGre

_STEP = 1e-3  # s, unless the request says otherwise
_SLOTS = 10  # numbers that an actuator of MuJoCo can carry (mjNBIAS)
_DIALECT = replace(PYTHON, functions={"atan": "arctan"})
_FUNCTIONS = ("exp", "log", "sqrt", "sin", "cos", "arctan", "tanh", "sign", "where", "both", "either", "abs", "pow")
_LOCALS = ("p", "v", "z", "np", "mujoco", "equations")


def files(request: Request) -> Content:
    """``LAW.xml`` with ``LAW_mujoco.py``, its callback; and ``LAW_dcmotor.xml`` where MuJoCo has the law itself."""
    law, name = request.law, request.name
    if len(_carried(request)) > _SLOTS:
        raise InputError(
            f"law '{law.name}': has {len(_carried(request))} constants; must be at most {_SLOTS}, which is what an "
            "actuator of MuJoCo can carry"
        )
    carried = _carried(request)
    of_user = _model(request, carried.values(), native=False, carried=carried, has_z=request.law.has_z)
    content = {f"{name}.xml": of_user, f"{name}_mujoco.py": _callback(request)}
    return {**content, f"{name}_dcmotor.xml": _native_model(request)} if maps_to_dcmotor(law) else content


def notes(request: Request) -> list[str]:
    """Notes about the accuracy in MuJoCo at the time step."""
    law, warnings = request.law, []
    if law.jumps_at_rest:
        warnings.append(f"law '{law.name}': F jumps at v = 0: a body at rest chatters by F/mass * step in v")
    if maps_to_dcmotor(law) and _step(request) > (period := (_mass(request) / law.p.sigma_0) ** 0.5):
        warnings.append(
            f"{request.name}_dcmotor.xml: at a step of {_step(request):g} s above sqrt(mass/sigma_0) = {period:.3g} s "
            "MuJoCo's own LuGre creeps and breaks away early, and grows without bound under RK4: it takes the force from "
            f"the deflection before the step; {request.name}.xml with its callback stays stable"
        )
    return warnings


def maps_to_dcmotor(law: Law) -> bool:
    """True where MuJoCo's ``dcmotor`` computes this very law."""
    return type(law) in (LuGre, Dahl)


def _native_model(request: Request) -> str:
    p = request.law.p
    if isinstance(request.law, Dahl):
        numbers, viscous, mapped = (p.sigma_0, 0.0, p.F_c, p.F_c, 1.0), 0.0, "lugre = sigma_0, 0, F_c, F_c, any speed."
    else:
        numbers, viscous = (p.sigma_0, p.sigma_1, p.F_c, p.F_s, p.v_s), p.sigma_2
        mapped = "lugre = sigma_0, sigma_1, F_c, F_s, v_s; damping = sigma_2."
    return _model(request, numbers, native=True, viscous=viscous, mapped=mapped)


def _model(request: Request, numbers: Iterable[float], **values: object) -> str:
    lines = [re.sub("-(?=-)", "- ", f"  {line}".rstrip()) for line in wrapped(request.about())]  # no end of a comment
    return render(
        "mujoco.xml", name=request.name, about=lines, inputs=request.law.inputs, step=_step(request), mass=_mass(request),
        joint="hinge" if request.rotary else "slide", numbers=[repr(x) for x in numbers], **values,
    )  # fmt: skip


def _step(request: Request) -> float:
    return request.step or _STEP


def _mass(request: Request) -> float:
    if request.part == "body":
        return request.mass
    return float(request.moved_mass or 1.0)


def _carried(request: Request) -> dict[str, float]:
    """The constants that stand in the model; a contact's gains and inputs do not."""
    law, constants = request.law, request.constants
    beside = set(type(law).constants()) - set(type(law).__mro__[1].constants()) if law.inputs else set()  # type: ignore[attr-defined]
    return {n: x for n, x in constants.items() if n not in beside}


def _equations(request: Request) -> str:
    """Python statements for dz/dt, F and their derivatives by v and z."""
    law, carried, code = request.law, _carried(request), LawCode(request.law)
    beside = {symbol(n): wrap(x) for n, x in request.constants.items() if n not in carried and n not in law.inputs}
    outputs = ("rate", "force", "rate_v", "rate_z", "force_v", "force_z")
    expressions = substitute([code.expressions[n] for n in outputs], beside, code.names)
    taken = {*_FUNCTIONS, *_LOCALS, *outputs}
    names = {n: f"{n}_" if n in taken else n for n in (*carried, *law.inputs)}
    writer = Writer(_DIALECT, {**names, "v": "v", "z": "z"}, taken=taken, names=code.names)
    lines = writer.write(list(zip(outputs, expressions, strict=True)))
    given = ["".join(f"{names[n]}, " for n in law.inputs) + "= load"] if law.inputs else []
    rows = [f"{', '.join(names[n] for n in carried)}, = p", *given, *lines, f"return {', '.join(outputs)}"]
    return "\n".join(f"    {row}" for row in rows)


def _callback(request: Request) -> str:
    return render(
        "mujoco.txt", about=request.in_docstring(), name=request.name, count=len(_carried(request)),
        equations=_equations(request), inputs=request.law.inputs,
    )  # fmt: skip


_LAW = Part(files, notes)
TARGET = Target("mujoco", "a MuJoCo model, and a callback", {"law": _LAW, "body": _LAW}, loads=True, started=False)
