"""A body's motion against Newton's second law, and the energy that it has."""

from types import SimpleNamespace

import pytest

from stribeck.export.c.ccode import net_force
from stribeck.expressions.graph import derivative, symbol, wrap
from stribeck.plants.mass import Mass

P = SimpleNamespace(mass=2.5)


def test_the_drive_less_the_friction_accelerates_the_body():
    assert Mass.acceleration(P, 7.0, 2.0) == pytest.approx(2.0, rel=1e-15)
    assert Mass.stored_energy(P, 0.0, 4.0, ()) == pytest.approx(20.0, rel=1e-15)


def test_the_power_of_the_net_force_is_what_the_kinetic_energy_gains():
    v, u, F = symbol("v"), symbol("u"), symbol("F")
    gained = derivative(wrap(Mass.stored_energy(SimpleNamespace(mass=symbol("m")), symbol("y"), v, ())), v)
    rate = gained * Mass.acceleration(SimpleNamespace(mass=symbol("m")), u, F)
    from stribeck.expressions.emit import python_function

    (power,) = python_function(["m", "v", "u", "F"], [rate])(2.5, 3.0, 7.0, 2.0)
    assert power == pytest.approx(3.0 * Mass.net_force(7.0, 2.0), rel=1e-14)


def test_the_c_has_the_same_balance():
    assert net_force() == {"value": "u - F", "by_F": "-R(1.0)"}
