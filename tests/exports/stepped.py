"""The implicit step of the learning simulators on NumPy's arrays, as torch and JAX have it."""

from types import SimpleNamespace

import numpy as np

from stribeck.exports.python import stepping
from stribeck.exports.python.written import written_equations
from tests.exports.harness import LAWS, law

SCOPE = {name: getattr(np, name) for name in ("exp", "log", "sqrt", "sin", "cos", "tanh", "sign", "floor", "where")}
SCOPE |= {"atan": np.arctan, "both": np.logical_and, "either": np.logical_or, "like": np.full_like}


class Stepped:
    """A law's step, and its derivatives."""

    def __init__(self, of):
        self.law, self.equations = of, written_equations(of, dict(SCOPE))
        self.constants = {n: x for n, x in of.values.items() if x is not None}

    def solve(self, *given, **constants):
        p = SimpleNamespace(**{**self.constants, **constants})
        given = tuple(np.broadcast_arrays(*(np.asarray(x, float) for x in given)))
        with np.errstate(all="ignore"):
            return p, given, stepping.solved(np, stepping.loop, self.equations, p, given)

    def slopes(self, p, given, solution):
        """The derivatives of z and the friction by each of the five given values and each constant."""
        each = {}
        for name in (*range(5), *self.constants):
            moved, constants = [np.full(len(given[0]), float(i == name)) for i in range(5)], {}
            if name in self.constants:
                constants = {name: np.ones(len(given[0]))}
            each[name] = stepping.tangent(np, self.equations, p, solution, given, moved, constants)
        return each

    def __call__(self, *given, **constants):
        """z and the friction after the step, for z, v, effort, inertia, dt."""
        return self.solve(*given, **constants)[2][:2]


def problems(of, count, seed, wide=True):
    """z, v, effort, inertia and dt at random; some at rest."""
    rng, scales = np.random.default_rng(seed), of.scales(of.p)
    decades = rng.uniform(-6, 2, count) if wide else np.zeros(count)
    v = rng.normal(size=count) * scales.speed * 10**decades
    if wide:
        v[:5] = 0.0
    z = rng.uniform(-0.95, 0.95, count) * scales.length * of.has_z
    effort = rng.normal(size=count) * 2 * scales.force
    inertia = 10 ** (rng.uniform(-3, 3, count) if wide else rng.uniform(-1, 1, count))
    dt = 10 ** (rng.uniform(-4, -1.5, count) if wide else rng.uniform(-3, -2, count))
    return z, v, effort, inertia, dt


__all__ = ["LAWS", "Stepped", "law", "problems"]
