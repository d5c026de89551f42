"""FMUs, validated and run by FMPy, against the simulation."""

import ctypes
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest

import stribeck
from stribeck.errors import BuildError, StribeckNote
from tests.exports.harness import law, need

fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("fmu")


def rig(name, drive, t_end=1.0, step=0.01):
    own = {n: x for n, x in law(name).values.items() if n in stribeck_constants(name) and x is not None}
    return stribeck.Scenario({
        "schema": 1, "law": {"name": name, "parameters": "canudas1995", **own}, "plant": {"mass": 1.0}, "drive": drive,
        "solve": {"t_end": t_end}, "output": {"step": step},
    })  # fmt: skip


def stribeck_constants(name):
    return type(law(name)).own_constants()


FORCE = {"kind": "force", "signal": {"kind": "sine", "amplitude": 2.0, "frequency": 1.0}}
VELOCITY = {"kind": "velocity", "signal": {"kind": "sine", "amplitude": 2e-3, "frequency": 1.0}}


def fmu(name, part, fmi, folder):
    need("gcc")
    path = folder / f"{name}_{part}_{fmi}.fmu"
    if not path.exists():
        scenario = rig(name, FORCE) if part == "body" else None
        stribeck.export(law(name), "fmu", path, part=part, fmi=fmi, scenario=scenario)
    return str(path)


CASES = [("lugre_majorant", "law"), ("elastoplastic_majorant", "body"), ("makkar", "law"), ("makkar", "body")]


@pytest.mark.share(4)
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(("name", "part"), CASES)
def test_valid(name, part, fmi, folder):
    from fmpy.validation import validate_fmu

    path = fmu(name, part, fmi, folder)
    assert validate_fmu(path) == []
    with zipfile.ZipFile(path) as archive:
        assert "documentation/index.html" in archive.namelist()
        assert {entry.external_attr >> 16 for entry in archive.infolist()} == {0o644}


def held(drive, h, t_end=1.0):
    """The drive with its signal held over steps of h, as a co-simulation holds its inputs."""
    n = round(t_end / h)
    wave = drive["signal"]["amplitude"] * np.sin(2 * np.pi * drive["signal"]["frequency"] * h * np.arange(n))
    t = np.repeat(h * np.arange(n + 1), 2)[1:-1]
    return {"kind": drive["kind"], "signal": {"kind": "points", "t": t.tolist(), "value": np.repeat(wave, 2).tolist()}}


def by_steps(path, drive, column, h, output, t_end=1.0):
    """FMPy's co-simulation with steps of h, every 10 ms."""
    t = h * np.arange(round(t_end / h) + 1)
    signals = np.zeros(t.size, dtype=[("time", float), (column, float)])
    signals["time"] = t
    signals[column] = drive["signal"]["amplitude"] * np.sin(2 * np.pi * drive["signal"]["frequency"] * t)
    solution = fmpy.simulate_fmu(
        path, stop_time=t_end, fmi_type="CoSimulation", input=signals, output_interval=h, output=output,
        relative_tolerance=1e-8,
    )  # fmt: skip
    return solution[:: round(0.01 / h)]


@pytest.mark.parametrize(("name", "fmi"), [("lugre_majorant", 2), ("elastoplastic_majorant", 3), ("makkar", 2)])
def test_body_in_model_exchange(name, fmi, folder):
    """FMPy's CVODE, a constant force (FMPy holds inputs between communication points)."""
    push = {"kind": "force", "signal": {"kind": "points", "t": [0.0], "value": [3.0]}}
    exact = stribeck.simulate(rig(name, push))
    solution = fmpy.simulate_fmu(
        fmu(name, "body", fmi, folder), stop_time=1.0, fmi_type="ModelExchange", start_values={"u": 3.0},
        output_interval=0.01, relative_tolerance=1e-8, output=["y", "v", "F"],
    )  # fmt: skip
    for column in ("y", "v"):
        assert solution[column] == pytest.approx(exact[column], abs=2e-6 * np.max(exact[column]))
    assert solution["F"][5:] == pytest.approx(exact["F"][5:], rel=1e-4)


