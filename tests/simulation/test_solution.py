"""What a solution holds: rows, columns, statistics; and what makes a new one cheap."""

import threading
from time import perf_counter

import numpy as np
import pytest

from stribeck import Scenario, simulate
from stribeck.simulation import native
from tests.simulation.rig import rig, solved, spring

PULL = {"kind": "ramp", "rate": 0.3}


def test_rows_do_not_steer_the_steps():
    few, many = solved(rig("lugre", "force", PULL, 6.0, rows=2)), solved(rig("lugre", "force", PULL, 6.0, rows=6000))
    assert few.stats["accepted"] == many.stats["accepted"]
    assert few.final == many.final


def test_data_frame():
    pandas = pytest.importorskip("pandas")
    solution = solved(rig("lugre", "force", PULL, 0.1))
    frame = solution.to_pandas()
    assert list(frame.columns) == ["t", "y", "v", "z", "F", "u"]
    pandas.testing.assert_series_equal(frame["F"], pandas.Series(solution["F"], name="F"))
    assert solution.final == frame.iloc[-1].to_dict()


def test_progress_rises_to_one():
    shares = []
    simulate(Scenario(rig("lugre", "force", PULL, 6.0)), progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_tolerances_are_kept():
    """Tighter tolerances give smaller errors, down to rounding, and loose ones are cheap."""
    data = rig("lugre_majorant", spring("canudas1995"), PULL, 6.0)
    best, errors, steps = solved({**data, "solve": {"t_end": 6.0, "rtol": 1e-13}}), [], []
    for rtol in (1e-3, 1e-5, 1e-7, 1e-9):
        solution = solved({**data, "solve": {"t_end": 6.0, "rtol": rtol}})
        errors.append(np.max(np.abs(solution["y"] - best["y"])) / best.peaks["y"] / rtol)
        steps.append(solution.stats["accepted"])
    assert max(errors) < 1
    assert steps == sorted(steps)
    assert steps[-1] > 5 * steps[0]


def test_the_lock_of_python_is_free_while_a_simulation_runs(monkeypatch):
    monkeypatch.setattr(native, "_SLICE", 10**9)  # all in one call of compiled code
    ringing = {"kind": "sine", "amplitude": 0.5, "frequency": 300.0}
    solved(rig("dahl", "force", ringing, 0.1))  # compiled from here on
    scenario = Scenario(rig("dahl", "force", ringing, 1000.0, max_steps=300_000))
    thread = threading.Thread(target=simulate, args=(scenario,))
    begin = last = perf_counter()
    longest = 0.0
    thread.start()
    while thread.is_alive():
        now = perf_counter()
        longest, last = max(longest, now - last), now
    assert longest < 0.5 * (last - begin)


def test_a_result_draws_itself_as_a_figure_of_matplotlib():
    from matplotlib.figure import Figure

    solution = simulate(Scenario(rig("lugre", spring("canudas1995"), {"kind": "ramp", "rate": 0.01}, 1.0)))
    assert isinstance(solution.plot(), Figure)
    axes = Figure().subplots()
    assert solution.plot("v", ax=axes) is axes.figure
    assert axes.get_ylabel().startswith("v")


def test_no_line_joins_rows_that_lie_far_apart():
    """It would be a path in the plane of velocity and force that the motion did not take."""
    data = rig("lugre", spring("canudas1995"), {"kind": "ramp", "rate": 0.1}, 40.0, rows=400)
    figure = simulate(Scenario(data)).plot()
    (axes,) = (x for x in figure.axes if x.get_title("left").startswith("friction against velocity"))
    x, y = (np.asarray(values, float) for values in axes.get_lines()[0].get_data())
    shown = axes.transAxes.inverted().transform(axes.transData.transform(np.column_stack([x, y])))
    steps = np.hypot(*np.diff(shown, axis=0).T)
    assert np.isnan(steps).any()
    assert np.nanmax(steps) < 0.08
