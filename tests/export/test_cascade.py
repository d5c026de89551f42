"""The cascade controller in C and as an FMU, against the sampled simulation, and in its place in the loop."""

import ctypes
import json
import subprocess

import numpy as np
import pytest

import stribeck
from stribeck import examples
from stribeck.cli import _status
from stribeck.control import sampled
from stribeck.export.c.cascade import INPUTS, OUTPUTS, PATH, ControllerCode
from stribeck.export.c.selftest import sampled as expected
from stribeck.export.fmu import binaries
from stribeck.export.request import Request
from tests.export.harness import SANITIZE, STRICT, need

EPS, EPS_FLOAT = 2.0**-52, 2.0**-23
MOVE = {"kind": "point_to_point", "t": [0.1, 1.0, 1.8], "value": [0.5, 0.6, 0.45]}
WRONG = {"sigma_0": 3000.0, "F_c": 25.0, "F_s": 30.0, "sigma_2": 60.0}
CASES = {
    "sine": {},
    "adaptive": {"drive.adaptive": True, "drive.observer.parameters": WRONG, "drive.model": {"mass": 3.5}},
    "move": {"drive.signal": MOVE, "drive.observer": {"name": "lugre_majorant", "k_v": 1e5, "v_d": 1.0}},
    "elastoplastic": {"drive.observer": {"name": "elastoplastic_majorant", "k_v": 1e6, "z_ba": 4e-3}},
    "static": {"drive.observer": {"name": "coulomb_viscous", "k_v": 1e3}},
    "none": {"drive.observer": {"name": "none"}, "drive.supply_droop": 2e7},
}


@pytest.fixture(autouse=True)
def _this_platform_only(monkeypatch):
    monkeypatch.setattr(binaries, "_ACROSS", ())


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("cascade")


def rig(case="sine", **more):
    changes = {"drive.sample_time": 1e-3, "solve.t_end": 2.0, **CASES[case], **more}
    return stribeck.Scenario.load(examples.path("servo")).with_changes(changes)


def cascade(case):
    chosen = rig(case)
    return ControllerCode(Request(chosen.settings.observer or chosen.law, "cascade", chosen))


class Controller:
    """The C of a case as a library; each struct of it is an array of its members."""

    def __init__(self, case, folder, single=False):
        need("gcc")
        self.of, self.real = cascade(case), np.float32 if single else np.float64
        name, out = self.of.name, folder / case
        if not out.exists():
            stribeck.export(None, "c", out, part="cascade", scenario=rig(case), self_test=True)
        library = out / f"single{single}.so"
        command = ["gcc", *STRICT, "-O2", "-fPIC", "-shared", f"-D{name.upper()}_FLOAT" if single else "-DDOUBLE"]
        subprocess.run([*command, str(out / f"{name}.c"), "-o", str(library), "-lm"], check=True)
        self.call, self.name = ctypes.CDLL(str(library)), name
        self.c = ctypes.c_float if single else ctypes.c_double
        self.parameters = np.zeros(sum(map(len, self.of.constants.values())), self.real)
        self.f("defaults", self.parameters)
        assert self.f("check", self.parameters) == 0

    def f(self, function, *arguments):
        given = [a.ctypes.data_as(ctypes.c_void_p) if isinstance(a, np.ndarray) else self.c(a) for a in arguments]
        return getattr(self.call, f"{self.name}_{function}")(*given)

    def state(self):
        x = np.full(max(len(self.of.states), 1), 7.0, self.real)
        self.f("reset", x)
        return x

    def sample(self, x, path, measured, dt):
        """Status and outputs of one sample; ``path`` is an array of four, or a time."""
        out = np.zeros(len(OUTPUTS), self.real)
        if isinstance(path, float):
            status = self.f("step", self.parameters, x, path, np.array(measured, self.real), dt, out)
        else:
            status = self.f(
                "track", self.parameters, x, np.array(path, self.real), np.array(measured, self.real), dt, out
            )
        return status, out


