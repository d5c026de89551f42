"""Whole machines in C and as FMUs against the simulation; laws of their contacts."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

import stribeck
from stribeck import Scenario, simulate
from stribeck.errors import StribeckNote
from stribeck.exports.fmu import binaries
from stribeck.simulation.promise import sampled_share
from tests.exports.harness import SANITIZE, need, output_of
from tests.exports.test_fmu import Exchanged
from tests.exports.test_loads import RIG
from tests.machine.machines import assert_balanced, edited, law, machine
from tests.machine.test_servo import SAMPLED, SERVO, as_machine

SAMPLING = {"period": 4e-3, "delay": 9e-3, "resolution": 1e-4, "noise": 1e-4, "seed": 3}
EVERY = Path(__file__).with_name("every_kind.toml")


@pytest.fixture(autouse=True)
def _this_platform_only(monkeypatch):
    monkeypatch.setattr(binaries, "_FLAGS", ("-std=c99", "-O0", "-shared", "-fvisibility=hidden"))  # each is run once


@pytest.fixture(scope="module")
def scenario():
    return Scenario.load(EVERY)


@pytest.fixture(scope="module")
def exact(scenario):
    return simulate(scenario)


def close(found, exact, share=1e-6):
    for name in exact:
        if name != "t":
            size = max(np.max(np.abs(exact[name])), 1e-12)
            assert np.max(np.abs(found[name] - exact[name])) <= share * size, name


@pytest.mark.parametrize("cc", ["gcc", "clang"])
def test_c(cc, scenario, exact, tmp_path):
    files = stribeck.export(scenario, "c", tmp_path)
    assert sorted(f.name for f in files) == ["machine.c", "machine.h", "machine_run.c"]
    result = table(output_of(tmp_path, "machine.c", "machine_run.c", cc=cc, flags=("-O1",)))
    close(result, exact)
    assert_balanced(result)


def test_with_the_same_steps_c_is_the_simulation(tmp_path):
    """Each row of the program ends a step, and simulate reads its rows off the steps' polynomials: rows agree as the
    tolerance says. One advance to the end makes the simulation's own steps, and agrees but for rounding."""
    run = simulate(RIG)
    stribeck.export(RIG, "c", tmp_path, part="machine")
    end = repr(float(RIG.end))
    for times, share in (([end, end], 1e-9), ([], 1e-6)):
        result = table(output_of(tmp_path, *tmp_path.glob("*.c"), flags=("-O0",), words=times))
        for column in (c.name for c in run.columns):
            exact = np.asarray(run[column])
            assert abs(result[column][-1] - exact[-1]) <= share * max(np.abs(exact).max(), 1e-12), column


_ODD = """
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "machine.h"
int main(void)
{
    const double odd[] = {NAN, INFINITY, -INFINITY};
    machine_machine *m = malloc(machine_size());
    for (int place = -1; place < MACHINE_STATES; place++)
        for (int i = 0; i < 3; i++)
            for (int later = 0; later < 2; later++) {
                const double t = place < 0 ? NAN : later ? 0.01 : 0;
                machine_start(m);
                if (place >= 0) machine_states(m)[place] = odd[i];
                if (machine_advance(m, t) != MACHINE_NOT_FINITE) printf("%d %d %g\\n", place, i, t);
            }
    machine_start(m);
    for (int i = 1; i <= 2; i++) {
        double row[MACHINE_COLUMNS];
        const int status = machine_advance(m, i * 0.07);
        machine_columns(m, row);
        printf("%d %d\\n", status, fabs(row[MACHINE_q_u]) > 1e-9);
    }
    free(m);
    return 0;
}
"""


def test_times_and_states_that_are_no_numbers(tmp_path):
    """A time that is nan was done, and so was every state that is none where no step was made, an energy in any case.

    Readings of what hardly moves are their noise, which ends with the file's simulation."""
    hold = {"kind": "pid", "on": "a", "K_p": 20.0, "signal": {"kind": "ramp", "rate": 0.0}}
    hold["sampling"] = SAMPLING | {"resolution": 0.0}
    contact = {"from": "a", "law": law("lugre")}
    bodies, both = {"a": {"mass": 1e9}, "b": {"mass": 1e9}}, {"q": hold, "r": hold | {"on": "b"}}
    one = machine(bodies, t_end=0.1, contacts={"s": contact}, controllers=both)
    with pytest.warns(StribeckNote, match=r"noise is exported up to t = 0\.1 s; later readings have none"):
        stribeck.export(Scenario(one), "c", tmp_path)
    (tmp_path / "odd.c").write_text(_ODD)
    assert output_of(tmp_path, "machine.c", "odd.c", flags=("-O0", *SANITIZE)) == "0 1\n0 0\n"


def table(text):
    """Columns of a CSV by name."""
    head, *rows = text.strip().split("\n")
    values = np.array([[float(x) for x in row.split(",")] for row in rows])
    return dict(zip(head.split(","), values.T, strict=True))


