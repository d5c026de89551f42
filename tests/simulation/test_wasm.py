"""Systems solved by WebAssembly: the numbers of the compiled solver, and the same bits everywhere."""

import hashlib
import importlib.util
import json
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import wasmtime

from stribeck import Scenario, examples, simulate
from stribeck.errors import BuildError, InputError, StribeckNote
from stribeck.simulation import backend, engine, wasm
from tests.simulation.rig import LAWS, law_table, needs_compiler, pid, rig, solved, spring

ROOT = Path(__file__).parent.parent.parent
PLAIN = f"{platform.machine()}-unknown-linux-gnu"  # named, it is taken for the oldest of its kind
POINTS = {"kind": "points", "t": [0.0, 0.2, 0.2, 0.5], "value": [0.0, 1.0, -0.5, 1.4]}
DRIVES = {"force": ("force", 1.3), "spring": (spring("canudas1995", 0.1), 0.2), "pid": (pid("canudas1995", 0.2), 0.5),
          "velocity": ("velocity", 3e-3)}  # fmt: skip


@pytest.fixture
def by_wasm(monkeypatch):
    """Simulate by WebAssembly."""

    def run(scenario):
        with monkeypatch.context() as patch:
            patch.setenv("STRIBECK_BACKEND", "wasm")
            return simulate(scenario)

    return run


def assert_same(compiled, other):
    assert other.status == "done"
    np.testing.assert_array_equal(other.t, compiled.t)
    for column in compiled.columns:
        error = np.max(np.abs(other[column.name] - compiled[column.name]), initial=0)
        assert error <= 1e-6 * max(compiled.peaks[column.name], 1e-300), column.name


@pytest.mark.share(7)
@needs_compiler
@pytest.mark.parametrize(("law", "drive"), [(law, drive) for law in LAWS for drive in DRIVES])
def test_every_law_under_every_drive(law, drive, by_wasm):
    kind, size = DRIVES[drive]
    signal = {**POINTS, "value": [size * value for value in POINTS["value"]]}
    initial = {"y": 1e-5, "z": 3e-6} if law_table(law).get("parameters") and law in LAWS[:8] else {"y": 1e-5}
    data = rig(law, kind, signal, 0.6, rows=60, initial=initial)
    compiled, other = solved(data), by_wasm(Scenario(data))
    assert_same(compiled, other)
    for kind, times in compiled.events.items():
        np.testing.assert_allclose(other.events[kind], times, rtol=0, atol=1e-6)


@pytest.mark.share(5)
@needs_compiler
@pytest.mark.parametrize("name", examples.names())
def test_every_example(name, by_wasm):
    """Machines with play, belts, motors, sampled controllers with noise and delay, the servo."""
    scenario = Scenario.load(examples.path(name))
    compiled, other = simulate(scenario), by_wasm(scenario)
    assert other.stats["solver"] == compiled.stats["solver"] == "rodas5p"
    assert_same(compiled, other)


def digest(scenario):
    """Of the states, held outputs and memory by WebAssembly."""
    system = wasm.system_module(scenario.system)
    result = wasm.solve(wasm.compiled(system.module)[0], system, scenario)
    return hashlib.sha256(np.ascontiguousarray(result.states).tobytes()).hexdigest()[:16]


BITS = json.loads(Path(__file__).with_name("bits.json").read_text(encoding="utf-8"))  # of each example


@pytest.mark.parametrize("name", examples.names())
def test_the_bits_are_the_same_on_every_machine(name):
    """A change of the solver or of the order of operations changes them: then they are written down anew."""
    assert digest(Scenario.load(examples.path(name))) == BITS[name]


def sampled_with_noise():
    """A sampled controller with a delay and measurement noise, whose constants vary."""
    sampling = {"period": 1e-3, "delay": 5e-4, "noise": 1e-6, "seed": 3}
    return {
        "schema": 2, "bodies": {"slider": {"mass": 1.0}}, "contacts": {"rail": {"from": "slider", "law": law_table("lugre")}},
        "controllers": {"axis": {"kind": "pid", "on": "slider", "measures": "slider", "K_p": 900.0, "K_i": 0.0, "K_d": 30.0,
                                 "sampling": sampling, "signal": {"kind": "sine", "amplitude": 0.01, "frequency": 1.0}}},
        "solve": {"t_end": 0.3}, "output": {"step": 0.01},
    }  # fmt: skip