def recorded(scenario, monkeypatch):
    """What the controller of a sampled simulation was given and computed at each sample, and the run."""
    rows, original = [], sampled.SampledCascade.sample

    def sample(self, period, path, measured):
        before = list(self.x)
        rows.append((before, measured, original(self, period, path, measured), list(self.x)))
        return rows[-1][2]

    monkeypatch.setattr(sampled.SampledCascade, "sample", sample)
    run = stribeck.simulate(scenario)
    monkeypatch.setattr(sampled.SampledCascade, "sample", original)
    assert run.status == "done", run.reason
    return rows, run


@pytest.mark.parametrize(("case", "single"), [*((case, False) for case in CASES), ("sine", True), ("adaptive", True)])
def test_what_the_simulation_computes(case, single, folder, monkeypatch):
    """At every sample of a simulated run, the path included: the same outputs, and the same states afterwards."""
    c, eps = Controller(case, folder, single), EPS_FLOAT if single else EPS
    size, states = expected(c.of), [column.name for column, _ in c.of.states]
    names = [*(f"path.{column.name}" for column in PATH), *(column.name for column in INPUTS), *states]
    rows, _ = recorded(rig(case, **{"solve.t_end": 0.4}), monkeypatch)
    free, worst = 0, 0.0
    for before, (t, *measured), (u, F_hat, p_d, _), after in rows:
        x, path = np.array(before or [0.0], c.real), np.zeros(4, c.real)
        assert c.f("path_at", c.parameters, t, path) == 0
        by_time = c.sample(x.copy(), t, measured, 1e-3)
        status, out = c.sample(x, path, measured, 1e-3)
        assert status == 0
        assert (by_time[1] == out).all()
        spread = [by for _, by in size(dict(zip(names, [*map(float, path), *measured, *before], strict=True)), 1e-3)]
        found, scale = [*out[:3], *x[: len(after)]], np.array([*spread[:3], *spread[5:]])
        off = abs(np.array(found, float) - [u, F_hat, p_d, *after])
        worst = max(worst, *(off / (4 * eps * scale + 1e-300)))
        free += abs(u) < 9.9
    assert len(rows) == 401
    assert free > 100  # not at the valve's limit
    assert 0 < worst <= 1


@pytest.mark.parametrize("case", ["sine", "adaptive", "move"])
def test_in_the_loop(case, folder, monkeypatch):
    """The simulation with the C in the place of its controller goes the same way."""
    exact = stribeck.simulate(rig(case))
    c = Controller(case, folder)
    x = c.state()
    states = [column.name for column, _ in c.of.states]

    def sample(self, period, path, measured):
        before = float(x[0])
        status, out = c.sample(x, float(measured[0]), measured[1:], period)
        assert (status, self.states) == (0, states)
        self.x = list(x)
        return (*map(float, out[:3]), before)

    monkeypatch.setattr(sampled.SampledCascade, "sample", sample)
    found = stribeck.simulate(rig(case))
    assert (exact.status, found.status) == ("done", "done")
    assert found["y"] == pytest.approx(exact["y"], abs=1e-9)
    assert found["u"] == pytest.approx(exact["u"], abs=1e-5)
    assert found["F_hat"] == pytest.approx(exact["F_hat"], abs=1e-5)
    assert abs(found["e"][-50:]).max() < 4e-3 < abs(found["e"]).max()


def test_the_paths(folder):
    """Sine and point-to-point with three derivatives, written anew."""
    sine, move = Controller("sine", folder), Controller("move", folder)
    w, found = 2 * np.pi * 0.2, np.zeros(4)
    for t in (0.0, 0.3, 7.7):
        assert sine.f("path_at", sine.parameters, t, found) == 0
        a = 0.2 * np.array([np.sin(w * t), w * np.cos(w * t), -(w**2) * np.sin(w * t), -(w**3) * np.cos(w * t)])
        assert found == pytest.approx([0.5 + a[0], *a[1:]], abs=1e-14)
    x = np.polynomial.Polynomial([0, 0, 0, 0, 35, -84, 70, -20])
    for t in (-1.0, 0.0, 0.1, 0.5, 0.9999, 1.3, 1.8, 50.0):
        assert move.f("path_at", move.parameters, t, found) == 0
        begin, length, y, d = (0.1, 0.9, 0.5, 0.1) if t < 1 else (1.0, 0.8, 0.6, -0.15)
        at = min(max((t - begin) / length, 0), 1)
        wanted = [y + d * x(at), *(d * x.deriv(n)(at) / length**n for n in (1, 2, 3))]
        assert found == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("case", ["sine", "adaptive", "none"])
