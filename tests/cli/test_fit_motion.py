"""``stribeck fit --output``: the motion for a measured force, and in a closed loop."""

import json

import numpy as np
import pytest

from stribeck import Scenario, simulate
from tests.simulation.rig import needs_compiler

MACHINE = {"sigma_0": 1e5, "sigma_1": 3e2, "sigma_2": 30.0, "F_c": 10.0, "F_s": 14.0, "v_s": 5e-3}
LOOP = "pid:K_p=3000,K_i=2000,K_d=100"


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    t = np.arange(0, 2.4, 2e-3)
    command = 0.02 * np.sin(2 * np.pi * 0.8 * t)
    solution = simulate(
        Scenario(
            law={"name": "lugre", "parameters": MACHINE},
            plant={"mass": 2.0},
            drive={
                "kind": "pid", "K_p": 3000.0, "K_i": 2000.0, "K_d": 100.0,
                "signal": {"kind": "points", "t": t.tolist(), "value": command.tolist()},
            },
            solve={"t_end": float(t[-1])},
            output={"step": 2e-3},
        )
    )  # fmt: skip
    path = tmp_path_factory.mktemp("record") / "loop.csv"
    columns = np.column_stack([t, solution["y"], solution["v"], solution["u"], command])
    np.savetxt(path, columns, "%.12g", ",", header="t,y,v,u,r", comments="")
    return path


@needs_compiler
@pytest.mark.share(2)
@pytest.mark.parametrize(
    "options", [("--output", "position", "--drive", LOOP, "--command", "r"), ("--output", "velocity", "--mass", 2)]
)
def test_the_parameters_are_found(stribeck, record, options):
    columns = ("--time", "t", "--position", "y", "--velocity", "v", "--force", "u", "--cutoff", 0)
    outcome = stribeck("fit", record, "--law", "lugre", *columns, *options, "--starts", 2, "--json")
    assert outcome.status == 0, outcome.err
    found = json.loads(outcome.out)["parameters"]
    for name in ("sigma_2", "F_c", "F_s"):
        assert found[name]["value"] == pytest.approx(MACHINE[name], rel=0.02), name


@needs_compiler
@pytest.mark.parametrize(
    ("options", "line"),
    [
        (("--output", "position", "--drive", LOOP), "drive.kind: 'pid': the log has no column 'command'"),
        (("--output", "heat"), "output: 'heat': must be"),
        (("--drive", LOOP), "--drive: needs --output velocity or position"),
        (("--output", "velocity", "--drive", "pid:K_p", "--command", "r"), "--drive: 'pid:K_p': must be KIND"),
        (("--output", "velocity", "--drive", "pid:K_i=1", "--command", "r"), "drive.K_p: missing"),
        (("--output", "velocity", "--law", "dahl"), "--output: laws are compared by the force"),
        (("--output", "velocity", "--method", "static"), "law 'lugre' has bristles, which a static fit does not see"),
    ],
)
def test_what_makes_no_sense_is_refused(stribeck, record, options, line):
    columns = ("--time", "t", "--position", "y", "--force", "u")
    outcome = stribeck("fit", record, "--law", "lugre", *columns, *options)
    assert outcome.status == 2
    assert line in outcome.err
    assert outcome.out == ""
