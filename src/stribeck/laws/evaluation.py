"""A law with NumPy: rate, force, steady state and derivatives, all from the equations of its class."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.errors import NotDifferentiable
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import BOUND, Expr, derivative, root, substitute, symbol, symbols, wrap
from stribeck.expressions.ops import Value
from stribeck.laws.form import Form
from stribeck.laws.values import Constants, Scales

SLOWEST = 1e-100  # m/s or rad/s: products of slower speeds would vanish


def shaped(value: Value, v: Value, z: Value) -> Array:
    """A value that may not depend on one of v and z, with the shape of both."""
    shape = np.broadcast_shapes(np.shape(v), np.shape(z))
    return np.asarray(value if np.shape(value) == shape else np.full(shape, value))[()]


def steady_deflection(law: type[Evaluation], p: SimpleNamespace, v: Expr, side: Value = 1.0) -> Expr:
    """The deflection z at which dz/dt = 0 while v is held: the closed form where dz/dt is linear in z, else the first
    root that a bristle meets on its way from z = 0. ``side`` is the sign of v."""
    rate = wrap(law.dz_dt(p, v, BOUND))
    slope = derivative(rate, BOUND)
    if BOUND.value not in symbols([slope]):
        (at_0,) = substitute([rate], {BOUND: wrap(0.0)})
        return -at_0 / slope
    return wrap(side * root(wrap(side * law.dz_dt(p, v, side * BOUND)), wrap(law.scales(p).length)))


def steady_force(law: type[Evaluation], p: SimpleNamespace, v: Expr, side: Value = 1.0) -> Expr:
    """The friction force while v is held, as an expression: arrays, compiled machines and exports evaluate this one."""
    z = steady_deflection(law, p, v, side) if law.has_z else wrap(0.0)
    return wrap(law.friction(p, v, z, wrap(0.0)))


@dataclass(frozen=True)
class _Graph:
    """What the graph of a law's equations gives, as functions of its constants and more: ``function`` of v and z gives F
    and the derivatives of dz/dt and F by v and by z, ``steady`` of v and its sign the steady deflection and force;
    ``linear``: whether dz/dt is linear in z."""

    function: Callable[..., tuple[Value, ...]]
    steady: Callable[..., tuple[Value, ...]]
    names: tuple[str, ...]
    linear: bool


class Evaluation:
    """What follows from a law's equations at given velocities and deflections."""

    name: ClassVar[str]
    has_z: ClassVar[bool]

    @property
    def form(self) -> Form:
        """Of the equations."""
        raise NotImplementedError

    dz_dt: Callable[..., Value]
    friction: Callable[..., Value]
    scales: Callable[..., Scales]
    symbolic: Callable[..., Constants]
    guarantees: Callable[[], dict[str, bool | None]]
    p: Constants
    _graphs: ClassVar[dict[tuple[object, ...], _Graph]] = {}

    @property
    def jumps_at_rest(self) -> bool:
        """True where F is discontinuous at v = 0, so that a body cannot come to rest in a simulation."""
        above, below = self.force(1e-300, 0.0), self.force(-1e-300, 0.0)
        return bool(abs(above - below) > 1e-9 * self.scales(self.p).force)

    @property
    def differentiable(self) -> bool:
        """True where F has a time derivative wherever v has one: as the law claims, or where it claims nothing as is found
        at rest, with and without a deflection."""
        smooth = self.guarantees()["smooth"]
        if smooth is not None:
            return smooth
        length = self.scales(self.p).length if self.has_z else 0.0
        try:
            self.force_rate(0.0, np.array([0.0, length, -length]), 1.0)
        except NotDifferentiable:
            return False
        return True

    @property
    def linear(self) -> bool:
        """True where dz/dt is linear in z."""
        return self._graph().linear

    # -- evaluation: NumPy -----------------------------------------------------------------------------------------

    def rate(self, v: ArrayLike, z: ArrayLike) -> Array:
        """dz/dt in m/s for velocities v (m/s) and deflections z (m); shapes broadcast."""
        v, z = np.asarray(v, float)[()], np.asarray(z, float)[()]
        return shaped(self._in_floats(lambda p: self.dz_dt(p, v, z)), v, z)

    def force(self, v: ArrayLike, z: ArrayLike = 0.0) -> Array:
        """Friction force in N for velocities v (m/s) and deflections z (m); shapes broadcast."""
        v, z = np.asarray(v, float)[()], np.asarray(z, float)[()]
        return shaped(self._in_floats(lambda p: self.friction(p, v, z, self.dz_dt(p, v, z))), v, z)

    def force_with(self, v: Array, z: Array, dz_dt: Array) -> Array:
        """Friction force in N for velocities v (m/s), deflections z (m) and rates dz/dt (m/s)."""
        return np.asarray(self._in_floats(lambda p: self.friction(p, v, z, dz_dt)))

    def _in_floats(self, equation: Callable[[Constants], Value]) -> Value:
        """An equation's value; inf or nan, as NumPy has it, where a number of its constants leaves the range of floats."""
        with np.errstate(all="ignore"):
            try:
                return equation(self.p)
            except ArithmeticError:  # Python's own floats raise
                return equation(self.p.replaced({n: np.asarray(x, float)[()] for n, x in self.p.numbers.items()}))

    def jacobian(self, v: ArrayLike, z: ArrayLike = 0.0) -> tuple[Array, Array]:
        """The derivatives of dz/dt by v and by z (1/s), at velocities v and deflections z."""
        rate_v, rate_z = self._evaluate(np.asarray(v, float), np.asarray(z, float))[1:3]
        return rate_v, rate_z

    def force_rate(self, v: ArrayLike, z: ArrayLike, dv_dt: ArrayLike) -> Array:
        """dF/dt in N/s at velocities v (m/s), deflections z (m) and accelerations dv_dt (m/s^2); shapes broadcast.

        Raises:
            NotDifferentiable: F has no time derivative there: v = 0, and F or its two one-sided derivatives differ.
        """
        v, z, dv_dt = np.broadcast_arrays(np.asarray(v, float), np.asarray(z, float), np.asarray(dv_dt, float))
        value, _ = self._force_rate(v, z, dv_dt)
        at_rest = v == 0
        if at_rest.any():
            # both limits v -> 0+ and v -> 0-; where the equations are smooth they agree to rounding
            (above, force_above), (below, force_below) = (
                self._force_rate(np.where(at_rest, side, v), z, dv_dt) for side in (1e-300, -1e-300)
            )
            with np.errstate(all="ignore"):
                differs = ~(abs(above - below) <= 1e-9 * (abs(above) + abs(below)) + 1e-250)  # what 1e-300 m/s leaves
                # a force that jumps is met only when v passes through 0
                jumps = (abs(force_above - force_below) > 1e-9 * self.scales(self.p).force) & (dv_dt != 0)
            if (at_rest & (differs | jumps)).any():
                raise NotDifferentiable(
                    f"law '{self.name}' has no dF/dt at v = 0: its equation holds |v| or sgn(v), so the "
                    "derivatives from the two sides differ; use a smooth law such as lugre_sobczyk or lugre_majorant"
                )
            value = np.where(at_rest, above, value)
        return value[()]

    def steady_deflection(self, v: ArrayLike) -> Array:
        """The deflection z in m at which dz/dt = 0 when v (m/s) is held; 0 at v = 0.

        The root that a bristle starting from z = 0 reaches. Slower speeds than 1e-100 m/s are taken as that: products
        of them would vanish.
        """
        return self._steady(v)[0]

    def steady_force(self, v: ArrayLike) -> Array:
        """The friction force in N when v (m/s) is held for long.

        At v = 0 a body can be held by a range of forces; 0, the middle, is returned.
        """
        return self._steady(v)[1]

    def _steady(self, v: ArrayLike) -> tuple[Array, Array]:
        """The steady deflection and force; 0 at rest."""
        v = np.asarray(v, float)[()]
        moving = np.where(abs(v) < SLOWEST, SLOWEST * np.where(v < 0, -1.0, 1.0), v)[()] if self.has_z else v
        graph = self._graph()
        found = self._in_floats(lambda p: graph.steady(*(p.numbers[n] for n in graph.names), moving, np.sign(moving)))
        z, force = (np.where(v == 0, 0.0, np.broadcast_to(x, np.shape(v)))[()] for x in found)
        return z, force

    # -- derivatives, from the graph of the equations --------------------------------------------------------------

    def _graph(self) -> _Graph:
        key = (type(self), self.form)
        if key not in Evaluation._graphs:
            p, v, z = self.symbolic(symbol, self.form), symbol("v"), symbol("z")
            rate = wrap(self.dz_dt(p, v, z)) if self.has_z else wrap(0)
            force = wrap(self.friction(p, v, z, rate))
            outputs = [force, *(derivative(of, by) for of in (rate, force) for by in (v, z))]
            names = tuple(p.numbers)
            function = python_function([*names, "v", "z"], outputs)
            side = symbol("side")
            z = steady_deflection(type(self), p, v, side) if self.has_z else wrap(0.0)
            steady = python_function([*names, "v", "side"], [z, steady_force(type(self), p, v, side)])
            Evaluation._graphs[key] = _Graph(function, steady, names, linear="z" not in symbols([outputs[2]]))
        return Evaluation._graphs[key]

    def _evaluate(self, v: Array, z: Array) -> list[Array]:
        """F and the derivatives of dz/dt and F by v and z."""
        graph = self._graph()
        v, z = np.broadcast_arrays(v, z)
        found = self._in_floats(lambda p: graph.function(*(p.numbers[n] for n in graph.names), v, z))
        return [np.broadcast_to(x, v.shape)[()] for x in found]

    def _force_rate(self, v: Array, z: Array, dv_dt: Array) -> tuple[Array, Array]:
        force, _, _, force_v, force_z = self._evaluate(v, z)
        rate = self.rate(v, z) if self.has_z else 0.0
        with np.errstate(all="ignore"):
            return np.asarray(force_v * dv_dt + force_z * rate), np.asarray(force)