def changes(path, fmi, until):
    """Whether each event tells that it changed states, and whether it did, of an FMU whose states do not move between."""
    model, t, result = Exchanged(path, fmi), 0.0, []
    model.reach("enterContinuousTimeMode")
    size = len(model.of.derivatives)
    before, after = np.empty((2, size))
    happen = model.fmu.newDiscreteStates if fmi == 2 else model.fmu.updateDiscreteStates
    while t < until:
        model.fmu.getContinuousStates(np.ctypeslib.as_ctypes(before), size)
        *_, reported, _, t = happen()
        model.fmu.getContinuousStates(np.ctypeslib.as_ctypes(after), size)
        result.append((bool(reported), not np.array_equal(before, after)))
        model.fmu.enterContinuousTimeMode()
        model.fmu.setTime(t)
        model.fmu.enterEventMode()
    return [list(column) for column in zip(*result, strict=True)]


@pytest.mark.share(4)
@pytest.mark.parametrize("fmi", [2, 3])
def test_fmu(fmi, scenario, exact, tmp_path):
    need("gcc")
    fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed")
    from fmpy.validation import validate_fmu

    (path,) = stribeck.export(scenario, "fmu", tmp_path / "machine.fmu", fmi=fmi)
    assert validate_fmu(str(path)) == []
    names = [c.name for c in exact.columns]
    times = {"stop_time": 0.5, "output_interval": scenario.output.step, "output": names}
    solution = fmpy.simulate_fmu(str(path), **times)
    close({n: solution[n] for n in names}, exact)
    assert_balanced(solution)
    exchanged = fmpy.simulate_fmu(
        str(path), **times, fmi_type="ModelExchange", solver="CVode", relative_tolerance=1e-9, record_events=False
    )
    close({n: exchanged[n] for n in names}, exact)
    reported, changed = changes(path, fmi, until=0.25)
    assert reported == changed
    assert set(reported) == {False, True}
    if fmi == 2:
        return
    # a constant that is changed, and an input, against the same in the file
    inputs = np.array([(0.0, 0.4)], dtype=[("time", float), ("loads.push.signal", float)])
    pushed = scenario.replace({"loads.push": {"on": "a", "kind": "signal", "signal": {"kind": "ramp", "rate": 0.0}}})
    (path,) = stribeck.export(pushed, "fmu", tmp_path / "pushed.fmu", fmi=fmi)
    solution = fmpy.simulate_fmu(
        str(path), **times, input=inputs, start_values={"contacts.s.law.F_c": 0.7, "bodies.a.mass": 0.6}
    )
    constant = {"kind": "points", "t": [0.0], "value": [0.4]}
    other = simulate(
        pushed.replace({"loads.push.signal": constant, "contacts.s.law.parameters.F_c": 0.7, "bodies.a.mass": 0.6})
    )
    close({n: solution[n] for n in names}, {n: other[n] for n in names})
    far = np.array([(0.2, 0.0), (0.2, 0.1)], dtype=[("time", float), ("links.far.from.signal", float)])
    assert_balanced(fmpy.simulate_fmu(str(path), **times, input=far))  # an input that jumps under a stressed link
    with pytest.raises(Exception, match="fmi"):
        fmpy.simulate_fmu(str(path), **times, start_values={"bodies.a.mass": -1.0})


@pytest.fixture(scope="module")
def servo():
    """A pneumatic servo as a machine: sampled, with an observer that adapts."""
    changes = {**SAMPLED, "drive.adaptive": True, "solve.t_end": 0.3}
    return Scenario(as_machine(edited(SERVO, changes)))


@pytest.mark.share(3)
@pytest.mark.parametrize("sampled", [True, False])
def test_c_of_a_pressure_cascade(sampled, servo, tmp_path):
    scenario = servo if sampled else Scenario(as_machine(edited(SERVO, {"solve.t_end": 0.3})))
    stribeck.export(scenario, "c", tmp_path)
    close(table(output_of(tmp_path, *tmp_path.glob("*.c"), flags=("-O1",))), simulate(scenario))
    if sampled:  # the share of a tolerance that a step may take, as in Python
        (name,) = (path.stem.removesuffix("_run") for path in tmp_path.glob("*_run.c"))
        rtol = [1e-4, 1e-6, 1e-7, 1e-8, 1e-10]
        lines = "".join(f'{name}_tolerance(&m, {x!r}); printf("%.17g ", m.run.rtol);' for x in rtol)
        main = f'#include "{name}.c"\n#include <stdio.h>\nstatic struct {name}_machine m; int main(void) {{ {lines} return 0; }}'
        (tmp_path / "asked.c").write_text(main)
        subprocess.run(["gcc", str(tmp_path / "asked.c"), "-o", str(tmp_path / "asked"), "-lm"], check=True)
        process = subprocess.run([str(tmp_path / "asked")], capture_output=True, text=True, check=True).stdout
        assert [float(x) for x in process.split()] == pytest.approx([sampled_share(x) * x for x in rtol], rel=1e-14)


def test_fmu_of_a_pressure_cascade(servo, tmp_path):
    """What a sampled controller remembers is shown between its samples, whoever integrates."""
    need("gcc")
    fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed")
    exact = simulate(servo)
    (path,) = stribeck.export(servo, "fmu", tmp_path / "servo.fmu")
    names = [c.name for c in exact.columns]
    times = {"stop_time": 0.3, "output_interval": servo.output.step, "output": names}
    solution = fmpy.simulate_fmu(str(path), **times)
    close({n: solution[n] for n in names}, exact)
    exchange = {"fmi_type": "ModelExchange", "solver": "CVode", "relative_tolerance": 1e-11, "record_events": False}
    solution = fmpy.simulate_fmu(str(path), **times, **exchange)
    close({n: solution[n] for n in names}, exact)
