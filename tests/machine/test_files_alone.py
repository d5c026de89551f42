"""What a machine file says without Python: springs of two stages, forces by position, sums of signals, an encoder that only
measures; against SciPy on equations written here, and in C."""

import shutil
import subprocess
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stribeck
from stribeck import Scenario, simulate
from stribeck.machine.signal import Ramp, Sine, Square, Staircase, Sum
from tests.machine.machines import assert_balanced

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
    "links": {"k": {"kind": "spring", "from": "a", "to": "ground", "stiffness": 50.0, "damping": 1.0, "preload": 0.3,
                    "reach": 0.01, "second": 300.0}},
    "contacts": {"c": {"from": "a", "law": {"name": "lugre", "parameters": LAW}}},
    "loads": {"p": {"on": "a", "kind": "signal", "signal": SIGNAL},
              "q": {"on": "a", "kind": "by_position", "position": [-0.02, 0.0, 0.03], "value": [1.0, -0.5, -2.0]}},
    "sensors": {"e": {"on": "a", "kind": "encoder", "resolution": 1e-3, "ratio": 2.0, "offset": 1e-4}},
    "solve": {"t_end": 2.0}, "output": {"step": 1e-2, "energy": True},
}  # fmt: skip


def apart():
    """Rows of y and v by SciPy's Radau, restarted at each breakpoint of the signal."""
    breaks = sorted({0.0, *(k / 6 for k in range(9)), 0.2, 0.25, 0.45, 0.5, 2.0})

    def rates(t, x):
        y, v, z = x
        square = 0.0 if t >= 4 / 3 else 1.0 if (3 * t) % 1 < 0.5 else -1.0
        force = 6 * np.sin(4 * np.pi * t) + square + np.interp(t, [0.2, 0.25, 0.45, 0.5], [0, 1, 1, 2])
        force += np.interp(y, [-0.02, 0, 0.03], [1, -0.5, -2])
        force -= 0.3 + 50 * y + 250 * (y - np.clip(y, -0.01, 0.01)) + v
        dz = v - abs(v) * 1e4 / (1 + 0.5 * np.exp(-((v / 1e-2) ** 2))) * z
        return [v, force - 1e4 * z - 30 * dz - 0.4 * v, dz]

    x, rows = [0.0, 0.0, 0.0], [[0.0, 0.0, 0.0]]
    for begin, end in pairwise(breaks):
        t = np.clip([t for t in np.arange(201) * 1e-2 if begin + 1e-9 < t <= end + 1e-9], begin, end)

        def within(t, x, low=begin + 1e-13, high=end - 1e-13):
            return rates(min(max(t, low), high), x)

        found = solve_ivp(within, (begin, end), x, method="Radau", rtol=1e-9, atol=1e-13, dense_output=True)
        rows += list(found.sol(t).T) if len(t) else []
        x = found.y[:, -1]
    return np.array(rows)


def test_against_scipy():
    found, expected = simulate(MACHINE), apart()
    for name, theirs in (("a.y", expected[:, 0]), ("a.v", expected[:, 1])):
        assert np.max(abs(found[name] - theirs)) <= 1e-6 * np.max(abs(theirs))
    assert_balanced({n: found[n] for n in found})
    counts = np.floor((2 * found["a.y"] + 1e-4) / 1e-3 + 0.5)
    np.testing.assert_allclose(found["e.reading"], 1e-3 * counts, rtol=0, atol=1e-15)
    assert len(np.unique(counts)) > 30


LADEN = {
    "schema": 2, "name": "machine",
    "bodies": {"a": {"kind": "laden", "mass": 1.0,
                     "added": {"kind": "points", "t": [0, 0.3, 0.3, 0.6, 0.8], "value": [0, 0, 0.3, 0.3, 0.1]}},
               "b": {"kind": "laden", "mass": 0.2, "tied_to": "a", "ratio": 2.0,
                     "added": {"kind": "points", "t": [0, 0.3, 0.3, 0.6, 0.8], "value": [0, 0, 0.05, 0.05, 0]}}},
    "contacts": {"c": {"from": "a", "law": {"name": "lugre", "parameters": LAW}}},
    "loads": {"p": {"on": "a", "kind": "signal", "signal": {"kind": "sine", "amplitude": 6.0, "frequency": 1.0}}},
    "solve": {"t_end": 1.2}, "output": {"step": 1e-2, "energy": True},
}  # fmt: skip