@pytest.mark.parametrize(("name", "fmi"), [("lugre_majorant", 2), ("elastoplastic_majorant", 3), ("makkar", 2)])
def test_body_in_co_simulation(name, fmi, folder):
    exact = stribeck.simulate(rig(name, held(FORCE, 5e-3)))
    result = by_steps(fmu(name, "body", fmi, folder), FORCE, "u", 5e-3, ["y", "v"])
    assert result["y"] == pytest.approx(exact["y"], abs=1e-8 * np.max(abs(exact["y"])))
    assert result["v"] == pytest.approx(exact["v"], abs=1e-8 * np.max(abs(exact["v"])))


@pytest.mark.parametrize(("name", "fmi"), [("lugre_majorant", 2), ("elastoplastic", 3), ("makkar", 2)])
def test_law_in_co_simulation(name, fmi, folder):
    """The velocity held over each step: F is compared just before the next value comes."""
    exact = stribeck.simulate(rig(name, held(VELOCITY, 1e-3), step=0.01))
    result = by_steps(fmu(name, "law", fmi, folder), VELOCITY, "v", 1e-3, ["F", *(["z"] if name != "makkar" else [])])
    if name != "makkar":
        assert result["z"] == pytest.approx(exact["z"], abs=(1e-6 if name == "lugre_majorant" else 1e-3) * 1.5e-5)
    chosen, v = law(name), 2e-3 * np.sin(2 * np.pi * (0.01 * np.arange(101) - 1e-3))
    z = result["z"] if name != "makkar" else 0.0
    assert result["F"][1:] == pytest.approx(chosen.force(v, z)[1:], rel=1e-9)


def test_law_in_model_exchange(folder):
    """The bristle after a jump of the velocity, by FMPy's CVODE and in closed form."""
    solution = fmpy.simulate_fmu(
        fmu("lugre_majorant", "law", 3, folder), stop_time=0.05, fmi_type="ModelExchange", start_values={"v": 1e-3},
        output_interval=1e-3, relative_tolerance=1e-9, output=["z", "F"],
    )  # fmt: skip
    chosen = law("lugre_majorant")
    rate = float(chosen.jacobian(1e-3, 0.0)[1])
    z = chosen.steady_deflection(1e-3) * -np.expm1(rate * solution["time"])
    assert solution["z"] == pytest.approx(z, abs=1e-7 * 1.5e-5)
    assert solution["F"] == pytest.approx(chosen.force(1e-3, z), rel=1e-6)


class Slave:
    """An FMU instance of FMI 3.0, its messages kept."""

    def __init__(self, path, unpacked):
        from fmpy.fmi3 import FMU3Slave

        description = fmpy.read_model_description(path)
        self.reference = {v.name: v.valueReference for v in description.modelVariables}
        self.messages = []
        self.fmu = FMU3Slave(
            guid=description.guid, unzipDirectory=unpacked, modelIdentifier=description.coSimulation.modelIdentifier
        )
        from fmpy.fmi3 import fmi3LogMessageCallback

        def log(environment, status, category, message):
            assert environment == 7
            self.messages.append(message.decode())

        self._keep = fmi3LogMessageCallback(log)
        inner = self.fmu.fmi3InstantiateCoSimulation
        self.fmu.fmi3InstantiateCoSimulation = lambda *words: inner(*words[:9], 7, *words[10:])
        self.fmu.instantiate(loggingOn=True, logMessage=self._keep)

    def start(self):
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, name, value):
        self.fmu.setFloat64([self.reference[name]], [value])

    def get(self, name):
        return self.fmu.getFloat64([self.reference[name]])[0]

    def step(self, t, h):
        self.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=h)


