"""A law's friction force for a measured velocity, and a body's motion for a measured force, compiled; several sets of
parameters at a time."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from ctypes import POINTER, c_double, c_int, c_int64
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.codegen.response import motion_source, response_parameters, response_source
from stribeck.errors import BuildError
from stribeck.laws.base import Law
from stribeck.laws.form import USUAL, Form
from stribeck.simulation import cache, compiler

_STEPS_A_SAMPLE = 1000


_P, _N = POINTER(c_double), c_int64
_CALLS: dict[str, list[object]] = {
    "stribeck_respond": [_N, _P, _P, _P, _N, _P, _P, _P, c_double, _N, _P, _P, _P],
    "stribeck_move": [_N, _P, _P, _P, _N, _P, _P, _N, POINTER(c_int64), _P, _P, _N, _P, _P, _P, _P],
}
_SOURCES = {"stribeck_respond": response_source, "stribeck_move": motion_source}


def _check(library: ctypes.CDLL) -> None:
    """Make sure that the library answers to a velocity or a force, and say how it is called."""
    name = next((name for name in _CALLS if hasattr(library, name)), None)
    if name is None:
        raise BuildError("the library built is no compiled response")
    call = getattr(library, name)
    call.argtypes, call.restype = _CALLS[name], c_int


class _Compiled:
    """What a law's constants and a record go through.

    Args:
        law: the law.
        form: of its equations.

    Raises:
        BuildError: there is no C compiler, or it failed.
    """

    function: ClassVar[str]

    def __init__(self, law: type[Law], form: Form = USUAL) -> None:
        self.names = response_parameters(law, form)
        self._call = getattr(_built(_SOURCES[self.function](law, form)), self.function)

    def lanes(self, sets: Sequence[Mapping[str, float]]) -> Array:
        """Sets of constants as rows in the order that the compiled code takes."""
        return np.array([[each[name] for name in self.names] for each in sets], float)


class Response(_Compiled):
    """The compiled answer of a law to a velocity: F(t) for v(t) given by samples and smooth between them."""

    function = "stribeck_respond"

    def force(
        self,
        t: Array,
        v: Array,
        constants: Array,
        z: Array,
        tolerance: float,
        shift: Array | None = None,
        shifted: Sequence[str] = (),
    ) -> Array | None:
        """The friction force in N, shape (lanes, samples); None where the integration failed.

        Args:
            t: times of the samples, s, rising.
            v: velocity there, m/s; its integral from sample to sample is taken from cubics through four of them.
            constants: a row of the law's constants for each lane (:meth:`lanes`).
            z: deflection of each lane at the first sample, m.
            tolerance: largest error of the first lane's deflection in a step, m; all lanes take the same steps.
            shift: what some constants grow by at each sample, shape (lanes, samples).
            shifted: the names of these constants.
        """
        inputs = [np.ascontiguousarray(x, float) for x in (t, v, constants)]
        bend = _bends(inputs[1])
        gain = np.array([float(name in shifted) for name in self.names])
        grown = None if shift is None else np.ascontiguousarray(shift, float)
        out, state, present = np.empty((len(constants), len(t))), np.array(z, float), np.empty_like(inputs[2])
        t_, v_, constants_, present_, state_, out_ = (_pointer(x) for x in (*inputs, present, state, out))
        status = self._call(
            len(t), t_, v_, _pointer(bend), len(constants), constants_,
            None if grown is None else _pointer(grown), _pointer(gain), tolerance, _STEPS_A_SAMPLE * len(t),
            present_, state_, out_,
        )  # fmt: skip
        return out if status == 0 and np.isfinite(out).all() else None


class ForcedBody(_Compiled):
    """The motion of a body under a measured force and a law's friction: y(t), v(t) for F(t) given by samples."""

    function = "stribeck_move"

    def of(
        self, t: Array, force: Array, sets: Sequence[Mapping[str, float]], first: NDArray[np.int64], states: Array,
        tolerance: tuple[float, float, float], straight: bool = False,
    ) -> tuple[Array, Array] | None:  # fmt: skip
        """Position (m) and velocity (m/s), each of shape (lanes, samples); None where the integration failed.

        Args:
            t: times of the samples, s, rising evenly.
            force: each lane's driving force there, N, (lanes, samples); a cubic through four samples gives its mean from one
                to the next.
            sets: for each lane the law's constants and "mass" (kg).
            first: the samples at which windows begin, rising from 0; each has states of its own.
            states: position, velocity and deflection of each lane at the start of each window, (windows, lanes, 3).
            tolerance: largest error of the first lane's position, velocity and deflection in a step; all lanes take the
                same steps.
            straight: take the force from sample to sample as a straight line.
        """
        lanes = len(sets)
        constants = self.lanes(sets)
        mass = np.array([each["mass"] for each in sets], float)
        bend = np.zeros(force.shape) if straight else np.array([_bends(each) for each in force])
        inputs = [np.ascontiguousarray(x, float) for x in (t, force, bend, constants, mass, states)]
        t_, force_, bend_, constants_, mass_, states_ = (_pointer(x) for x in inputs)
        begin, limits = np.ascontiguousarray(first, np.int64), np.array(tolerance)
        work, y, v = np.zeros((2, lanes, 3)), np.empty((lanes, len(t))), np.empty((lanes, len(t)))
        status = self._call(
            len(t), t_, force_, bend_, lanes, constants_, mass_, len(begin), begin.ctypes.data_as(POINTER(c_int64)),
            states_, _pointer(limits), _STEPS_A_SAMPLE * len(t), _pointer(work[0]), _pointer(work[1]), _pointer(y),
            _pointer(v),
        )  # fmt: skip
        return (y, v) if status == 0 and np.isfinite(y).all() and np.isfinite(v).all() else None


def _built(text: str) -> ctypes.CDLL:
    """The compiled library of a source.

    Raises:
        BuildError: there is no C compiler, or it failed.
    """
    chosen = compiler.find()
    if chosen is None:
        raise BuildError(
            "a simulation-error fit needs a C compiler, and none was found (pip install 'stribeck[compiler]')"
        )
    return cache.library(text, chosen, _check)[0]


def _pointer(array: Array) -> ctypes._Pointer[c_double]:
    return array.ctypes.data_as(POINTER(c_double))


def _bends(v: Array) -> Array:
    """How far the mean of v between two samples exceeds the mean of these, by a cubic through the four around; v must
    be sampled evenly. Where v has a corner it errs by no more than straight lines do elsewhere."""
    found = np.zeros(len(v))
    if len(v) >= 4:
        found[1:-2] = -(v[3:] - v[2:-1] - v[1:-2] + v[:-3]) / 24
    return found
