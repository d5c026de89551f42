"""Each drive's force and states against their definitions, by numbers worked out by hand; and energy that it stores."""

from types import SimpleNamespace

import pytest

from stribeck.drives import KINDS

Y, V, INTEGRAL, R = 0.3, -0.2, 0.05, 0.7


@pytest.mark.parametrize(
    ("kind", "constants", "states", "expected"),
    [
        ("force", {}, (), 0.7),
        ("spring", {"stiffness": 5.0}, (), 2.0),  # 5 (0.7 - 0.3)
        ("pid", {"K_p": 3.0, "K_i": 4.0, "K_d": 6.0}, (INTEGRAL,), 1.2 - 0.2 + 1.2),  # 3 0.4 - 4 0.05 + 6 0.2
    ],
)
def test_force(kind, constants, states, expected):
    assert KINDS[kind].force(SimpleNamespace(**constants), R, Y, V, states) == pytest.approx(expected, rel=1e-15)


def test_the_integral_of_a_pid_rises_with_the_position_above_the_setpoint():
    assert KINDS["pid"].rates(SimpleNamespace(K_p=1.0, K_i=1.0, K_d=1.0), R, Y, V, (INTEGRAL,)) == pytest.approx(
        (-0.4,)
    )


def test_only_a_velocity_sets_the_velocity():
    assert [kind for kind, drive in KINDS.items() if drive.sets_velocity] == ["velocity"]


@pytest.mark.parametrize("kind", KINDS)
def test_what_a_drive_declares_is_complete(kind):
    drive = KINDS[kind]
    assert drive.kind == kind
    assert drive.meaning
    assert len({c.name for c in (drive.signal, *drive.states, *drive.columns)}) == 1 + len(drive.states) + len(
        drive.columns
    )
