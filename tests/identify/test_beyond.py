"""Rows that lie beyond what a fit has seen."""

import json

import numpy as np
import pytest

import stribeck
from stribeck.identify.beyond import Beyond, beyond, seen
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.data.reading import read_log
from stribeck.identify.log import INTEGRAL, Log
from stribeck.identify.result import Fit

NAMES = {"time": "t", "position": "y", "velocity": "v", "force": "F"}


def log(position, velocity, source="measured", load=None) -> Log:
    n = len(position)
    return Log(
        np.arange(n) * 1e-2, np.array(position, float), np.array(velocity, float), np.zeros(n), np.full(n, 2.0),
        np.zeros(n, np.int32), None if load is None else np.array(load, float), step=1e-2, sources={"position": source},
    )  # fmt: skip


def test_the_errors_beyond_and_within_are_those_of_their_rows():
    there = log([0.0, 0.5, 1.5, 2.0], [0.1, 0.2, 0.3, 0.9])
    left = np.array([0.2, 0.2, 0.4, 1.0])
    result = beyond({"position": (0, 1), "velocity": (0, 0.5)}, ("stiffness",), there, np.ones(4, bool), left)
    assert (result.rows, result.of) == (2, 4)
    assert result.error == pytest.approx(np.sqrt((0.4**2 + 1) / 8))
    assert result.within == pytest.approx(0.1)
    assert {n: w[0] for n, w in result.what.items()} == {"velocity": 1, "position": 2}
    assert result.text() == (
        "2 rows (50%) lie beyond the fitted range: velocity from 0.1 to 0.9 m/s, fitted from 0 to 0.5; "
        "position from 0 to 2 m, fitted from 0 to 1"
    )


@pytest.mark.parametrize(
    ("terms", "position", "counted"),
    [
        ((), (0, 1), 0),
        (("gravity_sin",), (0, 1), 2),
        (("gravity_sin",), (0, 6.3), 0),
        (("level by position",), (0, 1), 2),
    ],
)
def test_positions_count_where_the_model_hangs_on_what_was_not_seen(terms, position, counted):
    there = log([0.0, 0.5, 9.0, 9.5], [0.1] * 4)
    result = beyond({"position": position, "velocity": (0, 1)}, terms, there, np.ones(4, bool), np.zeros(4))
    assert result.rows == counted


def test_rows_at_rest_and_loads_of_which_no_term_is_do_not_count():
    there = log([0.0] * 3, [0.1, 0.1, 0.9], load=[1.0, 5.0, 1.0])
    ranges = {"velocity": (0, 0.5), "load": (0, 2)}
    moves = np.array([True, True, False])
    assert beyond(ranges, (), there, moves, np.zeros(3)).rows == 0
    result = beyond(ranges, ("F_c_by_load",), there, moves, np.zeros(3))
    assert (result.rows, list(result.what), result.text()[:31]) == (1, ["load"], "1 rows (50%) lie beyond the fit")


def test_a_position_that_nobody_measured_has_no_range():
    assert set(seen(log([0, 1], [0.1, 0.2], INTEGRAL), np.ones(2, bool))) == {"velocity"}


def rig(size: float) -> dict[str, np.ndarray]:
    t = np.arange(0, 6, 5e-3)
    w, draw = 2 * np.pi * 0.5, np.random.default_rng(3)
    y, v = size * np.sin(w * t), size * w * np.cos(w * t)
    force = 0.5 * np.sign(v) + 0.3 * v + 2.0 * y + 0.01 * draw.standard_normal(len(t))
    return {"t": t, "y": y, "v": v, "F": force}


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fit")
    stribeck.fit(rig(0.2), "coulomb_viscous", columns=NAMES, term=["stiffness"], mass=0.0).save(folder)
    return folder


@pytest.mark.thorough
def test_a_fit_keeps_what_it_has_seen_and_tells_it_of_another_record(saved):
    kept = Fit.load(saved)
    assert kept.seen["position"] == pytest.approx((-0.2, 0.2), rel=0.01)
    inside = kept.predict(read_log(rig(0.2), ColumnNames(NAMES)))
    assert inside.beyond.rows == 0
    assert inside.beyond.error is None
    wide = kept.predict(read_log(rig(0.4), ColumnNames(NAMES)))
    # of a sine twice as tall, 2/3 of the time beyond in the position, 2/3 in the speed, and never neither beyond
    assert wide.beyond.rows == pytest.approx(wide.beyond.of, rel=0.02)
    assert json.loads(json.dumps(wide.to_dict()))["beyond"]["what"]["position"]["seen"] == pytest.approx(
        [-0.2, 0.2], rel=0.01
    )


def test_where_nothing_lies_beyond_nothing_is_said():
    assert Beyond(0, 100, None, 0.1, {}).text() == ""
    assert "3 rows (3%) lie beyond" in Beyond(3, 100, 0.2, 0.1, {"velocity": (3, (0.0, 1.0), (0.0, 2.0))}).text()
    assert "(less than 1 %)" in Beyond(3, 1000, 0.2, 0.1, {}).text()