@pytest.fixture
def slave(folder):
    path = fmu("lugre_majorant", "body", 3, folder)
    unpacked = fmpy.extract(path)
    return lambda: Slave(path, unpacked)


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [("k_v", -1.0, "k_v must be a finite number > 0"), ("F_s", 0.5, "at least F_c"), ("mass", 0.0, "mass must be"),
     ("sigma_0", float("nan"), "sigma_0 must be"), ("v_s", float("inf"), "v_s must be")],
)  # fmt: skip
def test_wrong_parameters(key, value, said, slave):
    from fmpy.fmi1 import FMICallException

    body = slave()
    body.set(key, value)
    with pytest.raises(FMICallException):
        body.start()
    assert any(said in message for message in body.messages)
    other = slave()
    other.start()
    other.set(key, value)  # tuned wrongly on the way
    with pytest.raises(FMICallException):
        other.step(0.0, 1e-3)
    assert any(said in message for message in other.messages)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_tolerance_below_rounding(fmi, folder):
    """It is no reason to go on for ever: 1e-15 is taken as the finest that rounding allows, and 0 as none given."""
    name, path = "lugre_majorant", fmu("lugre_majorant", "body", fmi, folder)
    inputs = np.array([(0.0, 3.0), (1.0, 3.0)], dtype=[("time", float), ("u", float)])
    ways = {"stop_time": 0.02, "fmi_type": "CoSimulation", "output_interval": 0.01, "input": inputs, "timeout": 60}
    none, fine, finest = (fmpy.simulate_fmu(path, relative_tolerance=x, **ways)["y"] for x in (0.0, 1e-9, 1e-15))
    force = {"kind": "force", "signal": {"kind": "points", "t": [0.0], "value": [3.0]}}
    y = stribeck.simulate(rig(name, force, t_end=0.02))["y"]
    assert finest == pytest.approx(y, rel=1e-7)
    assert finest == pytest.approx(fine, rel=1e-6)
    assert not np.array_equal(none, finest)


def test_steps_without_end_are_given_up(slave):
    """A tolerance that needs more steps than can be made is an error, and the state stays."""
    from fmpy.fmi1 import FMICallException

    body = slave()
    body.fmu.enterInitializationMode(tolerance=1e-15)
    body.fmu.exitInitializationMode()
    body.set("u", 3.0)
    with pytest.raises(FMICallException):
        body.step(0.0, 1e4)
    assert any("the tolerance needs more steps" in message for message in body.messages)
    assert (body.get("y"), body.get("v"), body.get("z")) == (0.0, 0.0, 0.0)


class Exchanged:
    """An instance for model exchange: what each state of an FMU computes, told whether it is refused."""

    def __init__(self, path, fmi):
        from fmpy.fmi2 import FMU2Model
        from fmpy.fmi3 import FMU3Model

        self.of, self.fmi = fmpy.read_model_description(path), fmi
        self.fmu = (FMU2Model if fmi == 2 else FMU3Model)(
            guid=self.of.guid, unzipDirectory=fmpy.extract(path),
            modelIdentifier=self.of.modelExchange.modelIdentifier,
        )  # fmt: skip
        self.fmu.instantiate()
        self.put, self.get = (
            (self.fmu.setReal, self.fmu.getReal) if fmi == 2 else (self.fmu.setFloat64, self.fmu.getFloat64)
        )
        self.outputs = [v.valueReference for v in self.of.modelVariables if v.causality == "output" and not v.start]
        self.known = [v.valueReference for v in self.of.modelVariables if v.causality == "input"]

    def reach(self, state):
        """Until this state of an FMU."""
        if self.fmi == 2:
            self.fmu.setupExperiment()
        for name in ("enterInitializationMode", "exitInitializationMode", "enterContinuousTimeMode"):
            if state == name:
                return
            getattr(self.fmu, name)()

    def computes(self):
        """What the FMU is asked to compute, by name."""
        n = len(self.of.derivatives)
        rates = (ctypes.c_double * max(n, 1))()
        asked = {f"output {r}": lambda r=r: self.get([r]) for r in self.outputs}
        if n:
            take = self.fmu.getDerivatives if self.fmi == 2 else self.fmu.getContinuousStateDerivatives
            asked["rates"] = lambda: take(rates, n)
        return asked

    def refused(self):
        """Whether each of these is refused."""
        from fmpy.fmi1 import FMICallException

        result = {}
        for name, ask in self.computes().items():
            try:
                ask()
                result[name] = False
            except FMICallException:
                result[name] = True
        return result


