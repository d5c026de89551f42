"""One implicit step of a joint and its bristles, for arrays of any library; exported files contain this text.

The step is backward Euler. The velocity w at its end solves inertia/dt (w - v) + F(w, z(w)) = effort. Here z(w) is the
root x of x = z + dt dz/dt(w, x). The exported C's ``body_step`` does the same, by the same iteration.

``xp`` is the library (``torch``, ``jax.numpy``, ``numpy``), and ``loop(body, state)`` is :func:`loop` or JAX's. ``law`` has
the equations: see :func:`stribeck.exports.python.written.written_equations`.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

from stribeck.expressions.ops import Value


def loop(body: Value, state: Value) -> Value:
    """Repeat body while any entry of state[0] is unfinished."""
    while bool(state[0].any()):
        state = body(state)
    return state


def settled(xp: ModuleType, loop: Callable[..., Value], law: Value, p: Value, v: Value, z: Value, dt: Value) -> Value:
    """z after an implicit step that ends with the velocity v."""
    if not law.has_z:
        return z
    if law.linear:
        a, b = law.hold(p, v)
        return (z + dt * b) / (1 - dt * a)
    rate, slope = law.rate(p, v, z)
    far, guess = z + dt * rate, z + dt * rate / (1 - dt * slope)
    rises, smallest = far > z, xp.finfo(z.dtype).eps

    def closer(state: Value) -> Value:
        open_, count, near, far, x = state
        rate, slope = law.rate(p, v, x)
        excess = x - z - dt * rate
        open_ = open_ & (abs(excess) > smallest * (abs(x) + abs(z) + dt * abs(v))) & (count < 60)
        before = (excess < 0) == rises
        near, far = xp.where(open_ & before, x, near), xp.where(open_ & ~before, x, far)
        newton = x - excess / (1 - dt * slope)
        following = xp.where((newton - near) * (newton - far) < 0, newton, near + (far - near) / 2)
        open_ = open_ & (following != x)
        return open_, count + 1, near, far, xp.where(open_, following, x)

    start = xp.where((guess - z) * (guess - far) < 0, guess, far)
    return loop(closer, (rate != 0, rate * 0, z + 0 * far, far, start))[4]


def balance(
    xp: ModuleType, loop: Callable[..., Value], law: Value, p: Value, w: Value, given: Value
) -> tuple[Value, ...]:
    """The imbalance of forces at w, its derivative by w, the sum of absolute terms, the friction, and z."""
    z, v, effort, inertia, dt = given
    k = inertia / dt
    x = settled(xp, loop, law, p, w, z, dt)
    _, force, rate_v, rate_z, force_v, force_z = law.slopes(p, w, x)
    slope = k + (force_v + force_z * dt * rate_v / (1 - dt * rate_z))
    terms = k * (abs(w) + abs(v)) + abs(force) + abs(effort) + abs(force_v * w) + abs(force_z * x)
    return k * (w - v) - (effort - force), slope, terms, force, x


def solved(xp: ModuleType, loop: Callable[..., Value], law: Value, p: Value, given: Value) -> tuple[Value, ...]:
    """z and the friction after the step, w, and whether the friction jumps at w (F then lies between both sides).

    All entries of ``given`` (z, v, effort, inertia, dt) have one shape. If a number is not finite, or there is no
    solution w, the results are nan.
    """
    _, v, effort, inertia, dt = given
    k, smallest = inertia / dt, xp.finfo(v.dtype).eps
    start = balance(xp, loop, law, p, v, given)
    above = start[0] > 0  # at near: the root lies below
    shortest = smallest * dt / inertia * abs(effort)

    def closer(state: Value) -> Value:
        open_, first, enclosed, near, far, move, w, *balance_at_w = state
        excess, slope = balance_at_w[:2]
        same = (excess > 0) == above
        near, far = xp.where(open_ & same, w, near), xp.where(open_ & ~same, w, far)
        enclosed = enclosed | (open_ & ~same)
        open_ = open_ & ~(enclosed & (abs(far - near) <= smallest * (abs(near) + abs(v) + shortest)))
        newton = w - excess / slope
        inside = xp.where((newton - near) * (newton - far) < 0, newton, near + (far - near) / 2)
        # doubles the distance until the excess changes sign
        move = xp.where(first, -excess / xp.where(slope > k, slope, k), 2 * move)
        following = xp.where(enclosed, inside, near + move)
        open_ = open_ & ~(enclosed & ((following == near) | (following == far)))
        w = xp.where(open_, following, w)
        balance_at_w = [
            xp.where(open_, new, old)
            for new, old in zip(balance(xp, loop, law, p, w, given), balance_at_w, strict=True)
        ]
        open_ = open_ & (abs(balance_at_w[0]) > 2 * smallest * balance_at_w[2]) & xp.isfinite(balance_at_w[0])
        return open_, first & False, enclosed, near, far, move, w, *balance_at_w

    zero = 0 * start[0]
    unfinished = (abs(start[0]) > 2 * smallest * start[2]) & xp.isfinite(start[0])
    state = loop(closer, (unfinished, zero == 0, zero != 0, v + zero, v + zero, zero, v + zero, *start))
    _, _, enclosed, _, _, _, w, excess, _, terms, force, x = state
    coarse = ~(abs(excess) <= 1e3 * smallest * terms)
    fine = xp.isfinite(w) & xp.isfinite(x) & xp.isfinite(force) & (enclosed | ~coarse)
    nothing = xp.where(fine, zero, xp.nan)
    return x + nothing, force - excess + nothing, w + nothing, coarse


def partial(xp: ModuleType, law: Value, p: Value, x: Value, w: Value, given: Value) -> tuple[Value, ...]:
    """At the solution: k, 1 - dt d(rate)/dz, dz/dw, dF/dw, dF/dz, the rate, and the slope of the balance by w."""
    _, _, _, inertia, dt = given
    rate, _, rate_v, rate_z, force_v, force_z = law.slopes(p, w, x)
    k, relief = inertia / dt, 1 - dt * rate_z
    z_w = dt * rate_v / relief
    force_w = force_v + force_z * z_w
    least = xp.finfo(w.dtype).eps ** 0.5 * k  # at a fold the motion jumps; this keeps the slope finite
    return k, relief, z_w, force_w, force_z, rate, xp.where(k + force_w > least, k + force_w, least)


def tangent(
    xp: ModuleType, law: Value, p: Value, solution: Value, given: Value, moved: Value, constants: Value
) -> tuple[Value, Value]:
    """The changes of z and the friction for changes of the five given values and of constants (by name).

    They follow from the partial derivatives of the law's equations by the implicit function theorem.
    """
    x, w, jump = solution
    _, v, _, _, dt = given
    z_, v_, effort_, inertia_, dt_ = moved
    k, relief, z_w, force_w, force_z, rate, slope = partial(xp, law, p, x, w, given)
    each = law.by_constants(p, w, x)
    rates = sum((each[name][0] * change for name, change in constants.items()), 0 * w)
    held = sum((each[name][1] * change for name, change in constants.items()), 0 * w)
    z_held = (z_ + dt_ * rate + dt * rates) / relief  # at the same w
    force_held = held + force_z * z_held
    pushed = effort_ + k * v_ - (w - v) / dt * (inertia_ - k * dt_)
    w_ = xp.where(jump, 0 * w, (pushed - force_held) / slope)
    return z_held + z_w * w_, xp.where(jump, pushed, force_held + force_w * w_)
