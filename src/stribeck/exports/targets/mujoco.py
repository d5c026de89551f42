"""MuJoCo: a model with the law as an actuator, and the callback that computes it.

MuJoCo's ``dcmotor`` has LuGre friction. Its attribute ``lugre`` holds sigma_0, sigma_1, F_c, F_s and v_s, as stiffness,
damping, coulomb, static and stribeck. Its attribute ``damping`` is sigma_2. ``dahl`` is the same with F_s = F_c and no
damping. It advances z exactly at held velocity, but takes the force from the z before: the contact answers a step late.
The callback has every law, and looks a step ahead.
"""

from __future__ import annotations

import re
from dataclasses import replace

from stribeck.errors import InputError
from stribeck.exports.request import Content, Part, Request, Target, wrapped
from stribeck.expressions.emit import PYTHON, Writer
from stribeck.expressions.graph import derivative, symbol, wrap
from stribeck.expressions.names import Names
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
    content = {f"{name}.xml": _user_model(request), f"{name}_mujoco.py": _callback(request)}
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
        numbers, viscous, lost = (p.sigma_0, 0.0, p.F_c, p.F_c, 1.0), 0.0, "lugre = sigma_0, 0, F_c, F_c, any speed."
    else:
        numbers, viscous = (p.sigma_0, p.sigma_1, p.F_c, p.F_s, p.v_s), p.sigma_2
        lost = "lugre = sigma_0, sigma_1, F_c, F_s, v_s; damping = sigma_2."
    actuator = (
        f'<dcmotor name="{request.name}" joint="{_joint(request)}" input="none" motorconst="0" resistance="1"\n'
        f'             lugre="{" ".join(map(repr, numbers))}" damping="{viscous!r}"/>'
    )
    how = (
        f"MuJoCo's own LuGre, no callback needed: {lost}\n"
        "  Lost: the force comes from the deflection before the step, so that steps must stay below\n"
        "  sqrt(mass/sigma_0), far below under Euler and the implicit integrators; sigma_2 v is no part of\n"
        "  data.actuator_force."
    )
    return _model(request, actuator, how, "RK4")


def _user_model(request: Request) -> str:
    law = request.law
    state = 'dyntype="user" actdim="1"' if law.has_z else 'dyntype="none"'
    numbers = " ".join(map(repr, _carried(request).values()))
    words = _LOAD["load"] if law.inputs else ""
    actuator = (
        f'<general name="{request.name}" joint="{_joint(request)}" {state} gaintype="fixed" gainprm="0" biastype="user"\n'
        f'             biasprm="{numbers}" damping="1e-9"/>'
    )
    how = (
        f"biasprm: {', '.join(_carried(request))}.\n"
        f"  The force comes from {request.name}_mujoco.py: load the model, then call its install(model{words}).\n"
        "  The callback sets damping at every step; it must be above 0 here."
    )
    return _model(request, actuator, how, "implicitfast")


def _step(request: Request) -> float:
    return request.step or _STEP


def _mass(request: Request) -> float:
    if request.part == "body":
        return request.mass
    return float(request.moved_mass or 1.0)


def _joint(request: Request) -> str:
    """The name and the type of the model's joint."""
    return "hinge" if request.rotary else "slide"


def _model(request: Request, actuator: str, how: str, integrator: str) -> str:
    lines = re.sub(
        "-(?=-)", "- ", "\n".join(f"  {line}".rstrip() for line in wrapped(request.about()))
    )  # no end of a comment
    mass, joint = _mass(request), _joint(request)
    if request.rotary:
        inertia = f'<inertial pos="0 0 0" mass="1" diaginertia="{mass!r} {mass!r} {mass!r}"/>'
    else:
        inertia = f'<geom type="box" size="0.05 0.05 0.05" mass="{mass!r}"/>'
    return f"""\
<!--
{lines}

  {how}
  Copy the actuator into your own model. Set its joint to the name of yours, a slide (N, m) or a hinge (N m, rad).
-->
<mujoco model="{request.name}">
  <option timestep="{_step(request)!r}" gravity="0 0 0" integrator="{integrator}"/>
  <worldbody>
    <body name="body">
      <joint name="{joint}" type="{joint}" axis="1 0 0"/>
      {inertia}
    </body>
  </worldbody>
  <actuator>
    {actuator}
  </actuator>
</mujoco>
"""


def _carried(request: Request) -> dict[str, float]:
    """The constants that stand in the model; a contact's gains and inputs do not."""
    law, constants = request.law, request.constants
    beside = set(type(law).constants()) - set(type(law).__mro__[1].constants()) if law.inputs else set()  # type: ignore[attr-defined]
    return {n: x for n, x in constants.items() if n not in beside}


def _equations(request: Request) -> str:
    """Python statements for dz/dt, F and their derivatives by v and z."""
    called, law, carried = Names(), request.law, _carried(request)
    p, v, z = law.symbolic(symbol, law.form, called.term), symbol("v"), symbol("z")
    p = p.replaced({n: x for n, x in request.constants.items() if n not in carried and n not in law.inputs})
    rate = wrap(law.dz_dt(p, v, z)) if law.has_z else wrap(0)
    force = wrap(law.friction(p, v, z, rate))
    outputs = {"rate": rate, "force": force}
    outputs |= {
        f"{name}_{x}": derivative(output, symbol_)
        for name, output in outputs.items()
        for x, symbol_ in (("v", v), ("z", z))
    }
    taken = {*_FUNCTIONS, *_LOCALS, *outputs}
    names = {n: f"{n}_" if n in taken else n for n in (*carried, *law.inputs)}
    lines = Writer(_DIALECT, {**names, "v": "v", "z": "z"}, taken=taken, names=called).write(list(outputs.items()))
    given = ["".join(f"{names[n]}, " for n in law.inputs) + "= load"] if law.inputs else []
    rows = [f"{', '.join(names[n] for n in carried)}, = p", *given, *lines, f"return {', '.join(outputs)}"]
    return "\n".join(f"    {row}" for row in rows)


