"""The C++ prototype of the same method, where its sources and a C++ compiler are at hand: a floor to compare with.

The sources are no part of this project. They are looked for in $STRIBECK_PROTOTYPE, then in ../shared/prototypes
beside the checkout.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from ctypes import POINTER, c_double, c_int
from pathlib import Path

import numpy as np
import problems as job
from numpy.typing import NDArray

FLAGS = ("-O3", "-march=native", "-ffast-math")
PLAIN_FLAGS = ("-O3",)
FIRST_STEP = 1e-6

_WRAPPER = """
#include "core.hpp"
extern "C" int prototype(const double* c, double t0, double t1, double rtol, double atol, double h0, int rows,
                         double step, double* out, double* events, int room, double threshold)
{
    Par p{};
    p.s0 = c[0]; p.s1 = c[1]; p.s2 = c[2]; p.Fc = c[3]; p.Fs = c[4]; p.vs = c[5]; p.kv = c[6]; p.m = 1;
    p.Kp = c[7]; p.Ki = c[8]; p.Kd = c[9]; p.yd = c[10];
    const double rest[4] = {0, 0, 0, 0};
    Stats stats;
    return rodas5p<double, 1, 1>(p, t0, t1, rest, rtol, atol, h0, rows, t0, step, out, events, room, threshold, stats);
}
"""
_CONSTANTS = np.array(
    [job.SIGMA_0, job.SIGMA_1, job.SIGMA_2, job.F_C, job.F_S, job.V_S, job.K_V, job.K_P, job.K_I, job.K_D, job.SETPOINT]
)


class Missing(Exception):
    """The prototype cannot be measured here; the text says why."""


class Prototype:
    """The compiled prototype. It starts at t = START from rest, with w = sigma_0 z and one absolute tolerance."""

    def __init__(self, folder: Path, flags: tuple[str, ...]) -> None:
        code = folder / f"prototype-{len(flags)}.cpp"
        code.write_text(_WRAPPER)
        library = _compiled(code, folder, flags)
        self._times, self._step = job.LIMIT_CYCLE.times, job.LIMIT_CYCLE.scenario.output.step
        pointer = POINTER(c_double)
        self._run = library.prototype
        self._run.restype = c_int
        self._run.argtypes = [
            pointer, c_double, c_double, c_double, c_double, c_double, c_int, c_double, pointer, pointer, c_int,
            c_double,
        ]  # fmt: skip

    def solve(self, rtol: float, atol: float) -> NDArray[np.float64]:
        """y at the rows from START on; like stribeck it also locates slip instants and allocates its output."""
        out, events = np.empty((len(self._times), 4)), np.empty(4096)
        status = self._run(
            _pointer(_CONSTANTS), self._times[0], self._times[-1], rtol, atol, FIRST_STEP, len(out),
            self._step, _pointer(out), _pointer(events), len(events), job.V_S,
        )  # fmt: skip
        if status != 0:
            raise ArithmeticError(f"the prototype failed with status {status}")
        return out[:, 0]


class PrototypeOfLanes:
    """The compiled prototype of the ensemble: the processor's vectors, one thread, no events, one absolute tolerance. With
    -ffast-math it does not come to an end."""

    def __init__(self, folder: Path, width: int) -> None:
        flags = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-DINL", f"-DW={width}")
        self._run = _compiled(_sources() / "simdi.cpp", folder, flags).ens_simd
        pointer = POINTER(c_double)
        self._run.restype = ctypes.c_int64
        self._run.argtypes = [
            c_int, pointer, pointer, c_double, c_double, c_double, c_double, c_int, c_double, pointer, c_int,
        ]  # fmt: skip

    def solve(
        self, k_v: NDArray[np.float64], F_s: NDArray[np.float64], times: NDArray[np.float64], rtol: float, atol: float
    ) -> NDArray[np.float64]:
        """y of every lane at the times."""
        k_v, F_s, out = np.ascontiguousarray(k_v), np.ascontiguousarray(F_s), np.zeros((len(k_v), len(times)))
        step = float(times[1] - times[0])
        self._run(
            len(k_v),
            _pointer(k_v),
            _pointer(F_s),
            times[-1],
            rtol,
            atol,
            FIRST_STEP,
            len(times),
            step,
            _pointer(out),
            1,
        )
        return out


def _sources() -> Path:
    found = Path(os.environ.get("STRIBECK_PROTOTYPE", Path(__file__).parents[2] / "shared" / "prototypes"))
    if not (found / "core.hpp").is_file():
        raise Missing("its sources are not here (set STRIBECK_PROTOTYPE to their folder)")
    return found


def _compiled(code: Path, folder: Path, flags: tuple[str, ...]) -> ctypes.CDLL:
    compiler = os.environ.get("CXX") or shutil.which("g++")
    if compiler is None:
        raise Missing("there is no g++")
    library = folder / f"{code.stem}.so"
    command = [compiler, *flags, "-fPIC", "-shared", f"-I{_sources()}", "-o", str(library), str(code)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise Missing(f"it does not compile: {result.stderr.strip().partition(chr(10))[0]}")
    return ctypes.CDLL(str(library))


def _pointer(array: NDArray[np.float64]) -> object:
    return array.ctypes.data_as(POINTER(c_double))
