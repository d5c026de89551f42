"""A number of theory.md, section 4; those of the paper's Table 1 are numbers of the report (tests/paper)."""

import numpy as np

from tests.simulation.rig import law_table, rig, solved


def test_the_smooth_elastoplastic_law_drifts():
    """A 1 Hz sawtooth that stays below sigma_0 z_ba."""
    t = np.repeat(np.arange(9.0), 2)[1:-1]
    sawtooth = {"kind": "points", "t": t.tolist(), "value": [0.0, 0.55] * 8}
    law = law_table("elastoplastic_sobczyk", k_v=1e6, z_ba=0.7e-5)
    y = solved(rig(law, "force", sawtooth, 8.0, rows=8))["y"]
    np.testing.assert_allclose(np.diff(y[3:]), 1.12e-6, rtol=0.05)
