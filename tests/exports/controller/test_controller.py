"""A machine's controller on its target: the same bits as the simulation, on this processor and on another."""

import re

import numpy as np
import pytest

import stribeck
from stribeck.errors import StribeckNote
from stribeck.exports.controller.block import block_of
from tests.exports.controller.stages import CASES, stage
from tests.exports.harness import need, output_of

DRIVER = r"""
#include <stdio.h>
#include "stage_axis.h"
int main(void)
{
    stage_axis_parameters p;
    stage_axis_state s;
    stage_axis_input in = {0};
    stage_axis_output o;
    double y, k = 0;
    stage_axis_defaults(&p);
    stage_axis_reset(&s);
    for (; scanf("%la", &y) == 1; k++) {
        in.y = y;
        if (stage_axis_path_at(&p, k * 1e-3, &in) || stage_axis_step(&p, &s, &in, &o)) return 1;
        printf("%a\n", o.u);
    }
    return 0;
}
"""
HERE, ARM = (("gcc",), ()), (("arm-linux-gnueabihf-gcc", "-static"), ("qemu-arm",))


def readings(run):
    """What the encoder read at each sample."""
    return np.floor(np.asarray(run["a.y"]) / 1e-6 + 0.5) * 1e-6


@pytest.mark.share(3)
@pytest.mark.parametrize("target", [HERE, ARM], ids=["here", "arm"])
@pytest.mark.parametrize("case", CASES)
def test_processor_in_the_loop(case, target, tmp_path):
    """Fed with what the simulated encoder read, the exported C puts out what the simulated controller did, to the bit: put
    in its place it would therefore move the machine to the bit the same."""
    (cc, *static), run = target
    need(cc, *run)
    scenario = stage(case)
    with pytest.warns(StribeckNote, match="act 0.0005 s after the sample"):
        stribeck.export(scenario, "c", tmp_path, part="controller")
    (tmp_path / "driver.c").write_text(DRIVER)
    simulated = stribeck.simulate(scenario)
    given = "\n".join(float(y).hex() for y in readings(simulated))
    printed = output_of(tmp_path, "stage_axis.c", "driver.c", cc=cc, flags=(*static, "-O2"), run=run, given=given)
    result = np.array([float.fromhex(line) for line in printed.split()])
    acting = np.asarray(simulated["axis.u"])[1:]  # an output begins to act half a period after its sample
    assert len(result) == 401
    assert len(set(acting.tolist())) > 200
    assert result[:-1].tolist() == acting.tolist()


@pytest.mark.share(5)
@pytest.mark.parametrize("part", ["controller", "compensator"])
@pytest.mark.parametrize("case", ["measured", "reference", "elastic", "filtered", "dithered", "square"])
def test_self_test(case, part, tmp_path):
    """Without a warning, in double and in single precision; no allocation."""
    need("gcc")
    if part == "compensator" and "compensation" not in CASES[case]:
        with pytest.raises(stribeck.InputError, match="compensation: missing"):
            stribeck.export(stage(case), "c", tmp_path / "out", part=part)
        assert not (tmp_path / "out").exists()
        return
    files = stribeck.export(stage(case), "c", tmp_path, part=part, self_test=True)
    name = files[0].stem
    for define in ("-DDOUBLE", f"-D{name.upper()}_FLOAT"):
        sources = [f for f in files if f.suffix == ".c"]
        assert "all checks passed" in output_of(tmp_path, *sources, flags=("-O1", define))
    text = "".join(f.read_text() for f in files)
    assert "malloc" not in text
    assert re.search(r"One sample takes at most \d", text)
    assert not re.search(r"takes at most .*\b1 (\w+s\b|calls)", text)


@pytest.mark.parametrize("fmi", [2, 3])
def test_fmu(fmi, tmp_path):
    """One communication step is one sample: the first outputs of a replay are those of the block's equations."""
    need("gcc")
    fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed")
    from fmpy.validation import validate_fmu

    (path,) = stribeck.export(stage("filtered"), "fmu", tmp_path / "axis.fmu", part="controller", fmi=fmi)
    assert validate_fmu(str(path)) == []
    for period in (1e-3, 2e-3):  # whatever the file's is
        run = stribeck.simulate(
            stage("filtered").with_changes({"controllers.axis.sampling.period": period, "output.step": period})
        )
        y = readings(run)
        given = np.zeros(len(y), dtype=[("time", float), ("r", float), ("y", float)])
        given["time"], given["r"], given["y"] = run.t, run["axis.r"], y
        solution = fmpy.simulate_fmu(str(path), stop_time=0.3, output_interval=period, input=given, output=["u"])
        shown = np.asarray(solution["u"])[1:]
        expected = np.asarray(run["axis.u"])[1 : len(shown) + 1]
        assert np.abs(shown - expected).max() <= 1e-9 * np.abs(expected).max()
    with pytest.raises(fmpy.fmi1.FMICallException):  # what is computed cannot be set
        fmpy.simulate_fmu(str(path), stop_time=0.01, output_interval=1e-3, start_values={"u": 1.0})


def test_a_constant_that_no_controller_may_have_is_named(tmp_path):
    need("gcc")
    stribeck.export(stage("filtered"), "c", tmp_path, part="controller")
    constants = block_of(stage("filtered"), "controller").constants
    above = [name for name, (constant, _, _) in constants.items() if constant.above is not None]
    lines = "".join(
        f"    stage_axis_defaults(&p), p.{n} = -1;\n    if (stage_axis_check(&p) != stage_axis_BAD_{n}) return 1;\n"
        for n in above
    )
    text = '#include "stage_axis.h"\nint main(void)\n{\n    stage_axis_parameters p;\n%s    return 0;\n}\n'
    (tmp_path / "check.c").write_text(text % lines)
    assert above
    assert output_of(tmp_path, "stage_axis.c", "check.c") == ""


def test_a_table_of_the_compensation(tmp_path):
    scenario = stage("measured")
    (path,) = stribeck.export(scenario, "table", tmp_path / "f.csv", part="compensator")
    v, F = np.loadtxt([x for x in path.read_text().splitlines() if x[:1] not in "#v"], delimiter=",").T
    steady = scenario.elements.laws["contacts.guide.law"].steady_force(v)
    assert np.abs(F - 0.8 * steady).max() <= 0.02 * F.max()


def test_a_continuous_controller_says_how_its_export_is_simulated():
    assert block_of(stage("reference", sampling=None), "compensator").step == 0  # no state, no sample
    sampled = block_of(stage("measured", sampling=None), "controller", step=1e-3)
    assert "to simulate the exported one, set sampling = " in sampled.notes()[0]
