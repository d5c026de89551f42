"""A machine that turns: every unit of an export is in rad and N m, and nothing else changes."""

import re

import pytest

import stribeck
from stribeck.constants import Constant, rotary_unit
from stribeck.exports import export
from stribeck.laws import builtin

TURNING = stribeck.law("lugre_majorant", parameters="olsson1998", k_v=1e5)
PUSHED = stribeck.law("lugre_majorant", {n: x for n, x in TURNING.values.items() if n in TURNING.uses}, k_v=1e5)
LINEAR = re.compile(r"(?<!N )\bm/s\b|\bN/s|\bN s/m\b|\bN/m\b|\bs/m\b|\bN\b(?! m| for)|\(m\)|/\* m:")


def code(text):
    """A source without its comments."""
    return re.sub(r"/\*.*?\*/|\(\*.*?\*\)|^#.*?$|//.*?$", "", text, flags=re.S | re.M)


def test_rotary_units_follow_from_linear_ones():
    declared = {c for law in builtin().values() for c in law.constants().values() if c.rotary_unit}
    assert len(declared) > 10
    for constant in declared:
        assert rotary_unit(constant.unit) == constant.rotary_unit
    assert Constant("kg", "mass of the body").of_motion(True) == Constant("kg m^2", "moment of inertia of the body")


@pytest.mark.parametrize("target", ["c", "table"])
def test_header_comments_and_labels_follow(target, tmp_path):
    for name, law in (("turning", TURNING), ("pushed", PUSHED)):
        export(law, target, tmp_path / name)
    places = [tmp_path / "turning", tmp_path / "pushed"]
    files = [sorted(p.iterdir()) if p.is_dir() else [p] for p in places]
    for turning, pushed in zip(*files, strict=True):
        of_turning, of_pushed = turning.read_text(), pushed.read_text()
        assert code(of_turning) == code(of_pushed)
        if turning.suffix != ".c":
            assert "sigma_0 = 260.0 N m/rad" in of_turning
            assert "rotary motion" in of_turning
            assert "N m/rad" not in of_pushed.replace("a rotary machine has N m for N and rad for m", "")
    if target == "c":
        header = (tmp_path / "turning" / "lugre_majorant.h").read_text()
        assert "Friction torque in N m at angular velocity v (rad/s) and deflection z (rad)" in header
        comments = " ".join(re.findall(r"/\*.*?\*/", header, flags=re.S))
        assert LINEAR.findall(comments) == []
        other = (tmp_path / "pushed" / "lugre_majorant.h").read_text()
        assert len(LINEAR.findall(other)) > 10