@pytest.mark.parametrize(
    ("name", "part", "fmi"), [("dahl", "law", 2), ("dahl", "law", 3), ("makkar", "law", 2), ("makkar", "body", 3)]
)
@pytest.mark.parametrize(
    "state", ["enterInitializationMode", "exitInitializationMode", "enterContinuousTimeMode", "end"]
)
def test_nothing_is_computed_with_constants_that_are_not_allowed(name, part, fmi, state, folder):
    """F_c = inf was taken where it was set while time goes on: only a step, or the end of the initialization, looked."""
    model = Exchanged(fmu(name, part, fmi, folder), fmi)
    model.reach(state)
    assert not any(model.refused().values())
    for v in model.of.modelVariables:
        if v.causality != "parameter":
            continue
        constant = law(name).constants().get(v.name)
        wrong = [np.nan, np.inf, -np.inf, -1.0, *([0.0] if constant is None or constant.above is not None else [])]
        for value in (x for x in wrong if constant is None or constant.problem(x)):
            model.put([v.valueReference], [value])
            assert all(model.refused().values()), (v.name, value)
        model.put([v.valueReference], [float(v.start)])
        assert not any(model.refused().values())
    for wrong in (np.nan, np.inf):
        model.put(model.known[:1], [wrong])
        assert all(model.refused().values())
    if state == "end":
        with pytest.raises(fmpy.fmi1.FMICallException):
            model.fmu.newDiscreteStates() if fmi == 2 else model.fmu.updateDiscreteStates()


@pytest.mark.parametrize(("name", "part", "fmi"), [("dahl", "law", 2), ("makkar", "body", 3)])
def test_states_and_times_are_numbers(name, part, fmi, folder):
    from fmpy.fmi1 import FMICallException

    model = Exchanged(fmu(name, part, fmi, folder), fmi)
    model.reach("end")
    n = len(model.of.derivatives)
    for bad in (np.nan, np.inf, -np.inf):
        with pytest.raises(FMICallException):
            model.fmu.setTime(bad)
        for i in range(n):
            x = (ctypes.c_double * n)(*[bad if k == i else 0.0 for k in range(n)])
            with pytest.raises(FMICallException):
                model.fmu.setContinuousStates(x, n)
            assert not any(model.refused().values())


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_instance_of_another_token_is_refused_to_hosts_that_hear_it_and_to_others(fmi, folder):
    from fmpy import fmi2, fmi3

    path, said = fmu("lugre_majorant", "body", fmi, folder), []
    identifier = fmpy.read_model_description(path).coSimulation.modelIdentifier
    words = {"guid": "", "unzipDirectory": fmpy.extract(path), "modelIdentifier": identifier}
    if fmi == 2:
        host, log = fmi2.FMU2Slave(**words), fmi2.fmi2CallbackLoggerTYPE(lambda *message: said.append(message[-1]))
        loggers = fmi2.fmi2CallbackLoggerTYPE(), log
        called = [None, *(ctypes.byref(fmi2.fmi2CallbackFunctions(logger=x)) for x in loggers)]
        results = [host.fmi2Instantiate(b"one", fmi2.fmi2CoSimulation, b"another", b"", x, 0, 0) for x in called]
    else:
        host, log = fmi3.FMU3Slave(**words), fmi3.fmi3LogMessageCallback(lambda *message: said.append(message[-1]))
        results = [
            host.fmi3InstantiateCoSimulation(
                b"one", b"another", None, False, False, False, False, None, 0, None, x,
                fmi3.fmi3IntermediateUpdateCallback(),
            ) for x in (fmi3.fmi3LogMessageCallback(), log)
        ]  # fmt: skip
    assert not any(results)
    assert len(said) == 1
    assert b"is not that of this FMU" in said[0]


