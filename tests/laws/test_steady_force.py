"""The steady friction force of every law, against bisection written apart, over 12 decades of speed."""

import numpy as np
import pytest

import stribeck
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import derivative, symbol
from stribeck.laws import builtin
from stribeck.laws.steady import steady_force
from tests.reference.apart_parts import bristles
from tests.simulation.rig import needs_compiler

SPEEDS = np.geomspace(1e-9, 1e3, 49)
COMPENSATOR = {"sigma_0": 25.0, "sigma_1": 0.05, "sigma_2": 4e-4, "F_c": 0.06, "F_s": 0.08, "v_s": 0.8}
SLIDING = [name for name, law in builtin().items() if law.has_z]


def constants(name, rng):
    """Random constants of a law, z_ba from far below the steady deflection to just below it."""
    own = builtin()[name].own_constants()
    p = {
        "sigma_0": 10 ** rng.uniform(0, 9),
        "sigma_1": 0.1,
        "sigma_2": 10 ** rng.uniform(-6, 2),
        "F_c": 10 ** rng.uniform(-3, 3),
    }
    p |= {"F_s": p["F_c"] * rng.choice([1.0, 1.4, 30.0]), "v_s": 10 ** rng.uniform(-5, 1)}
    if "k_v" in own:
        p["k_v"] = 10 ** rng.uniform(1, 9)
    if "z_ba" in own:
        p["z_ba"] = p["F_c"] / p["sigma_0"] * rng.choice([1e-6, 0.01, 0.7, 0.999])
    return p


def bisected(name, p, v):
    """The steady force by halving, to the last bit of z."""
    low, high = 0.0, p["F_s"] / p["sigma_0"]
    while bristles(name, p, v, high)[0] > 0:
        low, high = high, 2 * high
    while low < (middle := low + (high - low) / 2) < high:
        low, high = (middle, high) if bristles(name, p, v, middle)[0] > 0 else (low, middle)
    return p["sigma_0"] * high + (0.0 if name == "dahl" else p["sigma_2"] * v)


@pytest.mark.parametrize("name", SLIDING)
def test_agrees_with_bisection(name):
    rng = np.random.default_rng(7)
    for _ in range(12):
        p = constants(name, rng)
        used = {n: x for n, x in p.items() if n in builtin()[name].constants()}
        expected = np.array([bisected(name, p, v) for v in SPEEDS])
        law = stribeck.law(name, used)
        for side in (1, -1):
            assert law.steady_force(side * SPEEDS) == pytest.approx(side * expected, rel=1e-11)


@pytest.mark.parametrize("name", builtin())
def test_every_form_stands_still_there(name):
    """The force at the steady deflection changes no more, whatever options the equations have."""
    for form in builtin()[name].forms():
        given = {n: c.example or c.default or 1.0 for n, c in builtin()[name].numbers(form).items()}
        given |= {n: x for n, x in COMPENSATOR.items() if n in given}
        given |= (
            {n: 1e-3 for n in ("z_ba",) if n in given} | {n: 0.5 for n in ("v_d",) if n in given} | dict(form.choices)
        )
        law = stribeck.law(name, given)
        z = law.steady_deflection(SPEEDS)
        assert np.all(abs(law.rate(SPEEDS, z)) <= 1e-9 * SPEEDS)
        assert law.steady_force(SPEEDS) == pytest.approx(law.force(SPEEDS, z), rel=1e-9)


def test_its_slope_is_exact():
    """The implicit function's derivative, against differences: a controller's lead and the solver's df/dt use it."""
    law, v = stribeck.law("elastoplastic_majorant", COMPENSATOR, z_ba=1e-3, k_v=5e3), symbol("v")
    names = tuple(law.p.numbers)
    slope = python_function([*names, "v"], [derivative(steady_force(type(law), type(law).symbolic(symbol), v), v)])
    for at in (1e-4, 1.764e-3, 0.3, 2.0):
        h = 1e-5 * at
        difference = (law.steady_force(at + h) - law.steady_force(at - h)) / (2 * h)
        assert float(slope(*law.p.numbers.values(), at)[0]) == pytest.approx(difference, rel=1e-4)


@pytest.mark.parametrize("name", ["elastoplastic", "elastoplastic_sobczyk", "elastoplastic_majorant"])
@pytest.mark.parametrize(
    ("sampled", "backend"), [pytest.param(False, "c", marks=needs_compiler), (True, "wasm"), (False, "wasm")]
)
def test_a_compensation_uses_it(name, sampled, backend, monkeypatch):
    """The machine's controller adds the law's steady force at the reference's speed, from 2 um/s to 2 rad/s."""
    own = {"k_v": 5e3} if "k_v" in builtin()[name].constants() else {}
    rub = {"name": name, "z_ba": 1e-3, **own, "parameters": COMPENSATOR}
    t = np.concatenate([[0.0], np.cumsum(np.full(7, 0.1))])
    rates = 2.0 * 10.0 ** -np.arange(7)
    controller = {
        "on": "arm", "measures": "arm", "kind": "pid", "K_p": 0.0, "K_d": 0.0,
        "signal": {"kind": "points", "t": t.tolist(), "value": np.concatenate([[0.0], np.cumsum(0.1 * rates)]).tolist()},
        "compensation": {"speed": "reference", "law": rub},
        **({"sampling": {"period": 1e-2}} if sampled else {}),
    }  # fmt: skip
    data = {
        "schema": 2, "bodies": {"arm": {"inertia": 1.0}}, "controllers": {"axis": controller},
        "solve": {"t_end": 0.7}, "output": {"step": 0.01},
    }  # fmt: skip
    monkeypatch.setenv("STRIBECK_BACKEND", backend)
    solution = stribeck.simulate(data)
    assert solution.status == "done"
    law = stribeck.law(name, COMPENSATOR, z_ba=1e-3, **own)
    for k, v in enumerate(rates):
        assert solution["axis.u"][10 * k + 5] == pytest.approx(law.steady_force(v), rel=1e-7)
