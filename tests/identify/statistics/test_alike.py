"""An arm's weight on a part of a turn looks like a spring."""

import numpy as np
import pytest

from stribeck import fit
from stribeck.identify.api import read_log
from stribeck.identify.methods.static import Setting, finished, settle
from stribeck.identify.models.static_problem import rows_of
from stribeck.identify.statistics import alike


@pytest.mark.parametrize(("way", "told"), [(0.4, False), (3.0, True)])
def test_a_spring_is_not_told_where_a_weight_does_as_well(way: float, told: bool) -> None:
    """On 0.4 rad stiffness = 2.989 [2.984, 2.995] was told as known, where there is a weight of 3 N m and no spring."""
    draw, t = np.random.default_rng(1), np.arange(0, 30, 5e-3)
    rates, phases = 2 * np.pi * np.array([0.11, 0.37]), np.array([0.3, 1.1])
    y = way / 2 * (np.sin(np.outer(t, rates) + phases) @ np.array([0.7, 0.3]))
    v = way / 2 * (np.cos(np.outer(t, rates) + phases) @ (np.array([0.7, 0.3]) * rates))
    force = 3 * np.sin(y) + 0.5 * np.sign(v) + 0.2 * v + 0.02 * draw.standard_normal(len(t))
    found = fit(
        {"t": t, "y": y, "v": v, "F": force},
        mass=0.0,
        columns={"time": "t", "position": "y", "velocity": "v", "force": "F"},
    )
    best = getattr(found, "best", found)
    there = {"stiffness", "gravity_sin"} & set(best.body)
    assert len(there) == 1
    (name,) = there
    assert name == "gravity_sin"  # which predicts: it is bounded on a longer way
    assert best.body[name].identifiable is told
    assert any("alike" in note for note in best.notes) is not told
    if told:
        assert best.body[name].low <= 3 <= best.body[name].high


def test_a_weight_in_place_of_a_spring_is_settled_once(monkeypatch):
    """It had been settled again for the verdict."""
    t = np.arange(0, 12, 4e-3)
    y, v = 1.5 * np.sin(t), 1.5 * np.cos(t)
    force = 8 * np.tanh(v / 0.01) + 2 * v + 30 * y + 0.1 * np.random.default_rng(2).standard_normal(len(t))
    log = read_log({"t": t, "y": y, "F": force}, columns={"time": "t", "position": "y", "force": "F"})
    rows, settled = rows_of(log), []
    at = settle(rows, "coulomb_viscous", Setting({}, body=("offset", "stiffness")))
    monkeypatch.setattr(alike, "settle", lambda *given: settled.append(settle(*given)) or settled[-1])
    kept, instead = alike.bounded(at, ("offset",))
    fit = alike.told_apart(finished(rows, kept, profiles=False), kept, ("offset",), instead)
    assert kept is at
    assert [each.setting.body for each in settled] == [("offset", "gravity_sin")]
    assert fit.body["stiffness"].identifiable
