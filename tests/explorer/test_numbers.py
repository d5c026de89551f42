"""How far a number's slider goes."""

import pytest

from stribeck import Scenario
from stribeck.constants import Constant
from stribeck.explorer.measured import _narrower
from stribeck.explorer.numbers import beside_law, number_of
from stribeck.explorer.page import _tables
from tests.scenario.valid_scenarios import VALID


@pytest.mark.parametrize(
    ("value", "bounds", "size", "ends"),
    [
        (3.0, {"above": 0}, 9.0, (0.3, 30.0, True)),
        (3.0, {}, 9.0, (0.3, 30.0, True)),
        (-3.0, {}, 9.0, (-6.0, 6.0, False)),
        (0.0, {"at_least": 0}, 9.0, (0.0, 9.0, False)),
        (0.0, {}, 9.0, (-9.0, 9.0, False)),
        (0.0, {}, 0.0, (-1.0, 1.0, False)),
    ],
)
def test_a_slider_goes_as_far_as_its_number_is_large(value, bounds, size, ends):
    built = number_of("law", "F_c", value, Constant("N", "a force", **bounds), size, "law.F_c", reach=10.0)
    assert (built.low, built.high, built.log) == pytest.approx(ends)
    assert (built.path, built.value, built.unit) == ("law.F_c", value, "N")
    for share in (1.0, 0.25):
        narrow = _narrower(built, share * 10.0)
        wanted = (
            (value / (10 * share), value * 10 * share) if built.log else (value + share * (x - value) for x in ends[:2])
        )
        assert (narrow.low, narrow.high) == pytest.approx(tuple(wanted))


@pytest.mark.parametrize(("count", "short"), [(12, True), (13, False)])
def test_a_long_signal_is_a_curve_without_sliders_beside_the_file_s_tables(count, short):
    signal = {"kind": "points", "t": [float(i) for i in range(count)], "value": [0.1 * i for i in range(count)]}
    scenario = Scenario(VALID["force_points"]).with_changes({"drive.signal": signal})
    assert ("value" in _tables(scenario)["drive"]["signal"]) is short
    assert any(".value" in number.path for number in beside_law(scenario)) is short
