"""Recordings that begin in motion: the speed there is found with everything else."""

import numpy as np
import pytest

from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from tests.identify.actuator.recorded import NOISE, body
from tests.reference.apart import solve

F_C, MASS = "contacts.guide.law.parameters.F_c", "bodies.a.mass"
SOUGHT = (Sought(F_C, 0.1, 10.0), Sought(MASS, 0.2, 5.0))


@pytest.fixture(scope="module")
def motion():
    """Columns of a body that is pushed to and fro, and the push."""
    data = body(amplitude=5.0, t_end=1.6)
    solution = solve(data, rtol=1e-9)
    return {"y": solution["a.y"], "v": solution["a.v"], "u": np.array(data["loads"]["push"]["signal"]["value"])}


def recording(motion, rows, column="y", noise=NOISE, **more):
    t = 0.01 * np.arange(len(motion["u"][rows]))
    x = motion[column][rows] - (motion["y"][rows][0] if column == "y" else 0.0)
    x = x + noise * np.random.default_rng(0).standard_normal(len(t))
    drive = {"loads.push.signal": Channel("u", t, motion["u"][rows])}
    return Recording("run.csv", t, {f"a.{column}": Channel(column, t, x)}, drive, **more)


@pytest.mark.share(2)
@pytest.mark.parametrize(("first", "column"), [(52, "y"), (37, "v")])
def test_the_speed_at_the_start_is_found(motion, first, column):
    """From row 52 on it moves back and stops within twelve samples: that was taken as rest."""
    rows = slice(first, first + 101)
    assert abs(motion["v"][first]) > 0.05
    noise = NOISE if column == "y" else 1e-3
    fitted = fit_machine(
        body(mass=1.2, F_c=0.8, F_s=1.3),
        Logs((recording(motion, rows, column, noise),), SOUGHT),
        starts=2,
        baselines=False,
    )
    for name in (F_C, MASS):
        p = fitted.estimates[name]
        assert p.state == "identified", fitted.notes
        assert p.low < 1.0 < p.high
    label = "log.0.initial.a.v"  # its bristles, of which nobody knows, begin unstretched
    deviation = 0.05 * abs(motion["v"][first])
    assert fitted.nuisance[label] == pytest.approx(motion["v"][first], abs=deviation)


def test_what_is_held_out_begins_in_motion_too(motion):
    whole = recording(motion, slice(0, 101))
    later = recording(motion, slice(52, 153), hold_out=True)
    fitted = fit_machine(body(F_s=1.3), Logs((whole, later), SOUGHT), starts=1, baselines=False)
    assert fitted.error(held_out=True) < 0.01
