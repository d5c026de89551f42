"""``--target table``: the compensation as a table of speed and force."""

from __future__ import annotations

from stribeck.errors import InputError, arg
from stribeck.export.controller.block import Block
from stribeck.export.request import made_by
from stribeck.export.text.table import fit

_DEFLECTION = "The law at the measured speed follows a deflection, which no table has."

_DEFLECTION = "The law at the measured speed follows a deflection, which no table has."

_DEFLECTION = "The law at the measured speed follows a deflection, which no table has."

_DEFLECTION = "The law at the measured speed follows a deflection, which no table has."

_DEFLECTION = "The law at the measured speed follows a deflection, which no table has."


def files(block: Block) -> dict[str, str | bytes]:
    """A CSV of speed and of the share of the steady friction that is added at it.

    Raises:
        InputError: the part is not the compensation, whose law alone has a steady curve.
    """
    rig, made = block.scenario.rig, block.controller.compensation
    if made is None or block.part != "compensator":
        raise InputError(f"{arg('part')}: {block.part!r}: target 'table' has the compensator alone")
    block.refuse("table", "lead")
    law = rig.laws[block.controller.friction_path]
    v, force, error = fit(law)
    share = rig.values[f"{block.controller.path}.compensation", "share"] if made.share is not None else 1.0
    speed, unit = ("rad/s", "N m") if block.rotary else ("m/s", "N")
    head = [
        f"{block.name}: {share:g} of the steady friction of {law.name}, to be added at the {made.speed} speed.",
        "F(-v) = -F(v), and 0 at v = 0. Interpolate linearly; beyond the last point go on along the last two.",
        f"Greatest error for 0 < v <= {v[-1]:g} {speed}: {share * error:.3g} {unit}.",
        *((_DEFLECTION,) if made.observes(rig.machine.elements) else ()),
        f"v in {speed}, F in {unit}", made_by(),
    ]  # fmt: skip
    rows = "".join(f"{x!r},{share * y!r}\n" for x, y in zip(v.tolist(), force.tolist(), strict=True))
    return {f"{block.name}.csv": "".join(f"# {line}\n" for line in head) + "v,F\n" + rows}


def notes(block: Block) -> list[str]:
    """What no table has."""
    made = block.controller.compensation
    if made is None or made.speed == "reference":
        return []
    return [f"{block.controller.path}.compensation.speed: 'measured': the table is the steady friction at that speed"]
