"""Without a compiler: SciPy's Radau gives the numbers of the compiled solver."""

import numpy as np
import pytest

from stribeck import Scenario, simulate
from tests.simulation.rig import LAWS, law_table, needs_compiler, pid, rig, solved, spring

POINTS = {"kind": "points", "t": [0.0, 0.2, 0.2, 0.5], "value": [0.0, 1.0, -0.5, 1.4]}
DRIVES = {"force": ("force", 1.3), "spring": (spring("canudas1995", 0.1), 0.2), "pid": (pid("canudas1995", 0.2), 0.5),
          "velocity": ("velocity", 3e-3)}  # fmt: skip


@pytest.fixture
def without_compiler(monkeypatch):
    def run(data):
        with monkeypatch.context() as patch:
            patch.setenv("STRIBECK_CC", "none")
            with pytest.warns(match="no C compiler found"):
                return simulate(Scenario(data))

    return run


def assert_same(data, without_compiler):
    compiled, scipy = solved(data), without_compiler(data)
    assert scipy.status == "done"
    assert scipy.stats["solver"] == "scipy-radau"
    assert scipy.stats["built"] is False
    np.testing.assert_array_equal(scipy.t, compiled.t)
    for column in compiled.columns:
        error = np.max(np.abs(scipy[column.name] - compiled[column.name]))
        assert error <= 1e-6 * compiled.peaks[column.name], column.name
    for kind, times in compiled.events.items():
        np.testing.assert_allclose(scipy.events[kind], times, rtol=0, atol=1e-6)


@needs_compiler
@pytest.mark.parametrize(("law", "drive"), [(law, list(DRIVES)[i % 4]) for i, law in enumerate(LAWS)])
def test_same_numbers(law, drive, without_compiler):
    kind, size = DRIVES[drive]
    signal = {**POINTS, "value": [size * value for value in POINTS["value"]]}
    initial = {"y": 1e-5, "z": 3e-6} if law_table(law).get("parameters") and law in LAWS[:8] else {"y": 1e-5}
    assert_same(rig(law, kind, signal, 0.6, rows=60, initial=initial), without_compiler)


@needs_compiler
@pytest.mark.parametrize("drive", ["force", "velocity"])
def test_same_numbers_under_a_sine(drive, without_compiler):
    sine = {"kind": "sine", "amplitude": DRIVES[drive][1], "frequency": 3.0, "phase": 0.5}
    assert_same(rig("lugre_sobczyk", drive, sine, 0.6, rows=60), without_compiler)


def test_progress_and_statistics(without_compiler):
    shares = []
    data = rig("lugre", "force", {"kind": "ramp", "rate": 2.0}, 0.2)
    stats = without_compiler(data).stats
    assert stats["accepted"] > 10
    assert stats["rates"] > stats["jacobians"] > 0
    from stribeck.simulation import fallback

    fallback.solve(Scenario(data), shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
