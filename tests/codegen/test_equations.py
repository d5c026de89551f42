"""The generated functions against the equations evaluated with NumPy, and derivatives against differences."""

from types import SimpleNamespace

import numpy as np
import pytest

from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import derivative, symbol
from stribeck.waveforms import Segment
from tests.codegen.harness import compiled
from tests.codegen.systems import IDS, VALUES, VARIANTS, one_signal_each, parameters, states, systems
from tests.simulation.rig import needs_compiler

PIECE = np.array([0.2, 0.6, -1.5])
T = 0.7


def rates_by_numpy(system, x):
    """The time derivatives from the laws' own functions on numbers, and the drives' as docs/scenario.md has them."""
    (contact,), e = system.contacts, system.elements
    friction = contact.friction.kind
    law = friction.symbolic(lambda name: VALUES[name], contact.friction.form)
    constants = SimpleNamespace(**{n: VALUES[n] for owner, n in system.parameters if owner.endswith("signal")})
    kind = system.signals[0].kind
    signal = kind.equation(constants, T) if kind else Segment.equation(Segment(*PIECE), T)
    named = {state.name: value for state, value in zip(system.states, x, strict=True)}
    y, v = named["y"], named.get("v", signal)
    z = named.get("z", 0.0)
    dz_dt = friction.dz_dt(law, v, z)
    F = friction.friction(law, v, z, dz_dt)
    by_name = {}
    if e.controllers:
        u = VALUES["K_p"] * (signal - y) - VALUES["K_i"] * named["I"] - VALUES["K_d"] * v
        by_name["I"] = y - signal
    else:
        u = VALUES["stiffness"] * (signal - y) if e.links else signal if e.loads else F
    by_name |= {"y": v, "z": dz_dt, "E_in": u * v, "v": (u - F) / VALUES["mass"]}
    by_name["E_dissipated"] = F * v - (VALUES["sigma_0"] * z * dz_dt if friction.has_z else 0.0)
    return np.array([by_name[state.name] for state in system.states], float)


def differences(function, x, h=1e-6):
    """The derivatives of a function of a vector by central differences, a column for each entry."""
    return np.stack([(function(x + h * e) - function(x - h * e)) / (2 * h) for e in np.eye(len(x))], axis=-1)


def graph_functions(system):
    """The rates and their Jacobian from the graph, as functions of t and the states."""
    names = [state.name for state in system.states]
    inputs = [f"{owner}.{name}" for owner, name in system.parameters]
    inputs += ["segment.start", "segment.value", "segment.slope", "t", *names]
    rates, n = system.rates(), len(names)
    by_all = [derivative(rate, symbol(name)) for rate in rates for name in ("t", *names)]
    f, jacobian = python_function(inputs, rates), python_function(inputs, by_all)

    def values(t, x):
        return np.array(f(*parameters(system), *PIECE, t, *x), float)

    def derivatives(t, x):
        result = jacobian(*parameters(system), *PIECE, t, *x)
        return np.array(result, float).reshape(n, n + 1)

    return values, derivatives


@pytest.mark.share(5)
@pytest.mark.parametrize(("law", "form"), VARIANTS, ids=IDS)
def test_graph(law, form):
    for system in systems(law, form):
        values, derivatives = graph_functions(system)
        for x in states(system):
            np.testing.assert_allclose(values(T, x), rates_by_numpy(system, x), rtol=1e-13, atol=1e-14)
            by_all = derivatives(T, x)
            by_states = differences(lambda x, f=values: f(T, x), x)
            by_time = differences(lambda t, f=values, x=x: f(t[0], x), np.array([T]))
            np.testing.assert_allclose(by_all, np.hstack([by_time, by_states]), rtol=1e-6, atol=1e-7)


@pytest.mark.share(20)
@needs_compiler
@pytest.mark.parametrize(("law", "form"), VARIANTS, ids=IDS)
def test_compiled_functions(law, form, tmp_path):
    """Rates, and the solution of (shift I - J) k = right, whose J is the Jacobian and whose elimination is code."""
    for i, system in enumerate(one_signal_each(law, form)):
        folder = tmp_path / str(i)
        folder.mkdir()
        library = compiled(system, folder)
        values, derivatives = graph_functions(system)
        n, p = len(system.states), parameters(system)
        for x in states(system):
            dx, k, df_dt, right = np.empty(n), np.empty(n), np.empty(n), np.linspace(-1, 2, n)
            library.test_rates(p, PIECE, T, x, dx)
            np.testing.assert_allclose(dx, values(T, x), rtol=1e-12, atol=1e-13)
            library.test_solve(p, PIECE, T, x, 3.7, right, k, df_dt)
            by_all = derivatives(T, x)
            np.testing.assert_allclose(df_dt, by_all[:, 0], rtol=1e-12, atol=1e-13)
            np.testing.assert_allclose((3.7 * np.eye(n) - by_all[:, 1:]) @ k, right, rtol=1e-10, atol=1e-10)