def test_two_instances_share_nothing(slave):
    one, two = slave(), slave()
    for each in (one, two):
        each.start()
    one.set("u", 3.0)
    two.set("F_c", 0.9)
    for i in range(50):
        for each in (one, two):
            each.step(i * 1e-3, 1e-3)
    alone = slave()
    alone.start()
    alone.set("u", 3.0)
    for i in range(50):
        alone.step(i * 1e-3, 1e-3)
    assert one.get("y") == alone.get("y") != 0
    assert (two.get("y"), two.get("F_c"), one.get("F_c")) == (0, 0.9, 1.0)


def test_state_is_kept_and_brought_back(slave):
    body = slave()
    body.start()
    body.set("u", 3.0)
    body.step(0.0, 0.01)
    kept = body.fmu.getFMUState()
    serialised = body.fmu.serializeFMUState(kept)
    at = [body.get(n) for n in ("y", "v", "z", "F")]
    body.step(0.01, 0.01)
    further = body.get("y")
    assert further != at[0]
    body.fmu.setFMUState(kept)
    assert [body.get(n) for n in ("y", "v", "z", "F")] == at
    body.step(0.01, 0.01)
    assert body.get("y") == further
    other = slave()
    other.start()
    other.fmu.setFMUState(other.fmu.deserializeFMUState(serialised))
    assert [other.get(n) for n in ("y", "v", "z", "F")] == at


@pytest.mark.parametrize("fmi", [2, 3])
def test_directional_derivatives(fmi, folder):
    chosen, v, z = law("lugre_majorant"), 2e-3, 7e-6
    body = Exchanged(fmu("lugre_majorant", "body", fmi, folder), fmi)
    body.reach("end")
    ref = {each.name: each.valueReference for each in body.of.modelVariables}
    body.put([ref["v"], ref["z"]], [v, z])
    by_v, by_z = chosen.jacobian(v, z)

    def slope(unknown, **seed):
        return body.fmu.getDirectionalDerivative([ref[unknown]], [ref[n] for n in seed], list(seed.values()))[0]

    assert slope("der(z)", v=1.0) == pytest.approx(by_v, rel=1e-12)
    assert slope("der(z)", z=1.0) == pytest.approx(by_z, rel=1e-12)
    assert slope("der(z)", v=2.0, z=1e-3) == pytest.approx(2 * by_v + 1e-3 * by_z, rel=1e-12)
    assert slope("F", z=1.0) == pytest.approx(1e5 + 316.22776601683796 * by_z, rel=1e-12)
    assert slope("der(v)", u=1.0) == pytest.approx(1.0)
    assert slope("der(v)", v=1.0) == pytest.approx(-(316.22776601683796 * by_v + 0.4), rel=1e-12)
    assert slope("der(y)", v=1.0) == 1
    assert slope("der(y)", z=1.0) == 0
    if fmi == 2:  # a host may hand over an array that holds numbers
        (y, v), held = ((ctypes.c_uint * 1)(ref[n]) for n in ("der(y)", "v")), (ctypes.c_double * 1)(7.0)
        body.fmu.fmi2GetDirectionalDerivative(body.fmu.component, y, 1, v, 1, (ctypes.c_double * 1)(1.0), held)
        assert held[0] == 1
    else:  # the other way round; a host's array may be longer
        of, by = ((ctypes.c_uint * 2)(*(ref[n] for n in names)) for names in (("der(z)", "F"), ("v", "z")))
        seed, held = (ctypes.c_double * 2)(2.0, 1e-3), (ctypes.c_double * 3)(7.0, 7.0, 7.0)
        body.fmu.fmi3GetAdjointDerivative(body.fmu.component, of, 2, by, 2, seed, 2, held, 2)
        sums = [2 * slope("der(z)", **{n: 1.0}) + 1e-3 * slope("F", **{n: 1.0}) for n in "vz"]
        assert list(held) == pytest.approx([*sums, 7.0], rel=1e-12)


