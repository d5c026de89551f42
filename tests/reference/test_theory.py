"""The numbers of theory.md, sections 2 and 4: Table 1 of the paper, each to the digits printed there."""

import numpy as np
import pytest

from tests.simulation.rig import law_table, rig, solved

LAWS = {
    "lugre": law_table("lugre"),
    **{f"sobczyk_{k_v}": law_table("lugre_sobczyk", k_v=float(k_v)) for k_v in ("1e6", "1e7", "1e8")},
}


def test_the_smooth_elastoplastic_law_drifts():
    """A 1 Hz sawtooth that stays below sigma_0 z_ba."""
    t = np.repeat(np.arange(9.0), 2)[1:-1]
    sawtooth = {"kind": "points", "t": t.tolist(), "value": [0.0, 0.55] * 8}
    law = law_table("elastoplastic_sobczyk", k_v=1e6, z_ba=0.7e-5)
    y = solved(rig(law, "force", sawtooth, 8.0, rows=8))["y"]
    np.testing.assert_allclose(np.diff(y[3:]), 1.12e-6, rtol=0.05)


@pytest.mark.parametrize(("law", "error"), [("sobczyk_1e7", 6.5e-3), ("majorant", 7.0e-10)])
def test_deviation_from_lugre_in_stick_slip(law, error):
    pull, spring = {"kind": "ramp", "rate": 0.1}, {"kind": "spring", "stiffness": 2.0}
    table = LAWS.get(law) or law_table("lugre_majorant", k_v=1e7)
    y, lugre = (solved(rig(one, spring, pull, 40.0, rows=4000, rtol=1e-11))["y"] for one in (table, "lugre"))
    assert np.max(np.abs(y - lugre)) == pytest.approx(error, rel=0.15)
