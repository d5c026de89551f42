"""The kernel for a GPU: compiled where there is a compiler for it, and its text run thread by thread on the processor."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from ctypes import POINTER
from importlib.metadata import PackageNotFoundError, distribution

import numpy as np
import pytest

import stribeck
from stribeck import examples
from stribeck.simulation import cuda, lanes
from stribeck.simulation.ensemble import happened
from stribeck.simulation.variations import vary

CASES = {
    "stick_slip": {"law.parameters.F_s": [1.2, 1.5, 1.8], "drive.signal.rate": [0.05, 0.1, 0.2]},
    "limit_cycle": {"law.k_v": [1e6, 1e7], "drive.K_i": [3.0, 4.0]},
    "sine_force": {"drive.signal.amplitude": [0.5, 1.0, 1.6]},
}
SHORT = {"stick_slip": 10.0, "limit_cycle": 10.0, "sine_force": 1.0, "arm": 0.3}
SAMPLED = {"arm": {"controllers.axis.K_p": [15.0, 20.0]}}


def case(name: str) -> tuple[stribeck.Scenario, dict[str, list[float]]]:
    values = {**CASES, **SAMPLED}[name]
    return stribeck.Scenario.load(str(examples.path(name)), {"solve.t_end": SHORT[name]}), values


@pytest.mark.parametrize("name", [*CASES, *SAMPLED])
def test_the_text_of_the_kernel_run_by_the_processor(name, tmp_path):
    if (compiler := shutil.which("g++") or shutil.which("clang++")) is None:
        pytest.skip("no C++ compiler")
    scenario, values = case(name)
    text = tmp_path / "kernel.cpp"
    text.write_text(cuda.kernel(scenario.system))
    built = tmp_path / "kernel.so"
    subprocess.run(
        [
            compiler,
            "-std=c++20",
            "-O1",
            "-Wall",
            "-Werror",
            "-Wno-unknown-pragmas",
            "-fPIC",
            "-shared",
            text,
            "-o",
            built,
        ],
        check=True,
    )
    library = ctypes.CDLL(str(built))
    library.stribeck_solve_batch.argtypes = [POINTER(lanes.Batch)]
    made = lanes.lane_arrays(vary(scenario, values))
    library.stribeck_solve_batch(ctypes.byref(made.batch))
    found = lanes.outcome(made)
    expected = stribeck.simulate_ensemble(scenario, values)
    assert (found.counts["status"] == 0).all()
    events = happened(scenario, found.counts["happened"])
    assert {n: {k: x.tolist() for k, x in each.items()} for n, each in events.items()} == {
        n: {k: x.tolist() for k, x in each.items()} for n, each in expected.happened.items()
    }
    for i, state in enumerate(scenario.system.states):
        theirs = expected[state.name]
        np.testing.assert_allclose(found.states[:, :, i], theirs, rtol=0, atol=1e-6 * np.abs(theirs).max())


def test_the_kernel_compiles_for_a_gpu(tmp_path):
    if (nvcc := shutil.which("nvcc")) is None:
        pytest.skip("no nvcc")
    text = tmp_path / "kernel.cu"
    text.write_text(cuda.kernel(case("stick_slip")[0].system))
    command = [nvcc, "-std=c++20", "-arch=sm_80", "-cubin", "-Werror", "all-warnings", "-o", tmp_path / "kernel", text]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def nvrtc() -> ctypes.CDLL:
    """NVIDIA's compiler that CuPy uses, from its package."""
    try:
        files = distribution("nvidia-cuda-nvrtc").files or []
    except PackageNotFoundError:
        pytest.skip("no NVRTC: pip install nvidia-cuda-nvrtc")
    (library,) = (f.locate() for f in files if f.name.startswith(("libnvrtc.so", "nvrtc64_")) and "alt" not in f.name)
    return ctypes.CDLL(str(library))


@pytest.mark.parametrize("name", [*CASES, "arm", "machine", "servo"])
def test_the_kernel_compiles_at_run_time(name):
    """As CuPy has it compiled: without any header."""
    compiler, program, size = nvrtc(), ctypes.c_void_p(), ctypes.c_size_t()
    text = cuda.kernel(stribeck.Scenario.load(str(examples.path(name))).system).encode()
    assert compiler.nvrtcCreateProgram(ctypes.byref(program), text, b"kernel.cu", 0, None, None) == 0
    options = (ctypes.c_char_p * 2)(b"--std=c++20", b"--gpu-architecture=sm_90")
    status = compiler.nvrtcCompileProgram(program, 2, options)
    compiler.nvrtcGetProgramLogSize(program, ctypes.byref(size))
    said = ctypes.create_string_buffer(size.value)
    compiler.nvrtcGetProgramLog(program, said)
    assert status == 0, said.value.decode()
    compiler.nvrtcGetCUBINSize(program, ctypes.byref(size))
    code = ctypes.create_string_buffer(size.value)
    compiler.nvrtcGetCUBIN(program, code)
    assert b"stribeck_kernel" in code.raw


def on_a_gpu() -> bool:
    try:
        cuda.device()
    except cuda.NoDevice:
        return False
    return True


@pytest.mark.parametrize("name", CASES)
def test_on_a_gpu(name):
    if not on_a_gpu():
        pytest.skip("no GPU, or no CuPy")
    scenario, values = case(name)
    found = stribeck.simulate_ensemble(scenario, values, device="cuda")
    expected = stribeck.simulate_ensemble(scenario, values)
    assert found.reason == expected.reason
    assert found.slips.tolist() == expected.slips.tolist()
    for column in ("y", "v", "F"):
        theirs = expected[column]
        np.testing.assert_allclose(found[column], theirs, rtol=0, atol=1e-6 * np.abs(theirs).max())


def test_without_a_gpu_it_is_said():
    if on_a_gpu():
        pytest.skip("there is a GPU")
    scenario, values = case("sine_force")
    with pytest.raises(stribeck.StribeckError, match=r"device 'cuda'"):
        stribeck.simulate_ensemble(scenario, values, device="cuda")
    with pytest.raises(stribeck.InputError, match=r"device: 'tpu': must be 'cpu' or 'cuda'"):
        stribeck.simulate_ensemble(scenario, values, device="tpu")
