"""What is told beside the numbers: clocks that drift, another unit, the files."""

from scipy.interpolate import CubicSpline

from stribeck.identify.actuator import fit_machine
from tests.identify.actuator.recorded import body, logs, record

F_C, MASS = "contacts.guide.law.parameters.F_c", "bodies.a.mass"
WANTED = {F_C: {"low": 0.1, "high": 10.0}, MASS: {"low": 0.2, "high": 5.0}}


def drifting(table):
    """The encoder's clock gains 1 % on that of the drive."""
    return {**table, "y": CubicSpline(table["t"], table["y"])(0.99 * table["t"])}


def test_a_clock_that_drifts_is_told_and_can_be_sought(tmp_path):
    record(tmp_path / "run.csv", body(amplitude=5.0), change=drifting)
    told = fit_machine(body(), logs(tmp_path, ["run.csv"], WANTED), starts=1, baselines=False)
    assert any("a.y" in note and "clock" in note for note in told.notes), told.notes
    clock = {"outputs.a.y.clock": {"low": -0.03, "high": 0.03}}
    found = fit_machine(body(), logs(tmp_path, ["run.csv"], WANTED | clock), starts=1, baselines=False)
    p = found.parameters["outputs.a.y.clock"]
    assert p.low < 0.01 < p.high
    assert found.parameters[MASS].low < 1.0 < found.parameters[MASS].high
