"""Numerical tests of what a law claims with its given constants; a law inherits them by claiming.

A test that passes is no proof, but each looks where a false claim shows: at the bound, at kinks, at every speed from
far below to far above the law's own. A velocity that is held moves z one way until dz/dt = 0, so what a velocity
programme can do is known without integrating over time: where z gets, and the energy F v/(dz/dt) on every piece of it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law

_SPEEDS = (1e-9, 1e4)  # sampled, as multiples of the law's own speed
_ROUNDING = 1e-12  # of the largest term: what is smaller is taken as 0


def violations(law: Law, seed: int = 0) -> list[str]:
    """What contradicts a law's claims, in one line each; an empty list when nothing was found.

    Tested are the claims that hold for the law's constants, and what every law has to obey: finite F and dz/dt, which
    change sign with (v, z) unless the law says ``symmetric = False``; the same results for arrays as for numbers; and
    derivatives that agree with differences.

    Args:
        law: the law, with its constants.
        seed: of the random samples.
    """
    if trouble := laws.trouble(law):
        return [trouble]
    claimed = law.guarantees()
    found = []
    for name, test in [*_SANITY.items(), *((n, test) for n, test in _CLAIMS.items() if claimed[n])]:
        try:
            with np.errstate(all="ignore"):
                text = test(_Samples(law, np.random.default_rng(seed)))
        except Exception as error:
            text = f"cannot be tested: {type(error).__name__}: {error}"
        found += [f"{name}: {text}"] if text else []
    return found


class _Samples:
    """A law, and random velocities and deflections of every magnitude that matters to it."""

    def __init__(self, law: Law, rng: np.random.Generator) -> None:
        self.law, self.rng = law, rng
        self.speed, self.length = law.scales(law.p).speed, law.scales(law.p).length
        self.bound = float(law.z_bound(law.p)) if law.has_z and law.guarantees()["bounded"] else 10 * self.length

    def v(self, *shape: int, largest: float = _SPEEDS[1]) -> Array:
        """Velocities of both signs, their magnitudes even on a logarithmic scale."""
        low, high = np.log(_SPEEDS[0]), np.log(largest)
        return self.rng.choice([-1.0, 1.0], shape) * self.speed * np.exp(self.rng.uniform(low, high, shape))

    def z(self, *shape: int) -> Array:
        """Deflections within the bound."""
        return self.rng.uniform(-1, 1, shape) * self.bound

    def size(self, function: Callable[..., Value], v: Array, z: Array) -> Array:
        """The magnitude of the terms of F or dz/dt, which may cancel each other."""
        return np.asarray(np.max([abs(function(v, x)) for x in (z, -z, 0 * z)], axis=0))


def _where(wrong: Value, text: str, **values: Array | float) -> str | None:
    """The text with the values at the first place that is wrong; None where there is none."""
    if not np.any(wrong):
        return None
    i = int(np.argmax(wrong))
    units = {"v": "m/s", "z": "m", "dv_dt": "m/s^2"}
    words = (f"{name} = {np.broadcast_to(x, np.shape(wrong)).flat[i]:.6g} {units[name]}" for name, x in values.items())
    return f"{text} at {', '.join(words)}"


# -- what every law has to obey --------------------------------------------------------------------------------------


def _values(s: _Samples) -> str | None:
    v, z = np.append(s.v(500), 0.0), np.append(s.z(500), 0.0)
    for name, function in (("F", s.law.force), ("dz/dt", s.law.rate)):
        values, opposite = function(v, z), function(-v, -z)
        odd = abs(values + opposite) <= _ROUNDING * s.size(function, v, z)
        text = _where(~np.isfinite(values), f"{name} is not finite", v=v, z=z) or _where(
            ~odd & (v != 0) & s.law.symmetric, f"{name} does not change sign with (v, z)", v=v, z=z
        )
        if text:
            return text
    return None


def _arrays(s: _Samples) -> str | None:
    v, z = s.v(4, 1), s.z(5)
    sliding = ("F when sliding", lambda v, z: s.law.steady_force(v) + 0 * z)
    for name, function in (("F", s.law.force), ("dz/dt", s.law.rate), sliding):
        table = np.asarray(function(v, z))
        single = np.array([[function(float(a), float(b)) for b in z] for a in v[:, 0]])
        same = abs(table - single) <= _ROUNDING * abs(single).max(axis=1, keepdims=True)
        if table.shape != (4, 5) or not same.all():
            return f"{name} of arrays differs from that of numbers"
    return None


def _differs(derivative: Value, of: Callable[[Array], Array], step: Array, size: Array) -> Value:
    """Where a derivative disagrees with each of some central differences, with relative steps of 1e-3 to 1e-7."""
    h = 10.0 ** -np.arange(3, 8)[:, None] * step
    difference = (of(h) - of(-h)) / (2 * h)
    return ~(abs(difference - derivative) <= 1e-5 * abs(derivative) + 1e-14 * size / h).any(axis=0)


def _jacobian(s: _Samples) -> str | None:
    v, z = s.v(300), s.z(300)
    rate, (by_v, by_z), size = s.law.rate, s.law.jacobian(v, z), s.size(s.law.rate, v, z)
    wrong_v = _differs(by_v, lambda h: rate(v + h, z), abs(v), size)
    wrong_z = _differs(by_z, lambda h: rate(v, z + h), abs(z), size)
    text = "the derivative of dz/dt by {} disagrees with differences"
    return _where(wrong_v, text.format("v"), v=v, z=z) or _where(wrong_z, text.format("z"), v=v, z=z)


def _force_rate(s: _Samples) -> str | None:
    v, z = s.v(300), s.z(300)
    force, rate = s.law.force, s.law.rate(v, z)
    time = 1 / np.maximum(abs(rate / z), 1e-9 * s.speed / s.length)
    dv_dt = v / time * s.rng.uniform(-1, 1, 300)
    of, size = (lambda h: force(v + h * dv_dt, z + h * rate)), s.size(force, v, z)
    wrong = _differs(s.law.force_rate(v, z, dv_dt), of, time, size)
    return _where(wrong, "dF/dt disagrees with differences", v=v, z=z, dv_dt=dv_dt)


# -- what a law may claim --------------------------------------------------------------------------------------------


def _refine(of: Callable[[Array], Array], levels: int) -> tuple[Array, Array]:
    """The largest changes of a function on [0, 1] between neighbours of a grid, followed to ever smaller intervals.

    ``of`` maps arrays (lines, points) to values of that shape. Returned are the changes at every halving, as an array
    (levels + 1, lines, places), and the places.
    """
    grid = np.linspace(0, 1, 400)[None, :]
    chosen = np.argsort(abs(np.diff(of(grid), axis=1)), axis=1)[:, -8:]
    low, high = grid[0, chosen], grid[0, chosen + 1]
    f_low, f_high = of(low), of(high)
    changes = [abs(f_high - f_low)]
    for _ in range(levels):
        middle = 0.5 * (low + high)
        f = of(middle)
        left = abs(f - f_low) >= abs(f_high - f)
        low, f_low = np.where(left, low, middle), np.where(left, f_low, f)
        high, f_high = np.where(left, middle, high), np.where(left, f, f_high)
        changes.append(abs(f_high - f_low))
    return np.array(changes), low


def _unique(s: _Samples) -> str | None:
    """dz/dt is Lipschitz in z on bounded sets, and |z| grows at most in proportion to itself."""
    v = np.append(s.v(30), 0.0)[:, None]
    for reach in (2 * s.bound, 200 * s.bound):
        change, at = _refine(lambda x, r=reach: s.law.rate(v, r * (2 * x - 1)), 28)  # type: ignore[misc]
        steeper = change[28] * 2.0**14 / np.maximum(change[14], 1e-11 * abs(v) + 1e-300)  # than 14 halvings before
        text = "a second solution may start where dz/dt is not Lipschitz in z,"
        if found := _where(steeper > 4, text, v=v, z=reach * (2 * at - 1)):
            return found
    far, farther = (max((s.law.rate(v, x * z) / (x * z)).max() for z in (s.bound, -s.bound)) for x in (1e3, 1e6))
    return "z reaches infinity in finite time" if farther > 10 * max(far, 1e-9 * s.speed / s.bound) else None


def _bounded(s: _Samples) -> str | None:
    """No held velocity moves z outward at the bound, and no programme of velocities brings it there."""
    v = s.v(1000)
    for edge in (s.bound, -s.bound):
        outward = np.sign(edge) * s.law.rate(v, edge) > _ROUNDING * s.size(s.law.rate, v, 0 * v + edge)
        if found := _where(outward, "dz/dt points out of the bound", v=v, z=edge):
            return found
    z, lanes, share = s.z(100), np.arange(100), np.linspace(0, 1, 33)[:, None]
    for _ in range(60):
        choice = s.v(8, 100)
        outmost = (s.law.rate(choice, z) * np.sign(z) / abs(choice)).argmax(axis=0)
        held = choice[np.where(lanes < 50, outmost, 0), lanes]  # half of the programmes press outward
        direction = np.sign(s.law.rate(held, z))
        path = z + share * (direction * s.bound * (1 + 1e-9) - z)
        reached = (s.law.rate(held, path) * direction > 0).cumprod(axis=0).sum(axis=0)  # z moves up to a root of dz/dt
        if found := _where(reached == len(share), "z passes its bound when held long", v=held, z=z):
            return found
        z = z + s.rng.random(100) * (path[np.maximum(reached - 1, 0), lanes] - z)
    return None


def _smooth(s: _Samples) -> str | None:
    """dz/dt and its derivatives do not jump along lines in the (v, z) plane, and dF/dt exists at v = 0."""
    rate, jacobian = s.law.rate, s.law.jacobian
    along_v, along_z = (np.repeat(x, 10)[:, None] for x in ([1, 0, 1, 0], [0, 1, 1, 1]))  # the last ones at v = 0
    v_0 = s.v(40, 1, largest=10.0) * np.repeat([1, 1, 1, 0], 10)[:, None]
    z_0 = np.where(along_z, 1.5 * s.bound, s.z(40, 1))

    def line(x: Array) -> tuple[Array, Array]:
        return np.where(along_v, v_0 * (2 * x - 1), v_0 + 0 * x), np.where(along_z, z_0 * (2 * x - 1), z_0 + 0 * x)

    by_name: dict[str, Callable[[Array, Array], Array]] = {
        "dz/dt": rate,
        "its derivative by v": lambda v, z: jacobian(v, z)[0],
        "its derivative by z": lambda v, z: jacobian(v, z)[1],
    }
    for name, of in by_name.items():
        values = of(*line(np.linspace(0, 1, 400)[None, :]))
        change, at = _refine(lambda x, of=of: of(*line(x)), 44)  # type: ignore[misc]
        jump = change[44] > 1e-3 * np.maximum(np.ptp(values, axis=1), 1e-9 * abs(values).max(axis=1))[:, None]
        if found := _where(jump, f"{name} jumps", **dict(zip("vz", line(at), strict=True))):
            return found
    s.law.force_rate(0.0, s.z(50), s.v(50))  # or raises NotDifferentiable
    return None


def _passive(s: _Samples) -> str | None:
    """No cycle draws energy: winding z up costs at every z what unwinding it gives back, or more; sliding costs too."""
    v, share = s.v(1200, largest=1e8)[:, None], np.sin(np.linspace(0, np.pi / 2, 150))[None, 1:-1]
    for side in (1.0, -1.0):
        z = side * s.bound * share
        outward = side * s.law.rate(v, z)
        energy = s.law.force(v, z) * v / outward  # put in for a metre of z outward
        sure = abs(outward) > 1e-9 * s.size(s.law.rate, v + 0 * z, z + 0 * v)
        cost = np.where(sure & (outward > 0), energy, np.inf).min(axis=0)
        gain = np.where(sure & (outward < 0), energy, -np.inf).max(axis=0)
        wrong = gain - cost > 1e-9 * (abs(gain) + abs(cost))
        if found := _where(wrong, "two velocities by turns draw energy for ever", z=z[0]):
            return found
    return _where(s.law.steady_force(v) * v < 0, "sliding draws energy", v=v)


def _drift_free(s: _Samples) -> str | None:
    z_0 = float(s.law.z_elastic(s.law.p))
    if not z_0 > 0:
        return f"the elastic deflection is {z_0} m: must be > 0"
    v, z = s.v(1000), np.append(s.rng.uniform(-z_0, z_0, 998), [z_0, -z_0])
    return _where(s.law.rate(v, z) != v, "dz/dt is not v", v=v, z=z)


_Test = Callable[[_Samples], str | None]

_SANITY: dict[str, _Test] = {"values": _values, "arrays": _arrays, "derivatives": _jacobian, "force rate": _force_rate}
_CLAIMS: dict[str, _Test] = {
    "unique": _unique, "bounded": _bounded, "smooth": _smooth, "passive": _passive, "drift_free": _drift_free,
}  # fmt: skip