def test_a_mass_that_varies():
    """M dv/dt = F with the mass of each instant; what comes on brings its energy along, also at once."""
    found, x, rows = simulate(LADEN), [0.0, 0.0, 0.0], [[0.0, 0.0, 0.0]]

    def rates(t, x, low, high):
        t, (_, v, z) = min(max(t, low + 1e-13), high - 1e-13), x
        mass = 1.8 + (0.0 if t < 0.3 else np.interp(t, [0.6, 0.8], [0.5, 0.1]))
        dz = v - abs(v) * 1e4 / (1 + 0.5 * np.exp(-((v / 1e-2) ** 2))) * z
        return [v, (6 * np.sin(2 * np.pi * t) - 1e4 * z - 30 * dz - 0.4 * v) / mass, dz]

    for ends in pairwise((0.0, 0.3, 0.6, 0.8, 1.2)):
        t = np.clip([t for t in found.t if ends[0] + 1e-9 < t <= ends[1] + 1e-9], *ends)
        theirs = solve_ivp(rates, ends, x, method="Radau", rtol=1e-9, atol=1e-13, dense_output=True, args=ends)
        rows, x = [*rows, *theirs.sol(t).T], theirs.y[:, -1]
    for i, name in enumerate(("a.y", "a.v")):
        expected = np.array(rows)[:, i]
        assert np.max(abs(found[name] - expected)) <= 1e-7 * np.max(abs(expected))
    assert_balanced({n: found[n] for n in found})


@pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")
@pytest.mark.parametrize("data", [MACHINE, LADEN], ids=["machine", "laden"])
def test_exported(data, tmp_path):
    """The machine in C says the same in every column."""
    stribeck.export(Scenario(data), "c", tmp_path)
    source, run = [str(tmp_path / f) for f in ("machine.c", "machine_run.c")], str(tmp_path / "run")
    subprocess.run(["cc", "-std=c99", "-O1", *source, "-o", run, "-lm"], check=True)
    head, *rows = subprocess.run([run], capture_output=True, text=True, check=True).stdout.splitlines()
    theirs, found = np.array([[float(x) for x in row.split(",")] for row in rows]).T, simulate(data)
    for name, column in zip(head.split(","), theirs, strict=True):
        np.testing.assert_allclose(column, found[name], rtol=0, atol=1e-6 * np.max(abs(found[name])), err_msg=name)


def test_sums_are_sums():
    """Of all kinds and of sums; where the rate changes its sign, and where a level is passed."""
    table = Sum(
        (Sine(1.0, 2.0), Square(0.5, 3.0, 4), Ramp(0.3), Staircase((1.0, 2.0, 0.5), 0.2, 0.05), Sum((Sine(0.2, 5.0),)))
    )
    signal, t = table.built, np.linspace(0, 2, 1001)
    parts = sum(each.built.at(t) for each in table.of)
    np.testing.assert_allclose(signal.at(t), parts, atol=1e-14)
    assert signal.longest_step == Sine(0.2, 5.0).built.longest_step
    two = Sum((Sine(1.0, 1.0), Sine(0.5, 1.0))).built  # 1.5 sin(2 pi t)
    np.testing.assert_allclose(two.turns(1.0), [0.25, 0.75], atol=1e-12)
    found = two.crossings(0.75, 1.0)
    np.testing.assert_allclose([t for t, _ in found], np.array([1, 5, 7, 11]) / 12, atol=1e-12)
    assert [rises for _, rises in found] == [True, False, True, False]
    jumps = Sum((Square(1.0, 1.0, 1), Square(1.0, 1.0, 1))).built
    assert jumps.crossings(1.5, 2.0) == [(1.0, False)]


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


def test_a_link_leads_to_the_ground_unless_it_says_where():
    """As a contact does."""
    link = {"from": "slide", "stiffness": 100.0}
    data = {
        "schema": 2, "bodies": {"slide": {"mass": 1.0, "initial": {"y": 0.1}}}, "links": {"spring": link},
        "solve": {"t_end": 1.0}, "output": {"step": 0.1},
    }  # fmt: skip
    said = {**data, "links": {"spring": {**link, "to": "ground"}}}
    np.testing.assert_array_equal(simulate(data)["slide.y"], simulate(said)["slide.y"])