_LAYOUT = {
    2: ("fmi2Pending", "fmi2CoSimulation", "fmi2Terminated", "fmi2True", "sizeof(fmi2ValueReference)", "sizeof(fmi2Byte)",
        "sizeof(fmi2CallbackFunctions)", "offsetof(fmi2CallbackFunctions, componentEnvironment)", "sizeof(fmi2EventInfo)",
        "offsetof(fmi2CallbackFunctions, stepFinished)", "offsetof(fmi2EventInfo, nextEventTime)",
        "offsetof(fmi2EventInfo, nextEventTimeDefined)", "offsetof(fmi2EventInfo, terminateSimulation)",
        "strcmp(fmi2Version, \"2.0\")", "strcmp(fmi2TypesPlatform, \"default\")"),
    3: ("fmi3Fatal", "fmi3Dependent", "fmi3IntervalChanged", "fmi3True", "sizeof(fmi3ValueReference)",
        "sizeof(fmi3Boolean)", "sizeof(fmi3Clock)", "sizeof(fmi3Float32)", "sizeof(fmi3Int8)", "sizeof(fmi3UInt64)",
        "sizeof(*(fmi3Binary)0)", "strcmp(fmi3Version, \"3.0\")"),
}  # fmt: skip


@pytest.mark.parametrize("fmi", [2, 3])
def test_our_header_says_what_the_standards_says(fmi, folder, tmp_path):
    """The FMU compiles against the headers that FMPy ships in the place of ours, and values and layouts are the same."""
    need("gcc")
    theirs = Path(fmpy.__file__).parent / "c-code"
    if not (theirs / f"fmi{fmi}Functions.h").is_file():
        pytest.skip("this FMPy ships no headers")
    with zipfile.ZipFile(fmu("lugre_majorant", "body", fmi, folder)) as archive:
        archive.extractall(tmp_path)
    source, include = tmp_path / "sources", f'#include "fmi{fmi}Functions.h"\n'
    names = {path.name for path in source.iterdir()}
    assert not {name for name in names if name.startswith("fmi") and name != f"fmi{fmi}.h"}  # no text of others
    (source / "probe.c").write_text(
        f'#include <stdio.h>\n#include <stddef.h>\n#include <string.h>\n#include "fmi{fmi}.h"\nint main(void)\n{{\n'
        + "".join(f'    printf("%d\\n", (int)({text}));\n' for text in _LAYOUT[fmi]) + "    return 0;\n}\n"
    )  # fmt: skip

    def built():
        strict = ["gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-Wno-strict-prototypes", "-I", str(theirs)]
        for words in ([*strict, "-c", "fmu.c", "-o", "fmu.o"], [*strict, "probe.c", "-o", "probe"]):
            done = subprocess.run(words, cwd=source, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr
        return subprocess.run(["./probe"], cwd=source, capture_output=True, text=True, check=True).stdout

    ours = built()
    (source / f"fmi{fmi}.h").write_text(include)
    assert built() == ours
    assert len(ours.split()) == len(_LAYOUT[fmi])


def test_no_folder_of_this_machine_is_in_it(tmp_path, monkeypatch):
    """Nor the moment when it was made: the same bytes each time, with a compiler that notes its folders too."""
    need("gcc")
    monkeypatch.setenv("STRIBECK_CC", "gcc -g")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (path,) = stribeck.export(law("dahl"), "fmu", tmp_path / "dahl.fmu")
    with zipfile.ZipFile(path) as archive:
        (library,) = (archive.read(name) for name in archive.namelist() if name.startswith("binaries/"))
    assert bytes(tmp_path) not in library
    first = path.read_bytes()
    assert stribeck.export(law("dahl"), "fmu", path)[0].read_bytes() == first
    monkeypatch.setenv("STRIBECK_CC", "gcc -no-such-option")
    with pytest.raises(BuildError, match="gcc failed: gcc: error: "):
        stribeck.export(law("dahl"), "fmu", path)


def test_without_a_compiler_the_sources_are_there(tmp_path, monkeypatch):
    monkeypatch.setattr("stribeck.simulation.compiler.find", lambda: None)
    with pytest.warns(StribeckNote, match="sources only"):
        (path,) = stribeck.export(law("dahl"), "fmu", tmp_path / "dahl.fmu")
    with zipfile.ZipFile(path) as archive:
        assert "sources/fmu.c" in archive.namelist()
