"""Explorers of fits: the record drives the scenario, what was measured lies beside it, intervals are on the sliders."""

import json
import re
import shutil

import numpy as np
import pytest

from stribeck import InputError, Scenario, simulate
from stribeck.explore import explorer_page
from stribeck.explore.report import of_folder
from tests.cli.conftest import stribeck  # noqa: F401
from tests.simulation.rig import needs_compiler

pytestmark = needs_compiler
TRUE = {"sigma_0": 1e4, "sigma_1": 30.0, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 0.01}
OFFSET, NOISE = 0.2, 1e-6


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """A body under a force that also carries an offset: position with noise, force."""
    path = tmp_path_factory.mktemp("record") / "log.csv"
    signal = {"kind": "sine", "amplitude": 2.5, "frequency": 1.0}
    found = simulate(
        Scenario(
            law={"name": "lugre", "parameters": TRUE}, plant={"mass": 1.1}, drive={"kind": "force", "signal": signal},
            solve={"t_end": 4.0}, output={"step": 0.004},
        )
    )  # fmt: skip
    noise = NOISE * np.random.default_rng(1).standard_normal(len(found.t))
    columns = np.c_[found.t, found["y"] + noise, found["v"], found["u"] + OFFSET]
    np.savetxt(path, columns, delimiter=",", header="t,y,v,u", comments="", fmt="%.12g")
    return path


def fitted(stribeck, record, out, *more):  # noqa: F811
    words = ("--time", "t", "--position", "y", "--velocity", "v", "--force", "u", "--mass", "1.1")
    assert stribeck("fit", record, *words, *more, "--out", out).status == 0
    return out


def test_a_fitted_motion_runs_under_the_measured_force(stribeck, record, tmp_path):  # noqa: F811
    sought = ("--method", "dynamic", "--output", "position", "--law", "lugre", "--starts", "2")
    given = [f"{n}={x}" for n, x in TRUE.items() if n not in ("F_c", "sigma_2")]
    folder = fitted(stribeck, record, tmp_path / "fit", *sought, *(w for g in given for w in ("--set", g)))
    found = of_folder(folder, {}, trust=False)
    low, high = found.intervals["law.parameters.F_c"]
    assert low < found.scenario.law.machine["F_c"] < high
    _, y = found.measured.columns["y"]
    assert np.sqrt(np.mean((simulate(found.scenario)["y"][: len(y)] - y) ** 2)) < 4 * NOISE
    assert found.measured.given == ()


def test_a_static_fit_runs_along_the_measured_motion(stribeck, record, tmp_path):  # noqa: F811
    folder = fitted(stribeck, record, tmp_path / "fit", "--law", "coulomb_viscous", "--no-forms")
    found = of_folder(folder, {}, trust=False)
    assert found.measured.given == ("y", "v")
    friction, moving = found.measured.columns["F"][1], abs(found.measured.columns["v"][1]) > 0.05
    shown = simulate(found.scenario)["F"]
    assert np.std(shown[moving] - friction[moving]) < 0.1 * np.std(friction)
    assert (
        abs(np.mean(friction[moving & (shown > 0)]) + np.mean(friction[moving & (shown < 0)])) < 0.1
    )  # no offset left


def test_a_record_that_is_gone_is_one_line(stribeck, record, tmp_path):  # noqa: F811
    copy = tmp_path / "copy.csv"
    shutil.copy(record, copy)
    folder = fitted(stribeck, copy, tmp_path / "fit", "--law", "coulomb_viscous", "--no-forms")
    copy.unlink()
    found = stribeck("explore", "--report", folder)
    assert found.status == 2
    assert "copy.csv" in found.err
    assert found.err.count("\n") == 1
    kept = json.loads((folder / "fit.json").read_text())
    kept["files"] = []  # of a table in memory
    (folder / "fit.json").write_text(json.dumps(kept))
    with pytest.raises(InputError, match="must be fitted from a file"):
        of_folder(folder, {}, trust=False)


@pytest.mark.thorough
def test_a_fitted_machine_is_shown_in_its_first_recording(stribeck, tmp_path):  # noqa: F811
    import tomli_w

    from tests.identify.actuator.recorded import NOISE as ENCODER
    from tests.identify.actuator.recorded import body, logs, record

    truth = body()

    def shifted(table):
        return table | {"y": table["y"] + 0.003}

    record(tmp_path / "a.csv", truth, change=shifted)
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(truth))
    sought = {
        "contacts.guide.law.parameters.F_c": {"low": 0.5, "high": 2.0},
        "outputs.a.y.offset": {"low": -0.1, "high": 0.1},
    }
    listed = logs(tmp_path, ["a.csv"], sought)
    words = ("--logs", listed, "--starts", "1", "--out", tmp_path / "fit")
    assert stribeck("fit", tmp_path / "axis.toml", *words).status == 0
    found = of_folder(tmp_path / "fit", {}, trust=False)
    _, y = found.measured.columns["a.y"]
    assert (
        np.sqrt(np.mean((simulate(found.scenario)["a.y"] - y) ** 2)) < 1.3 * ENCODER
    )  # the sensor's offset is taken off
    low, high = found.intervals["contacts.guide.law.parameters.F_c"]
    assert low < 1.0 < high
    pytest.importorskip("bokeh")
    text = explorer_page(found.scenario, fitted=found.intervals, beside=found.measured)
    data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)[1])
    assert data["measured"]["columns"]["a.y"]["t"] == pytest.approx(0.01)
    assert {n["path"]: n["interval"] for n in data["numbers"]}["contacts.guide.law.parameters.F_c"] == [low, high]
    assert not any(".signal." in n["path"] for n in data["numbers"])  # a record is no set of numbers to turn