def test_nothing_bad_goes_through(case, folder):
    c, good, path = Controller(case, folder), [0.5, 0.1, 4e5, 4e5, 0.2], [0.5, 0.1, 0.0, 0.0]
    for bad in (np.nan, np.inf, -np.inf):
        for i in range(5):
            x = c.state()
            assert c.sample(x, 0.0, [*good[:i], bad, *good[i + 1 :]], 1e-3)[0] == 1
            assert (x == c.state()).all()  # unchanged
        for i in range(4):
            assert c.sample(c.state(), [*path[:i], bad, *path[i + 1 :]], good, 1e-3)[0] == 1
        assert c.sample(np.full_like(c.state(), bad), 0.0, good, 1e-3)[0] == 1
        assert c.sample(c.state(), bad, good, 1e-3)[0] == 1
        assert c.sample(c.state(), 0.0, good, bad)[0] == 2
    assert c.sample(c.state(), 0.0, good, 0.0)[0] == c.sample(c.state(), 0.0, good, -1e-3)[0] == 2
    assert c.sample(c.state(), 0.0, [0.5, 1e308, 4e5, 4e5, 0.2], 1e-3)[0] == 1  # an overflow inside
    x, out = c.state(), c.sample(c.state(), path, good, 1e-3)[1]
    for extreme in ([0.5, 0.0, 0.0, 0.0, 0.0], [-1.0, 0.1, 9e9, 0.0, 1e6], [0.5, 1e-300, 4e5, 4e5, 0.0]):
        status, out = c.sample(x, path, extreme, 1.0)
        assert status == 0
        assert abs(out[0]) <= 10


@pytest.mark.parametrize("single", [False, True], ids=["double", "float"])
def test_the_voltage_never_exceeds_its_limit(single, folder):
    """Not by rounding either: a converter may wrap round there."""
    c, rng, met = Controller("sine", folder, single), np.random.default_rng(3), 0
    keys = [(group, name) for group, constants in c.of.constants.items() for name in constants]
    for _ in range(300):
        c.parameters[keys.index(("drive", "u_max"))] = limit = c.real(rng.uniform(0.1, 24.0))
        speed = rng.choice([-1.0, 1.0]) * 10 ** rng.uniform(0, 3)
        status, out = c.sample(c.state(), [0.5, 0.1, 0.0, 0.0], [0.5, speed, 4e5, 4e5, 0.0], 1e-3)
        assert status == 0
        assert abs(out[0]) <= limit
        met += abs(out[0]) == limit
    assert met > 50


def test_check_names_the_bad_constant(folder):
    c = Controller("adaptive", folder)
    keys = [(group, name) for group, constants in c.of.constants.items() for name in constants]
    header = (folder / "adaptive" / f"{c.name}.h").read_text()
    codes = [line.split(",")[0].strip() for line in header.splitlines() if line.startswith(f"    {c.name}_BAD_")]
    assert codes == [f"{c.name}_BAD_STEP", *(f"{c.name}_BAD_{group}_{name}" for group, name in keys)]
    for i, (group, name) in enumerate(keys):
        constant, value = c.of.constants[group][name]
        for wrong in (np.nan, np.inf, *([-1.0] if constant.above is not None or constant.at_least is not None else [])):
            c.parameters[i] = wrong
            assert c.f("check", c.parameters) == 3 + i, (group, name, wrong)
        c.parameters[i] = value
    c.parameters[keys.index(("observer", "F_s"))] = 20.0
    assert c.f("check", c.parameters) == 3 + keys.index(("observer", "F_s"))  # less than F_c