@pytest.mark.parametrize(
    ("data", "values"),
    [
        (rig("lugre_majorant", "force", POINTS, 0.6, rows=60), {"law.k_v": [1e5, 1e6, -1.0, 1e7]}),
        (sampled_with_noise(), {"bodies.slider.mass": [0.5, 1.0, 2.0], "controllers.axis.signal.amplitude": [0.01, 0.02, 0.03]}),
    ],
    ids=["a law's constant, one of them invalid", "a sampled machine"],
)  # fmt: skip
def test_a_lane_has_the_bits_of_a_single_run(data, values, monkeypatch):
    monkeypatch.setenv("STRIBECK_BACKEND", "wasm")
    scenario = Scenario(data)
    solution = simulate(scenario, vary=values, threads=2)
    for lane, reason in enumerate(solution.reason):
        if reason is not None:
            assert np.isnan(solution._states[lane]).all()
            continue
        alone = simulate(scenario.with_changes({path: x[lane] for path, x in values.items()}))
        np.testing.assert_array_equal(solution._states[lane][:, : alone.states.shape[1]], alone.states)
        assert solution.accepted[lane] == alone.stats["accepted"]
        for kind in ("slip", "stick"):
            of_run = alone.events[kind] if kind in alone.events else alone.events["rail"][kind]
            assert getattr(solution, f"{kind}s")[lane] == len(of_run)


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="needs a longer number to compare with")
def test_exp_is_within_two_units_in_the_last_place():
    """The runtime's own: no library of WebAssembly has a fast one."""
    store = wasmtime.Store()
    module = wasm.system_module(Scenario.load(examples.path("stick_slip")).system).module
    called = wasmtime.Instance(store, wasmtime.Module(store.engine, module), []).exports(store)["call_exp"]
    random = np.random.default_rng(2)
    x = np.concatenate([random.uniform(-700, 700, 1000), random.uniform(-1, 1, 1000), [0.0, -0.0, 1e-300, 700, -700]])
    outcome, exact = np.array([called(store, float(y)) for y in x]), np.exp(x.astype(np.longdouble))
    assert np.max(np.abs((outcome - exact) / np.spacing(exact.astype(float)))) < 2
    edges = [called(store, y) for y in (np.inf, -np.inf, 800.0, -800.0, np.nan)]
    np.testing.assert_array_equal(edges, [np.inf, 0.0, np.inf, 0.0, np.nan])


@pytest.mark.thorough
def test_the_runtime_is_what_its_source_gives(tmp_path):
    """The module in the package is built by tools/make_runtime.py from the C that is compiled elsewhere."""
    pytest.importorskip("ziglang")
    spec = importlib.util.spec_from_file_location("make_runtime", ROOT / "tools" / "make_runtime.py")
    built = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(built)
    built.build(tmp_path / "runtime.wasm")
    assert (tmp_path / "runtime.wasm").read_bytes() == built.TARGET.read_bytes()


@pytest.mark.parametrize(("asked", "words"), [("gcc", "must be auto, c or wasm"), ("c", "no C compiler was found")])
def test_a_backend_that_cannot_be_had_is_refused(asked, words, monkeypatch):
    monkeypatch.setenv("STRIBECK_CC", "none")
    monkeypatch.setenv("STRIBECK_BACKEND", asked)
    with pytest.raises(InputError, match=words):
        backend.chosen()


def test_a_damaged_file_of_the_cache_is_made_anew(tmp_path, monkeypatch):
    monkeypatch.setenv("STRIBECK_CACHE", str(tmp_path))
    system = wasm.system_module(Scenario.load(examples.path("break_away")).system)
    monkeypatch.setattr(wasm, "_compiled", {})
    assert wasm.compiled(system.module)[1]
    wasm._compiled.clear()
    assert not wasm.compiled(system.module)[1]
    (kept,) = tmp_path.glob("*.cwasm")
    kept.write_bytes(kept.read_bytes()[:-1])
    wasm._compiled.clear()
    with pytest.warns(StribeckNote, match="is damaged; the system is compiled anew"):
        assert wasm.compiled(system.module)[1]