@pytest.mark.parametrize("at", [0.0, 0.05])
def test_a_fitted_machine_begins_as_its_recording_did(stribeck, tmp_path, at):  # noqa: F811
    """As the fit took it or found it: the first samples alone tell it too roughly."""
    import tomli_w

    from tests.identify.actuator.recorded import NOISE as ENCODER
    from tests.identify.actuator.recorded import body, logs, record

    truth = body()
    truth["bodies"]["a"]["initial"] = {"y": at}
    record(tmp_path / "a.csv", truth)
    del truth["bodies"]["a"]["initial"]
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(truth))
    listed = logs(tmp_path, ["a.csv"], {"contacts.guide.law.parameters.F_c": {"low": 0.5, "high": 2.0}})
    words = ("--logs", listed, "--starts", "1", "--out", tmp_path / "fit")
    assert stribeck("fit", tmp_path / "axis.toml", *words).status == 0
    found = of_folder(tmp_path / "fit", {}, trust=False)
    _, y = found.measured.columns["a.y"]
    assert np.sqrt(np.mean((simulate(found.scenario)["a.y"] - y) ** 2)) < 1.3 * ENCODER


@pytest.mark.thorough
def test_what_was_found_of_the_first_recording_alone_is_shown_with_it(stribeck, tmp_path):  # noqa: F811
    import tomli_w

    from tests.identify.actuator.recorded import NOISE as ENCODER
    from tests.identify.actuator.recorded import body, logs, record

    gain, offset, start = 1.25, 0.003, 0.2
    truth = body()
    truth["bodies"]["a"]["initial"] = {"y": 0.0, "v": start}
    record(tmp_path / "a.csv", truth, change=lambda x: x | {"y": x["y"] + offset, "u": x["u"] / gain})
    record(tmp_path / "b.csv", body(), seed=1)
    del truth["bodies"]["a"]["initial"]["v"]
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(truth))
    sought = {
        "contacts.guide.law.parameters.F_c": {"low": 0.5, "high": 2.0},
        "log.0.loads.push.gain": {"low": 0.8, "high": 2.0},
        "log.0.outputs.a.y.offset": {"low": -0.1, "high": 0.1},
        "log.*.initial.a.v": {"low": -1.0, "high": 1.0},
    }
    listed = logs(tmp_path, ["a.csv", "b.csv"], sought)
    words = ("--logs", listed, "--starts", "1", "--out", tmp_path / "fit")
    assert stribeck("fit", tmp_path / "axis.toml", *words).status == 0
    found = of_folder(tmp_path / "fit", {}, trust=False)
    _, y = found.measured.columns["a.y"]
    assert abs(y[0]) < 5 * ENCODER
    assert np.sqrt(np.mean((simulate(found.scenario)["a.y"] - y) ** 2)) < 1.3 * ENCODER
    low, high = found.intervals["loads.push.gain"]
    assert low < gain < high
    assert "bodies.a.initial.v" in found.intervals


@pytest.mark.parametrize(
    ("estimates", "said"),
    [
        (3, "estimates: 3: must be a table of estimates"), ({"m": 3}, "a table with m: must be a table of estimates"),
        ({"m": {"estimate": 1.0}}, "a table with m: must be a table of estimates"),
    ],
)  # fmt: skip
def test_numbers_that_no_fit_wrote_are_refused_in_a_line(estimates, said, tmp_path):
    """They were tracebacks."""
    common = {"format": 5, "kind": "machine", "status": "done", "notes": [], "reason": "", "name": "axis", "levels": {}}
    own = {"correlated": [], "logs": [], "noise": {}, "baselines": {}, "laws": None, "source": "logs.toml"}
    (tmp_path / "fit.json").write_text(json.dumps({**common, **own, "estimates": estimates}))
    (tmp_path / "parameters.toml").write_text("")
    (tmp_path / "machine.toml").write_text("schema = 2\n")
    with pytest.raises(InputError) as error:
        of_folder(tmp_path, {}, trust=False)
    assert len(error.value.problems) == 1
    assert str(error.value).endswith(said)