def _callback(request: Request) -> str:
    words = dict.fromkeys(_LOAD, "")
    if inputs := request.law.inputs:
        words = {key: text.format(", ".join(inputs)) for key, text in _LOAD.items()}
    return _CALLBACK.format(
        about=request.in_docstring(),
        name=request.name,
        count=len(_carried(request)),
        equations=_equations(request),
        **words,
    )


# What the callback of a contact has beside: an argument, its values now, its words, and where the function is kept.
_LOAD = {
    "load": ", load",
    "now": ", _load(model, data, i)",
    "how": "\nload(model, data, i) is yours: it returns what the level of actuator i follows now, in this order: {}.\n",
    "default": "\n_load = None\n",
    "keep": "    global _load\n    _load = load\n",
}

_CALLBACK = '''\
"""{about}

A callback for MuJoCo, without a plugin (tested with MuJoCo 4.0):

    model = mujoco.MjModel.from_xml_path("{name}.xml")
    data = mujoco.MjData(model)
    {name}_mujoco.install(model{load})    # after loading: MuJoCo compiles no model while a Python callback is set

Every actuator called "{name}" or "{name}:..." then has this friction, with the constants in its biasprm; z is its
activation, in data.act. The bristle moves by its exact step at held velocity (the exponential Rosenbrock step where dz/dt is
not linear in z). The force is that at the end of the step, linear in the change of velocity; the linear part is given
to MuJoCo as the actuator's damping, which its integrators Euler, implicit and implicitfast take implicitly: the stiff
contact stays stable where an explicit step would not. The damping is written into the model, so that threads must not
share one; and data.actuator_force holds only a part of the friction: force() has all of it.
{how}"""

import mujoco
import numpy as np
from numpy import arctan, cos, exp, expm1, log, sign, sin, sqrt, tanh, where  # noqa: F401
from numpy import logical_and as both, logical_or as either  # noqa: F401

_INTEGRATORS = (
    mujoco.mjtIntegrator.mjINT_EULER, mujoco.mjtIntegrator.mjINT_IMPLICIT, mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
)
{default}

def equations(p, v, z{load}):
    """dz/dt, F, and their derivatives by v and by z, for the constants p."""
{equations}


def force(model, data, actuator="{name}"):
    """The friction force in the present state, N."""
    return float(_at(model, data, mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, actuator))[0][1])


def install(model{load}):
    """Compute this friction in the actuators of the model from now on; callbacks set before keep the other actuators."""
{keep}    if model.opt.integrator not in _INTEGRATORS:
        raise ValueError("the integrator must be Euler, implicit or implicitfast")
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_ACTUATOR, i) for i in range(len(model.actuator_biastype))]
    mine = {{i for i, name in enumerate(names) if name == "{name}" or (name or "").startswith("{name}:")}}
    if not mine:
        raise ValueError("the model has no actuator called '{name}' or '{name}:...'")
    other_dyn, other_bias = mujoco.get_mjcb_act_dyn(), mujoco.get_mjcb_act_bias()
    mujoco.set_mjcb_act_dyn(lambda m, d, i: _act_dot(m, d, i) if i in mine else other_dyn(m, d, i) if other_dyn else 0.0)
    mujoco.set_mjcb_act_bias(lambda m, d, i: _bias(m, d, i) if i in mine else other_bias(m, d, i) if other_bias else 0.0)


def remove():
    """Take all callbacks away, as is needed before another model is loaded."""
    mujoco.set_mjcb_act_dyn(None)
    mujoco.set_mjcb_act_bias(None)


def _at(model, data, i):
    """The results of equations(), v, and the growth h phi_1(h d(dz/dt)/dz) of the bristle's step."""
    v, h = data.actuator_velocity[i], model.opt.timestep
    z = data.act[model.actuator_actadr[i]] if model.actuator_actnum[i] else np.float64(0.0)
    with np.errstate(all="ignore"):
        values = equations(model.actuator_biasprm[i][:{count}], v, z{now})
    x = h * values[3]
    return values, v, h * (expm1(x) / x if x else 1.0)


def _act_dot(model, data, i):
    (rate, *_), _, growth = _at(model, data, i)
    return rate * growth / model.opt.timestep  # MuJoCo adds timestep * act_dot


def _bias(model, data, i):
    (rate, force, rate_v, _, force_v, force_z), v, growth = _at(model, data, i)
    applied = model.actuator_damping[i] * v  # what MuJoCo's damping has taken in this step already
    model.actuator_damping[i] = max(force_v + force_z * growth * rate_v, 0.0)
    return applied - force - force_z * growth * rate
'''


_LAW = Part(files, notes)
TARGET = Target("mujoco", "a MuJoCo model, and a callback", {"law": _LAW, "body": _LAW}, loads=True, started=False)
