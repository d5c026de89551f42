"""Signals of a machine file, and their sums, against SciPy on equations written apart, and in C."""

import shutil
import subprocess

import numpy as np
import pytest

import stribeck
from stribeck import Scenario, simulate
from stribeck.machine.signal import Ramp, Sine, Square, Staircase, Sum
from tests.machine.machines import assert_balanced
from tests.reference import apart

LAW = {"sigma_0": 1e4, "sigma_1": 30.0, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-2}
SIGNAL = {
    "kind": "sum",
    "of": [
        {"kind": "sine", "amplitude": 6.0, "frequency": 2.0},
        {"kind": "square", "amplitude": 1.0, "frequency": 3.0, "cycles": 4},
        {"kind": "staircase", "levels": [0.0, 1.0, 2.0], "hold": 0.2, "ramp": 0.05},
    ],
}
MACHINE = {
    "schema": 2, "name": "machine",
    "bodies": {"a": {"mass": 1.0}},
    "links": {"k": {"from": "a", "to": "ground", "stiffness": 50.0, "damping": 1.0}},
    "contacts": {"c": {"from": "a", "law": {"name": "lugre", "parameters": LAW}}},
    "loads": {"p": {"on": "a", "kind": "signal", "signal": SIGNAL}},
    "solve": {"t_end": 2.0}, "output": {"step": 1e-2, "energy": True},
}  # fmt: skip


EDGES = np.repeat(np.arange(9) / 6, 2).tolist()
PARTS = (  # of the sum: what jumps and what steps, as points
    SIGNAL["of"][0],
    {"kind": "points", "t": EDGES, "value": [0.0, *np.repeat([1.0, -1.0] * 4, 2).tolist(), 0.0]},
    {"kind": "points", "t": [0.2, 0.25, 0.45, 0.5], "value": [0.0, 1.0, 1.0, 2.0]},
)


def test_against_scipy():
    """Its parts as forces of their own, by the equations written apart (tests/reference/apart.py)."""
    loads = {f"p{i}": {"on": "a", "kind": "signal", "signal": part} for i, part in enumerate(PARTS)}
    result, expected = simulate(MACHINE), apart.solve({**MACHINE, "loads": loads})
    for name in ("a.y", "a.v"):
        assert np.max(abs(result[name] - expected[name])) <= 1e-6 * np.max(abs(expected[name]))
    assert_balanced({n: result[n] for n in result})


@pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")
def test_exported(tmp_path):
    """The machine in C says the same in every column."""
    stribeck.export(Scenario(MACHINE), "c", tmp_path)
    source, run = [str(tmp_path / f) for f in ("machine.c", "machine_run.c")], str(tmp_path / "run")
    subprocess.run(["cc", "-std=c99", "-O1", *source, "-o", run, "-lm"], check=True)
    head, *rows = subprocess.run([run], capture_output=True, text=True, check=True).stdout.splitlines()
    theirs, result = np.array([[float(x) for x in row.split(",")] for row in rows]).T, simulate(MACHINE)
    for name, column in zip(head.split(","), theirs, strict=True):
        np.testing.assert_allclose(column, result[name], rtol=0, atol=1e-6 * np.max(abs(result[name])), err_msg=name)


def test_sums_are_sums():
    """Of all kinds and of sums; where the rate changes its sign."""
    table = Sum(
        (Sine(1.0, 2.0), Square(0.5, 3.0, 4), Ramp(0.3), Staircase((1.0, 2.0, 0.5), 0.2, 0.05), Sum((Sine(0.2, 5.0),)))
    )
    signal, t = table.built, np.linspace(0, 2, 1001)
    parts = sum(each.built.at(t) for each in table.of)
    np.testing.assert_allclose(signal.at(t), parts, atol=1e-14)
    assert signal.longest_step == Sine(0.2, 5.0).built.longest_step
    two = Sum((Sine(1.0, 1.0), Sine(0.5, 1.0))).built  # 1.5 sin(2 pi t)
    np.testing.assert_allclose(two.turns(1.0), [0.25, 0.75], atol=1e-12)


def test_a_controller_follows_a_sum():
    """Two halves of a sine are followed as the sine is, by feedforward and by compensation, whose direction turns with it."""

    def run(signal):
        own = {"kind": "cascade", "on": "a", "K_p": 20.0, "K_v": 40.0, "feedforward": {"inertia": 1.0}, "signal": signal,
               "compensation": {"contact": "c", "speed": "reference"}}  # fmt: skip
        return simulate({n: x for n, x in MACHINE.items() if n not in ("loads", "links")} | {"controllers": {"u": own}})

    half = {"kind": "sine", "amplitude": 0.005, "frequency": 1.0}
    whole, both = run({**half, "amplitude": 0.01}), run({"kind": "sum", "of": [half, half]})
    for name in ("a.y", "a.v", "c.F", "u.u"):
        np.testing.assert_allclose(both[name], whole[name], rtol=0, atol=1e-6 * np.max(abs(whole[name])), err_msg=name)
