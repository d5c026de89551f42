"""Questions about storage that have no answer."""

import pytest

import stribeck


@pytest.mark.parametrize(
    "ask", [stribeck.margins, lambda law, v_max=None: stribeck.storage_interval(law, [0.0], v_max)]
)
def test_what_cannot_be_asked(ask):
    static = stribeck.law("coulomb_viscous", parameters="canudas1995", k_v=1e4)
    with pytest.raises(stribeck.InputError, match="must be a law with z"):
        ask(static)
    with pytest.raises(stribeck.InputError, match="must be a finite number > 0"):
        ask(stribeck.law("lugre", parameters="canudas1995"), v_max=-1.0)
