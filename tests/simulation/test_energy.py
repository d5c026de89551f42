"""The energy columns: what goes in is stored or dissipated, and each is what its definition says."""

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson

from tests.simulation.rig import LAWS, pid, rig, solved, spring

pytestmark = [pytest.mark.usefixtures("each_system_is_run_once")]

RIGS = {
    "force": ("force", {"kind": "points", "t": [0, 1, 2, 3], "value": [0, 1.8, -1.8, 0]}, {}),
    "spring": (spring("canudas1995", 0.2), {"kind": "ramp", "rate": 0.3}, {"v": 0.02, "y": 0.01}),
    "pid": (pid("canudas1995"), {"kind": "step", "value": 1.0, "time": 0.5}, {}),
    "velocity": ("velocity", {"kind": "points", "t": [0, 1, 2, 3], "value": [0, 4e-3, -4e-3, 0]}, {"y": 1.0}),
}


def with_energy(law, name, rows=300):
    drive, signal, initial = RIGS[name]
    data = rig(law, drive, signal, 3.0, initial=initial, rows=rows)
    data["output"]["energy"] = True
    return data


@pytest.mark.share(7)
@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("law", LAWS)
def test_balance(law, name):
    s = solved(with_energy(law, name))
    stored = s["E_stored"] - s["E_stored"][0]
    np.testing.assert_allclose(s["E_in"], stored + s["E_dissipated"], rtol=0, atol=1e-7 * s.peaks["E_in"])
    assert s.peaks["E_in"] > 0
    assert s["E_in"][0] == s["E_dissipated"][0] == 0


@pytest.mark.parametrize("name", RIGS)
def test_each_column_is_what_it_says(name):
    s = solved(with_energy("lugre_majorant", name, rows=60_000))
    mass = 0.0 if name == "velocity" else 1.0
    np.testing.assert_allclose(s["E_stored"], 1e5 * s["z"] ** 2 / 2 + mass * s["v"] ** 2 / 2, rtol=1e-12)
    u = s["F"] if name == "velocity" else s["u"]
    work = cumulative_simpson(u * s["v"], x=s.t, initial=0)
    np.testing.assert_allclose(s["E_in"], work, rtol=0, atol=1e-6 * s.peaks["E_in"])


def test_energy_columns_do_not_change_the_motion():
    plain = with_energy("lugre_sobczyk", "spring")
    del plain["output"]["energy"]
    a, b = solved(plain), solved(with_energy("lugre_sobczyk", "spring"))
    for name in ("y", "v", "F"):
        np.testing.assert_allclose(a[name], b[name], rtol=0, atol=1e-6 * a.peaks[name])
    with pytest.raises(KeyError):
        a["E_in"]
