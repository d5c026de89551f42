"""``--target mit``: gains of a drive that takes position, speed, two gains and a torque (MIT mode), as YAML."""

from __future__ import annotations

from stribeck.errors import InputError
from stribeck.export.controller.block import Block
from stribeck.export.request import Target, made_by
from stribeck.export.text.table import fit
from stribeck.machine.controllers import Cascade, PidController

TARGET = Target("mit", "controller.mit", "gains of a drive in MIT mode, as YAML", ("controller",), folder=False)


def files(block: Block) -> dict[str, str | bytes]:
    """kp, kd and the feedforward of torque.

    Raises:
        InputError: the controller has an integral, which the mode lacks, or is of one's own.
    """
    block.refuse("mit", "lead")
    rig, each = block.scenario.rig, block.controller
    value = {n: rig.values[each.path, n] for n in each.kind.numbers(each.form)}
    if each.kind is PidController and not value.get("K_i"):
        kp, kd, about = value["K_p"], value["K_d"], "kp = K_p, kd = K_d; send v_des = 0"
    elif each.kind is Cascade and "T_i" not in each.form:
        kp, kd, about = value["K_p"] * value["K_v"], value["K_v"], "kp = K_p K_v, kd = K_v; send v_des = dr/dt"
    else:
        what = "an integral (K_i, T_i)" if each.kind in (PidController, Cascade) else f"kind {each.kind.kind!r}"
        raise InputError(f"{each.path}: {what}: must be a pid or a cascade without one: MIT mode has kp and kd alone")
    unit, speed = ("N m", "rad/s") if block.rotary else ("N", "m/s")
    lines = [
        f"# {block.about()[0]}",
        f"# torque = kp (p_des - p) + kd (v_des - v) + t_ff; {about}.",
        "# The drive works at its own rate and encoder.",
        f"# {made_by()}",
        f"{each.name}:",
        f"  kp: {kp!r}  # {unit}/{'rad' if block.rotary else 'm'}",
        f"  kd: {kd!r}  # {unit} s/{'rad' if block.rotary else 'm'}",
        f"  inertia: {rig.values.get((f'{each.path}.feedforward', 'inertia'), 0.0)!r}  # t_ff += inertia d2r/dt2",
    ]
    if "limit" in each.form:
        lines.append(f"  limit: {value['limit']!r}  # {unit}")
    if each.compensation is not None:
        share = rig.values[f"{each.path}.compensation", "share"] if each.compensation.share else 1.0
        v, force, error = fit(rig.laws[each.compensation.path])
        lines += [
            f"  friction:  # t_ff += sign(v_des) times this at |v_des|, interpolated; within {share * error:.3g} {unit}",
            f"    v: [{', '.join(f'{x:.6g}' for x in v)}]  # {speed}",
            f"    torque: [{', '.join(f'{share * x:.6g}' for x in force)}]  # {unit}",
        ]
    if each.dither is not None:
        amplitude, frequency = (rig.values[each.dither.path, n] for n in ("amplitude", "frequency"))
        lines += [
            f"  dither:  # t_ff += amplitude times a {each.dither.kind} of this frequency",
            f"    amplitude: {amplitude!r}  # {unit}",
            f"    frequency: {frequency!r}  # Hz",
        ]
    return {f"{block.name}.yaml": "\n".join(lines) + "\n"}


def notes(block: Block) -> list[str]:
    """What the drive does in its own way."""
    each, found = block.controller, []
    if each.sampling is not None:
        found.append(f"{each.path}.sampling: not in it: the drive works at its own rate, with its own encoder")
    if each.compensation is not None and each.compensation.speed == "measured":
        found.append(f"{each.path}.compensation.speed: 'measured': a table of the steady friction stands for it")
    return found
