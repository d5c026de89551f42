"""A law's friction force for a measured velocity, and a body's motion for a measured force, compiled; several sets of
parameters at a time."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from ctypes import POINTER, c_double, c_int, c_int64
from dataclasses import dataclass
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


Numbers = Mapping[str, NDArray[np.generic]]
Answer = tuple[Array, ...] | None


@dataclass(frozen=True)
class Question:
    """What a compiled law is asked: a function of the source ``text``, and its arrays by name."""

    function: str
    text: str
    numbers: Numbers


def answer(question: Question) -> Answer:
    """The arrays of an answer; None where the integration failed.

    Raises:
        BuildError: there is no C compiler, or it failed.
    """
    call = getattr(_built(question.text), question.function)
    numbers = {name: np.ascontiguousarray(x) for name, x in question.numbers.items()}
    found = (_responded if question.function == Response.function else _moved)(call, numbers)
    return found if found is not None and all(np.isfinite(x).all() for x in found) else None


def _responded(call: Callable[..., int], n: Numbers) -> Answer:
    count, lanes = len(n["t"]), len(n["constants"])
    out, state, present = np.empty((lanes, count)), np.array(n["z"], float), np.empty_like(n["constants"])
    status = call(
        count, _pointer(n["t"]), _pointer(n["v"]), _pointer(n["bend"]), lanes, _pointer(n["constants"]),
        _pointer(n["shift"]) if "shift" in n else None, _pointer(n["gain"]), float(n["tolerance"].item(0)),
        _STEPS_A_SAMPLE * count, _pointer(present), _pointer(state), _pointer(out),
    )  # fmt: skip
    return (out,) if status == 0 else None


def _moved(call: Callable[..., int], n: Numbers) -> Answer:
    count, lanes = len(n["t"]), len(n["constants"])
    work, y, v = np.zeros((2, lanes, 3)), np.empty((lanes, count)), np.empty((lanes, count))
    status = call(
        count, _pointer(n["t"]), _pointer(n["force"]), _pointer(n["bends"]), lanes, _pointer(n["constants"]),
        _pointer(n["mass"]), len(n["first"]), n["first"].ctypes.data_as(POINTER(c_int64)), _pointer(n["states"]),
        _pointer(n["tolerance"]), _STEPS_A_SAMPLE * count, _pointer(work[0]), _pointer(work[1]), _pointer(y), _pointer(v),
    )  # fmt: skip
    return (y, v) if status == 0 else None


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
        self._text = _SOURCES[self.function](law, form)
        _built(self._text)

    def _asked(self, **numbers: NDArray[np.generic]) -> Answer:
        return answer(Question(self.function, self._text, numbers))

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
        gain = np.array([float(name in shifted) for name in self.names])
        grown = {} if shift is None else {"shift": np.asarray(shift, float)}
        t, v, constants, z = (np.asarray(x, float) for x in (t, v, constants, z))
        found = self._asked(
            t=t, v=v, bend=_bends(v), constants=constants, z=z, gain=gain, tolerance=np.array([tolerance]), **grown
        )
        return None if found is None else found[0]


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
        mass = np.array([each["mass"] for each in sets], float)
        bends = np.zeros(force.shape) if straight else np.array([_bends(each) for each in force])
        t, force, states = (np.asarray(x, float) for x in (t, force, states))
        found = self._asked(
            t=t, force=force, bends=bends, constants=self.lanes(sets), mass=mass, first=np.asarray(first, np.int64),
            states=states, tolerance=np.array(tolerance, float),
        )  # fmt: skip
        return None if found is None else (found[0], found[1])


def _built(text: str) -> ctypes.CDLL:
    """The compiled library of a source.

    Raises:
        BuildError: there is no C compiler, or it failed.
    """
    chosen = compiler.find()
    if chosen is None:
        raise BuildError("a simulation-error fit needs a C compiler, and none was found (pip install 'stribeck[fmu]')")
    return cache.library(text, chosen, _check)[0]


def _pointer(array: NDArray[np.generic]) -> ctypes._Pointer[c_double]:
    return array.ctypes.data_as(POINTER(c_double))


def _bends(v: Array) -> Array:
    """How far the mean of v between two samples exceeds the mean of these, by a cubic through the four around; v must
    be sampled evenly. Where v has a corner it errs by no more than straight lines do elsewhere."""
    found = np.zeros(len(v))
    if len(v) >= 4:
        found[1:-2] = -(v[3:] - v[2:-1] - v[1:-2] + v[:-3]) / 24
    return found