def test_a_module_that_is_none_is_refused():
    with pytest.raises(BuildError, match="Wasmtime"):
        engine.build(b"no module")
    with pytest.raises(BuildError, match="Wasmtime"):
        engine.read(b"no machine code")


def test_threads_solve_beside_each_other(by_wasm):
    """Each has a memory of its own."""
    from concurrent.futures import ThreadPoolExecutor

    scenario = Scenario.load(examples.path("stick_slip"))
    system = wasm.system_module(scenario.system)
    built, _ = wasm.compiled(system.module)
    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda _: wasm.solve(built, system, scenario), range(8)))
    assert {hashlib.sha256(x.states.tobytes()).digest() for x in results} == {
        hashlib.sha256(results[0].states.tobytes()).digest()
    }


@pytest.mark.share(3)
@pytest.mark.parametrize(
    "target", ["pulley64", pytest.param(PLAIN, marks=pytest.mark.skipif(sys.platform != "linux", reason="Linux's"))]
)
@pytest.mark.parametrize("name", ["stick_slip", "arm"])
def test_the_bits_of_another_engine(name, target):
    """Wasmtime's interpreter (Pulley), where no instruction of this processor takes part; and code for this processor's
    oldest kin, without AVX. In a process of its own."""
    code = f"""
import hashlib, wasmtime
from stribeck import Scenario, examples
from stribeck.simulation import engine, wasm
config = wasmtime.Config(); config.target = {target!r}
other = wasmtime.Engine(config)
engine.engine = lambda: other
scenario = Scenario.load(examples.path({name!r}), {{"solve.t_end": 0.2}})
system = wasm.system_module(scenario.system)
print(hashlib.sha256(wasm.solve(engine.build(system.module), system, scenario).states.tobytes()).hexdigest()[:16])
"""
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip() == digest(Scenario.load(examples.path(name), {"solve.t_end": 0.2}))


@pytest.mark.thorough
@pytest.mark.skipif(shutil.which("node") is None, reason="needs node")
@pytest.mark.parametrize("name", examples.names())
def test_the_bits_of_a_browser_s_engine(name, tmp_path, monkeypatch):
    """V8, by node: the module as it is, and memory as it is before the solver is called."""
    before, call = [], engine.Instance.call

    def kept(self, what, run):
        before.append((self.memory(0).copy(), run))
        return call(self, what, run)

    scenario = Scenario.load(examples.path(name), {"solve.t_end": 0.2})
    system = wasm.system_module(scenario.system)
    monkeypatch.setattr(engine.Instance, "call", kept)
    result = wasm.solve(wasm.compiled(system.module)[0], system, scenario)
    memory, run = before[-1]
    (tmp_path / "module.wasm").write_bytes(system.module)
    memory.tofile(tmp_path / "memory")
    out, count = wasm.run_struct().from_buffer(memory, run).out, result.states.nbytes
    script = """
        const [folder, run, out, count] = process.argv.slice(1), { readFileSync, writeFileSync } = require("fs");
        const api = new WebAssembly.Instance(new WebAssembly.Module(readFileSync(folder + "/module.wasm"))).exports;
        const memory = readFileSync(folder + "/memory");
        api.memory.grow((memory.length - api.memory.buffer.byteLength) / 65536);
        new Uint8Array(api.memory.buffer).set(memory);
        const status = api.stribeck_advance(+run);
        writeFileSync(folder + "/out", new Uint8Array(api.memory.buffer, +out, +count));
        process.exit(status);
    """
    words = [str(tmp_path), str(run), str(out), str(count)]
    subprocess.run(["node", "-e", script, *words], check=True)
    assert (tmp_path / "out").read_bytes() == result.states.tobytes()
