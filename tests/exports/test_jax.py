"""A law in JAX: the same numbers, and gradients by velocity, deflection and every constant."""

import numpy as np
import pytest

import stribeck
from stribeck.errors import StribeckNote
from stribeck.exports.python import to_jax
from stribeck.laws import builtin
from tests.laws.test_sanity import CANUDAS, make

jax = pytest.importorskip("jax", reason="JAX is not installed (600 MB): pip install jax")


@pytest.fixture(autouse=True)
def _double():
    before = jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", before)


def points(law, count=200):
    rng, scales = np.random.default_rng(2), law.scales(law.p)
    v = rng.choice([-1, 1], count) * scales.speed * 10 ** rng.uniform(-6, 4, count)
    return v, rng.uniform(-1.2, 1.2, count) * scales.length


@pytest.mark.parametrize("name", builtin())
def test_numbers_and_gradients(name):
    law = make(builtin()[name])
    tool = to_jax(law)
    v, z = points(law)
    force, opposite = law.force(v, z), law.force(v, -z)
    assert np.all(abs(np.asarray(jax.jit(tool.force)(v, z)) - force) <= 1e-13 * (abs(force) + abs(opposite)))
    if not law.has_z:
        h = 1e-6 * abs(v)
        slope = jax.vmap(jax.grad(tool.force))(v)
        wanted = (law.force(v + h) - law.force(v - h)) / (2 * h)
        assert np.allclose(slope, wanted, rtol=1e-5, atol=1e-8 * np.max(abs(force / v)))
        return
    size = abs(law.rate(v, z)) + abs(law.rate(v, -z))
    assert np.all(abs(np.asarray(tool.rate(v, z)) - law.rate(v, z)) <= 1e-13 * size)
    result = jax.jit(jax.vmap(jax.grad(tool.rate, (0, 1))))(v, z)
    for got, wanted in zip(result, law.jacobian(v, z), strict=True):
        assert np.all(abs(got - wanted) <= 1e-9 * (abs(wanted) + 1))


def test_gradients_by_constants():
    law = make(builtin()["elastoplastic_majorant"])
    tool = to_jax(law)
    v, z, names = 2e-3, 9e-6, [n for n, x in law.values.items() if n != "v_s" and x is not None]
    slopes = jax.jit(jax.grad(lambda p: tool.force(v, z, **p)))({n: law.values[n] for n in names})
    for name in names:
        h = 1e-5 * law.values[name]
        above, below = (type(law)({**law.values, name: law.values[name] + s * h}).force(v, z) for s in (1, -1))
        assert float(slopes[name]) == pytest.approx((above - below) / (2 * h), rel=1e-5, abs=1e-9 / law.values[name]), (
            name
        )


def test_a_rollout_is_differentiable():
    """An implicit step of the bristle under jit and grad: the slope of the force by F_s agrees with differences."""
    law = stribeck.law("lugre_majorant", "canudas1995", k_v=1e6)
    tool = to_jax(law)

    def last(F_s):
        def step(z, v):
            rate, slope = tool.rate(v, z, F_s=F_s), jax.grad(tool.rate, 1)(v, z, F_s=F_s)
            z = z + 1e-3 * rate / (1 - 1e-3 * slope)
            return z, tool.force(v, z, F_s=F_s)

        return jax.lax.scan(step, 0.0, jax.numpy.full(600, 5e-4))[1][-1]

    assert float(last(1.5)) == pytest.approx(float(law.steady_force(5e-4)), rel=1e-6)
    slope = float(jax.jit(jax.grad(last))(1.5))
    assert slope == pytest.approx((float(last(1.5001)) - float(last(1.4999))) / 2e-4, rel=1e-6)


def test_single_precision_is_said_and_unknown_constants_are_refused():
    law = stribeck.law("lugre", CANUDAS)
    with pytest.raises(stribeck.InputError, match="did you mean 'F_s'"):
        to_jax(law).force(1.0, 0.0, Fs=2.0)
    jax.config.update("jax_enable_x64", False)
    with pytest.warns(StribeckNote, match="single precision"):
        tool = to_jax(law)
    assert float(tool.force(1e-3, 1e-6)) == pytest.approx(float(law.force(1e-3, 1e-6)), rel=1e-5)
