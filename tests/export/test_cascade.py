"""The cascade controller in C and as an FMU, against the sampled simulation, and in its place in the loop."""

import ctypes
import json
import subprocess

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stribeck
from stribeck import examples
from stribeck.cli import _status
from stribeck.export.c.cascade import INPUTS, OUTPUTS, PATH, ControllerCode
from stribeck.export.c.selftest import sampled as expected
from stribeck.export.fmu import binaries
from stribeck.export.request import Request
from tests.control import independent
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


def recorded(scenario, states):
    """What the controller of a sampled simulation was given and computed at each sample, from rows at these."""
    run = stribeck.simulate(scenario.with_changes({"output.step": 1e-3}))
    assert run.status == "done", run.reason
    p = run.scenario.plant_values
    acceleration = (p["area"] * (run["p_1"] - run["p_2"]) - run["F"]) / p["mass"]
    measured = np.transpose([run["t"], run["y"], run["v"], run["p_1"], run["p_2"], acceleration]).tolist()
    before = np.reshape([run.held[name] for name in states], (len(states), len(run.t))).T.tolist()
    computed = np.transpose([run.held[name] for name in ("u", "F_hat", "p_d", "z_hat")]).tolist()
    return list(zip(before, measured, computed, before[1:], strict=False))


def looped(sample, t_end, period=1e-3):
    """Columns of the loop of such a controller and of the plant written apart, which SciPy solves."""
    _, plant, _ = independent.servo("lugre_sobczyk", None, None)
    x, rows = np.array([0.51, 0.0, 4e5, 4e5, 0.0]), []
    for k in range(round(t_end / period) + 1):
        u, F_hat, _, z_hat = sample(k * period, [*x[:4].tolist(), plant(x, 0.0)[1]], period)
        rows.append({"y": x[0], "u": u, "F_hat": F_hat, "z_hat": z_hat})
        found = solve_ivp(
            lambda _, x, angle: plant(x, angle), (0, period), x, method="LSODA", args=(np.arctan(2 * u),),
            rtol=1e-10, atol=[1e-13, 1e-12, 1e-5, 1e-5, 1e-14],
        )  # fmt: skip
        x = found.y[:, -1]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


@pytest.mark.parametrize(("case", "single"), [*((case, False) for case in CASES), ("sine", True), ("adaptive", True)])
def test_what_the_simulation_computes(case, single, folder):
    """At every sample of a simulated run, the path included: the same outputs, and the same states afterwards."""
    c, eps = Controller(case, folder, single), EPS_FLOAT if single else EPS
    size, states = expected(c.of), [column.name for column, _ in c.of.states]
    names = [*(f"path.{column.name}" for column in PATH), *(column.name for column in INPUTS), *states]
    rows = recorded(rig(case, **{"solve.t_end": 0.401}), states)
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
def test_in_the_loop(case, folder):
    """The C with a plant written apart goes the way of the simulation."""
    exact = stribeck.simulate(rig(case, **{"solve.t_end": 0.4, "output.step": 1e-3}))
    c = Controller(case, folder)
    x = c.state()

    def sample(t, measured, period):
        before = float(x[0])
        status, out = c.sample(x, t, measured, period)
        assert status == 0
        return (*map(float, out[:3]), before)

    found = looped(sample, 0.4)
    assert exact.status == "done"
    for name in ("y", "u", "F_hat", "z_hat"):
        assert found[name] == pytest.approx(exact[name], abs=1e-6 * exact.peaks[name]), name


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
def test_fmu_replays_the_simulation(case, fmi, fmu, fmpy):
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
    rows = recorded(rig(case, **{"solve.t_end": 0.401}), [column.name for column, _ in cascade(case).states])
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


def test_fmu_in_the_loop(instance):
    """The FMU with a plant written apart; a second instance with other gains beside it."""
    exact = stribeck.simulate(rig("adaptive", **{"solve.t_end": 0.2, "output.step": 1e-3}))
    (one, at, _), (other, _, _) = instance(), instance()
    other.setFloat64([at["drive.K_D"]], [90.0])
    one.exitInitializationMode()
    other.exitInitializationMode()
    inputs, outputs = [at[i.name] for i in INPUTS], [at[n] for n in ("u", "F_hat", "p_d")]

    def sample(t, measured, period):
        z_hat = one.getFloat64([at["z_hat"]])[0]
        for each in (other, one):
            each.setFloat64(inputs, measured)
            each.doStep(currentCommunicationPoint=t, communicationStepSize=period)
        return (*one.getFloat64(outputs), z_hat)

    found = looped(sample, 0.2)
    for name in ("y", "u", "F_hat", "z_hat"):
        assert found[name] == pytest.approx(exact[name], abs=1e-6 * exact.peaks[name]), name
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
    assert "sample_time" in said.err
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
