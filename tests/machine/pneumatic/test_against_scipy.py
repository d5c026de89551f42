"""Servos against references of others and against equations written anew, within 1e-5 of each column's peak."""

import numpy as np
import pytest

from stribeck import Scenario, simulate
from tests.machine.pneumatic import independent
from tests.machine.pneumatic.servos import COLUMNS, last, solved
from tests.shared import SHARED

FILES = sorted((SHARED / "reference").glob("pneumatic_servo__*.csv"))


def smooth(name, k_v=1e6):
    return {"name": name, "k_v": k_v}


def agree(solution, expected, rows, tolerance=1e-5):
    for name in COLUMNS:
        peak = np.max(np.abs(expected[name]))
        assert np.max(np.abs(solution[name][rows] - expected[name])) <= tolerance * peak, name


@pytest.mark.skipif(not FILES, reason="needs shared/reference, which is not part of the project")
@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_references(file):
    _, law, observer, k_v = file.stem.split("__")
    data = Scenario.load(SHARED / "scenarios" / "pneumatic_servo.toml").data
    plant = {"name": law} if law == "lugre" else smooth(law)
    data["law"] = {**plant, "parameters": data["law"]["parameters"]}
    data["drive"]["observer"] = smooth(observer.removeprefix("observer_"), float(k_v))
    solution = simulate(Scenario(data))
    expected = np.genfromtxt(file, delimiter=",", names=True)
    assert ["t", *(column.name for column in solution.columns)] == list(expected.dtype.names)
    agree(solution, expected, np.rint(expected["t"] / data["output"]["step"]).astype(int))


VARIANTS = {
    "other gains": ("lugre_sobczyk", "lugre_sobczyk", {"K_D": 90.0, "K_p": 40.0, "lam": 12.0, "K": 4e-5, "rho": 1e-9}),
    "arctan": ("lugre_arctan", "lugre_majorant", {}),
    "majorant": ("lugre_majorant", "lugre_arctan", {}),
}


@pytest.mark.share(3)
@pytest.mark.parametrize("name", VARIANTS)
def test_variants_on_a_sine(name):
    law, observer, gains = VARIANTS[name]
    changes = {f"drive__{'lambda' if n == 'lam' else n}": x for n, x in gains.items()}
    path = {"kind": "sine", "offset": 0.4, "amplitude": 0.1, "frequency": 0.5}
    solution = solved(
        smooth(law), smooth(observer, 1e5), drive__signal=path, plant__initial__y=0.405, solve__t_end=2.0,
        output__step=0.005, **changes,
    )  # fmt: skip
    expected = independent.solve(
        law, observer, independent.sine(0.4, 0.1, 0.5), 2.0, gains, observer_k_v=1e5, start=(0.405, 0.0, 4e5, 4e5)
    )
    agree(solution, expected, np.arange(401))


@pytest.mark.thorough
def test_a_move_from_point_to_point():
    signal = {"kind": "point_to_point", "t": [0.5, 1.5], "value": [0.5, 0.6]}
    solution = solved(
        smooth("lugre_sobczyk"), smooth("lugre_majorant"), drive__signal=signal, plant__initial__y=0.501,
        solve__t_end=2.0, output__step=0.005,
    )  # fmt: skip
    path = independent.move(0.5, 0.6, 0.5, 1.0)
    expected = independent.solve("lugre_sobczyk", "lugre_majorant", path, 2.0, start=(0.501, 0.0, 4e5, 4e5))
    agree(solution, expected, np.arange(401))


def test_a_sampled_controller_with_noise_counts_and_delay():
    """The loop from instant to instant, written anew: reading, filter, controller, observer, and when the valve acts."""
    period, step = 4e-3, 2e-3
    solution = solved(
        smooth("lugre_sobczyk"), smooth("lugre_majorant"), solve__t_end=0.4, output__step=step, drive__sample_time=period,
        drive__delay=1.5e-3, drive__noise=1e-5, drive__quantization=5e-6, drive__bandwidth=150.0, drive__seed=7,
    )  # fmt: skip
    path = independent.sine(0.5, 0.2, 0.2)
    law = ("lugre_sobczyk", "lugre_majorant")
    expected = independent.sampled(*law, path, 0.4, period, 1.5e-3, 1e-5, 5e-6, 150.0, 7)
    for name, x in expected.items():
        assert np.max(np.abs(solution[name][::2] - x)) <= 1e-6 * np.max(np.abs(x)), name
    assert set(np.diff(solution["u"]).nonzero()[0] % 2) == {0}  # it acts between two instants, and holds between


# plant, observer, k_v of the observer: the largest error and whether V rises (theory.md, section 5)
TABLE = [
    ("lugre_sobczyk", "lugre_sobczyk", 1e6, 7e-11, False), ("lugre", "lugre_sobczyk", 1e6, 3.5e-7, False),
    ("lugre", "lugre_arctan", 1e6, 3.0e-7, False), ("lugre", "lugre_majorant", 1e6, 7e-11, False),
    ("lugre", "lugre_sobczyk", 1e4, 3.5e-5, True), ("lugre", "lugre_majorant", 1e4, 5.7e-8, False),
    ("lugre", None, 0.0, 4.1e-2, True),
]  # fmt: skip


@pytest.mark.share(3)
@pytest.mark.parametrize(("law", "observer", "k_v", "error", "rises"), TABLE)
def test_the_table_of_the_theory(law, observer, k_v, error, rises):
    plant = {"name": law} if law == "lugre" else smooth(law)
    solution = solved(plant, smooth(observer, k_v) if observer else {"name": "none"})
    result = last(solution)
    assert result <= error if error < 1e-9 else result == pytest.approx(error, rel=0.02)
    assert bool(np.any(np.diff(solution["V"]) > 1e-9 * solution["V"][0])) == rises