@pytest.mark.parametrize(("case", "cc"), [("adaptive", "gcc"), ("move", "clang"), ("none", "gcc")])
def test_self_test_under_sanitizers(case, cc, folder):
    need(cc)
    name, out = Controller(case, folder).name, folder / case
    for define in ("-DDOUBLE", f"-D{name.upper()}_FLOAT"):
        words = [cc, *STRICT, *SANITIZE, define, f"{name}.c", f"{name}_test.c", "-o", "self", "-lm"]
        done = subprocess.run(words, cwd=out, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
        done = subprocess.run(["./self"], cwd=out, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout, done.stderr) == (0, "all checks passed\n", "")
    source = (out / f"{name}.c").read_text()
    (out / "wrong.c").write_text(source.replace("R(60.0)", "R(60.000001)"))
    subprocess.run([cc, "wrong.c", f"{name}_test.c", "-o", "wrong", "-lm"], cwd=out, check=True)
    assert subprocess.run(["./wrong"], cwd=out, capture_output=True, check=False).returncode == 1


# -- FMU ---------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def fmpy():
    need("gcc")
    return pytest.importorskip("fmpy", reason="fmpy is not installed")


@pytest.fixture(scope="module")
def fmu(folder):
    def make(case, fmi):
        path = folder / f"{case}{fmi}.fmu"
        if not path.exists():
            stribeck.export(None, "fmu", path, part="cascade", scenario=rig(case), fmi=fmi)
        return str(path)

    return make


@pytest.mark.parametrize(("case", "fmi"), [("adaptive", 2), ("adaptive", 3), ("move", 3)])
def test_fmu_replays_the_simulation(case, fmi, fmu, fmpy, monkeypatch):
    """Valid; and from the measurements of a simulated run FMPy gets its voltages, held over each step."""
    from fmpy.validation import validate_fmu

    path = fmu(case, fmi)
    assert validate_fmu(path) == []
    description = fmpy.read_model_description(path)
    assert (description.fmiVersion, description.modelExchange) == (f"{fmi}.0", None)
    assert float(description.defaultExperiment.stepSize) == 1e-3
    known = {v.name: v for v in description.modelVariables if v.causality == "parameter"}
    assert known["drive.K_D"].unit == "N s/m"
    assert float(known["model.mass"].start) == rig(case).settings.model["mass"]
    rows, _ = recorded(rig(case, **{"solve.t_end": 0.4}), monkeypatch)
    table = np.array([measured for _, measured, _, _ in rows])
    inputs = np.zeros(len(table), dtype=[(name, float) for name in ("time", *(i.name for i in INPUTS))])
    for name, column in zip(inputs.dtype.names, table.T, strict=True):
        inputs[name] = column
    found = fmpy.simulate_fmu(
        path, stop_time=0.4, output_interval=1e-3, input=inputs, output=["u", "F_hat", "p_d", "z_hat"]
    )
    for name, i in (("u", 0), ("F_hat", 1), ("p_d", 2)):
        wanted = np.array([outputs[i] for _, _, outputs, _ in rows])
        assert found[name][1:] == pytest.approx(wanted[:-1], rel=1e-9, abs=1e-9 * abs(wanted).max()), name
    assert found["z_hat"][1:] == pytest.approx([x[0] for *_, x in rows[:-1]], rel=1e-9, abs=1e-15)


@pytest.fixture
def instance(fmu, fmpy):
    from fmpy.fmi3 import FMU3Slave, fmi3LogMessageCallback

    path, kept = fmu("adaptive", 3), []
    description, unpacked = fmpy.read_model_description(path), fmpy.extract(path)
    at = {v.name: v.valueReference for v in description.modelVariables}

    def make():
        messages = []
        log = fmi3LogMessageCallback(lambda environment, status, category, text: messages.append(text.decode()))
        one = FMU3Slave(
            guid=description.guid, unzipDirectory=unpacked, modelIdentifier=description.coSimulation.modelIdentifier
        )
        one.instantiate(loggingOn=True, logMessage=log)
        kept.append(log)
        one.enterInitializationMode()
        return one, at, messages

    return make


def test_fmu_in_the_loop(instance, monkeypatch):
    """The simulation with the FMU in the place of its controller; a second instance with other gains beside it."""
    exact = stribeck.simulate(rig("adaptive", **{"solve.t_end": 1.0}))
    (one, at, _), (other, _, _) = instance(), instance()
    other.setFloat64([at["drive.K_D"]], [90.0])
    one.exitInitializationMode()
    other.exitInitializationMode()
    inputs, outputs = [at[i.name] for i in INPUTS], [at[n] for n in ("u", "F_hat", "p_d", "z_hat")]

    def sample(self, period, path, measured):
        z_hat = one.getFloat64([at["z_hat"]])[0]
        for each in (other, one):
            each.setFloat64(inputs, list(measured[1:]))
            each.doStep(currentCommunicationPoint=measured[0], communicationStepSize=period)
        return (*one.getFloat64(outputs[:3]), z_hat)

    monkeypatch.setattr(sampled.SampledCascade, "sample", sample)
    found = stribeck.simulate(rig("adaptive", **{"solve.t_end": 1.0}))
    for name, off in (("y", 1e-9), ("u", 1e-5), ("F_hat", 1e-5), ("z_hat", 1e-12)):
        assert found[name] == pytest.approx(exact[name], abs=off), name
    assert other.getFloat64([at["p_d"]]) != one.getFloat64([at["p_d"]])


def test_fmu_says_what_is_wrong(instance):
    from fmpy.fmi1 import FMICallException

    for key, value, said in (
        ("drive.rho", 0.0, "drive.rho must be a finite number > 0"), ("observer.F_s", 1.0, "observer.F_s must be"),
        ("p_1", float("nan"), "a measurement, the state or the result is not finite"),
    ):  # fmt: skip
        one, at, messages = instance()
        one.setFloat64([at[key]], [value])
        with pytest.raises(FMICallException):  # noqa: PT012 - constants are refused at the first, measurements later
            one.exitInitializationMode()
            one.doStep(currentCommunicationPoint=0.0, communicationStepSize=1e-3)
        assert any(said in message for message in messages)


# -- the command -------------------------------------------------------------------------------------------------------


@pytest.fixture
def file(tmp_path):
    assert _status(["new", "servo", "--out", str(tmp_path / "servo.toml")]) == 0
    return str(tmp_path / "servo.toml")


def test_command(file, tmp_path, capsys):
    words = ["export", "--target", "c", "--part", "cascade", "--scenario", file, "--out", str(tmp_path / "out")]
    capsys.readouterr()
    assert _status([*words, "--set", "drive.K_D=80.0", "--json"]) == 0
    said = capsys.readouterr()
    found = json.loads(said.out)
    assert found["parameters"]["drive"]["K_D"] == 80
    assert "drive.sample_time" in said.err
    assert "p->drive.K_D = R(80.0)" in (tmp_path / "out" / "cascade_lugre_sobczyk.c").read_text()
    assert _status(["export", "lugre_sobczyk", *words[1:], "--set", "drive.sample_time=2e-3", "--step", "1e-3"]) == 0
    assert "drive.sample_time = 0.002 s" in capsys.readouterr().err
    assert "every 0.002 s" in (tmp_path / "out" / "cascade_lugre_sobczyk.h").read_text()
    assert _status([*words, "--set", "drive.sample_time=1e-3", "--set", "drive.bandwidth=200.0"]) == 0
    assert "filter of drive.bandwidth" in capsys.readouterr().err


def test_bad_commands(file, tmp_path, capsys):
    out = str(tmp_path / "out")
    rig_of_law = str(tmp_path / "law.toml")
    assert _status(["new", "stick_slip", "--out", rig_of_law]) == 0
    base = ["export", "--part", "cascade", "--target", "c", "--out", out]
    for words, said in (
        (base, "--scenario: missing"),
        ([*base, "--scenario", rig_of_law], "needs one with drive.kind = 'cascade'"),
        ([*base, "lugre", "--scenario", file], "LAW: 'lugre': must be left out"),
        ([*base, "--scenario", file, "--parameters", "canudas1995"], "--parameters: 'canudas1995': must be left out"),
        ([*base, "--scenario", file, "--set", "drive.K_D=-1.0"], "drive.K_D: -1.0: must be a finite number > 0"),
        (["export", "--part", "cascade", "--target", "st", "--scenario", file, "--out", out], "target 'st' has none"),
        (["export", "--target", "c", "--out", out], "LAW: missing"),
    ):
        capsys.readouterr()
        assert _status(words) == 2, words
        assert said in capsys.readouterr().err
    law = stribeck.law("lugre_arctan", {**rig().law.machine, "k_v": 1e6})
    with pytest.raises(stribeck.InputError, match=r"law: 'lugre_arctan': must be left out"):
        stribeck.export(law, "c", out, part="cascade", scenario=rig())
    assert not (tmp_path / "out").exists()
