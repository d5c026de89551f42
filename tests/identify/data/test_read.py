"""Files, units and damaged data: what is read, what is said, what is refused."""

import math
import subprocess
import sys
from contextlib import nullcontext
from hashlib import sha256
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from scipy import signal

from stribeck import InputError
from stribeck.identify.api import fit
from stribeck.identify.data.clocks import released
from stribeck.identify.data.filters import decimate, low_pass
from stribeck.identify.data.prepare import Preparation, _samples, load_log, prepare
from stribeck.identify.data.quality import clean, unwrapped
from stribeck.identify.data.read import ColumnNames, read

T = np.arange(400) * 1e-3
X, F = np.sin(8 * T), np.cos(8 * T) + 3
NAMES = {"time": "t", "position": "x", "force": "i"}


def _csv(path, rows, head="t,x,i"):
    path.write_text(head + "\n" + "\n".join(rows) + "\n")
    return path


def _rows(t=T, x=X, f=F):
    return [f"{a!r},{b!r},{c!r}" for a, b, c in zip(t.tolist(), x.tolist(), f.tolist(), strict=True)]


@pytest.mark.parametrize(
    "name", ["empty.csv", "zero.csv", "junk.mat", "junk.parquet", "junk.npz", "none.csv", "log.xls"]
)
def test_files_that_are_none_are_refused(name, tmp_path):
    if name != "none.csv":
        (tmp_path / name).write_bytes({"e": b"", "z": b"t,x\n1,\0\n"}.get(name[0], b"no such thing" * 50))
    message = {"e": ".*: is empty", "z": ".*: is not text"}.get(name[0], "")
    with pytest.raises(InputError, match=f"^data: {message}"):
        read(tmp_path / name, ColumnNames(NAMES))


@pytest.mark.parametrize(("named", "more"), [("load", ["position", "velocity"]), ("velocity", []), ("position", [])])
def test_required_columns_that_are_not_named_are_those_called_so(named, more):
    table = dict.fromkeys(("time", "position", "velocity", "force", "pressure", "a"), T)
    assert set(read(table, ColumnNames({named: "a"}))) == {"time", "force", named, *more}


def _noisy(rng, n=3000):
    t = np.arange(n) * 1e-3
    return {"time": t, "position": np.sin(6 * t), "force": rng.standard_normal(n)}


def test_damage_is_found_said_and_cut_away():
    c = _noisy(np.random.default_rng(0))
    c["force"][100:103] = np.nan
    c["time"][500:] += 0.2
    c["time"][900] = c["time"][899]
    c["force"][1500:1700] = c["force"][1500]
    c["force"] = np.clip(c["force"], -3.0, 1e9)
    c["force"][2000:2020] = -3.0
    result = clean(c, "log")
    reported = "\n".join(result.notes)
    for words in (
        "3 cells are empty",
        "repeat the time",
        "gaps in time",
        "stuck at one value",
        "clipped at its smallest",
    ):
        assert words in reported
    assert sum(r.stop - r.start for r in result.runs) == 3000 - 3 - 1 - 200 - 20
    kept = np.concatenate([result.columns["force"][r] for r in result.runs])
    assert np.max(np.diff(np.flatnonzero(np.append(True, np.diff(kept) != 0)))) < 5


def test_uneven_samples_are_put_on_an_even_grid(tmp_path):
    rng = np.random.default_rng(1)
    t = T + 3e-4 * rng.random(len(T))
    log = load_log([_csv(tmp_path / "log.csv", _rows(t, np.sin(8 * t), F))], ColumnNames(NAMES), Preparation(cutoff=0))
    assert "not evenly spaced" in " ".join(log.quality)
    np.testing.assert_allclose(np.diff(log.time), log.step, rtol=1e-9)
    np.testing.assert_allclose(log.position, np.sin(8 * log.time), atol=1e-4)


def test_the_cutoff_lies_between_the_motion_and_its_noise():
    rng = np.random.default_rng(2)
    t = np.arange(20000) * 1e-3
    parts = [
        clean(
            {"time": t, "position": np.sin(2 * np.pi * 3 * t) + 1e-4 * rng.standard_normal(len(t)), "force": t}, "log"
        )
    ]
    log = prepare(parts, Preparation())
    assert 3 < log.bandwidth < 100
    assert "order 4, zero phase" in log.quality[0]


def test_the_filters_in_pieces_are_the_filters():
    rng = np.random.default_rng(3)
    x = np.cumsum(rng.standard_normal(2_100_000))
    b, a = signal.butter(4, 0.2)
    np.testing.assert_allclose(low_pass(x, 100.0, 1e-3), signal.filtfilt(b, a, x, padlen=12), rtol=0, atol=1e-6)
    np.testing.assert_array_equal(low_pass(x[:99], 100.0, 1e-3), signal.filtfilt(b, a, x[:99], padlen=12))
    c = signal.cheby1(8, 0.05, 0.08)
    np.testing.assert_allclose(decimate(x[:5000], 10), signal.filtfilt(*c, x[:5000], padlen=24)[1::10], rtol=1e-12)


def _record(path, step, rate_changes=False, hold=1):
    t = np.arange(0, 8, step)
    if rate_changes:
        t = np.concatenate([t[t < 4], np.arange(4, 8, 20 * step)])
    x = 0.1 * np.sin(2 * np.pi * 0.5 * t)
    v = 0.1 * np.pi * np.cos(2 * np.pi * 0.5 * t)
    f = 2 * -0.1 * np.pi**2 * np.sin(2 * np.pi * 0.5 * t) + 5 * np.sign(v) + 3 * v
    f += 0.01 * np.random.default_rng(0).standard_normal(len(t))
    x = x[np.arange(len(t)) // hold * hold]
    return _csv(path, _rows(t, x, f))


def test_files_of_unlike_sampling_are_one_log(tmp_path):
    files = [_record(tmp_path / f"{k}.csv", step) for k, step in enumerate((1e-3, 2e-3, 5e-3))]
    log = load_log(files, ColumnNames(NAMES), Preparation())
    assert log.step == pytest.approx(2e-3, rel=1e-6)
    assert any("sampled at different steps (0.001, 0.002, 0.005 s)" in note for note in log.quality)
    assert log.files == ("0.csv", "1.csv", "2.csv")
    for rows in log.runs():
        assert log.time[rows][-1] > 7
        v = 0.1 * np.pi * np.cos(np.pi * log.time[rows])
        np.testing.assert_allclose(log.velocity[rows][100:-100], v[100:-100], atol=3e-3)


@pytest.mark.parametrize("steps", [(1e-3, 2e-3), (1e-3, 1.25e-3, 2e-3), (2e-3, 2.5e-3)])
def test_the_noise_of_files_of_unlike_sampling_is_that_of_their_own_clocks(tmp_path, steps):
    """What resampling took away at the highest frequencies was taken for the noise floor, and the cut-off of a motion at
    0.5 Hz was 267 Hz: the acceleration was noise, and a fit's force was missed by seven times as much."""
    draw = np.random.default_rng(5)
    files = []
    for k, step in enumerate(steps):
        t = np.arange(0, 6, step)
        x = 0.1 * np.sin(np.pi * t) + 1e-6 * draw.standard_normal(len(t))
        files.append(_csv(tmp_path / f"{k}.csv", _rows(t, x, 5 * np.sign(np.cos(np.pi * t)))))
    log = load_log(files, ColumnNames(NAMES), Preparation())
    assert log.step in [pytest.approx(step, rel=1e-6) for step in steps]  # no step that no file has
    assert log.bandwidth < 40
    for rows in log.runs():
        wrong = log.acceleration[rows] + 0.1 * np.pi**2 * np.sin(np.pi * log.time[rows])
        assert np.std(wrong[200:-200]) < 0.05


def test_the_noise_is_that_of_files_of_the_log_s_own_step():
    def part(step):
        columns = {"time": T, "position": X + step}
        return SimpleNamespace(step=step, runs=[slice(0, 50), slice(50, 90)], columns=columns, even=True)

    own, other = part(1e-3), part(2e-3)
    result = _samples([own, other], "position", 1e-3)
    assert [x.tolist() for x in result] == [own.columns["position"][run].tolist() for run in own.runs]


def test_two_clocks_in_a_file_are_noticed(tmp_path):
    log = load_log([_record(tmp_path / "rate.csv", 1e-3, rate_changes=True)], ColumnNames(NAMES), Preparation())
    assert any("rows were left out, in pieces shorter" in note for note in log.quality)
    assert 3.5 < log.time[-1] < 4.5
    held = load_log([_record(tmp_path / "held.csv", 1e-3, hold=10)], ColumnNames(NAMES), Preparation())
    assert any("position has a slower clock, with one sample in 10 rows" in note for note in held.quality)
    v = 0.1 * np.pi * np.cos(np.pi * held.time)
    np.testing.assert_allclose(held.velocity[200:-200], v[200:-200], atol=0.02 * 0.1 * np.pi)


def test_the_hash_is_the_files(tmp_path):
    files = [_record(tmp_path / f"{k}.csv", 1e-3) for k in range(2)]
    log = load_log(files[:1], ColumnNames(NAMES), Preparation())
    assert log.hash == sha256(files[0].read_bytes()).hexdigest()
    both = load_log(files, ColumnNames(NAMES), Preparation())
    assert both.hashes == tuple(sha256(f.read_bytes()).hexdigest() for f in files)


def test_a_spike_at_the_end_of_a_moving_record_is_trimmed(tmp_path):
    t = np.arange(0, 6.3, 1e-3)
    x = 0.1 * np.sin(2 * np.pi * 0.5 * t) + 1e-6 * np.random.default_rng(0).standard_normal(len(t))
    log = load_log([_csv(tmp_path / "log.csv", _rows(t, x, np.cos(np.pi * t)))], ColumnNames(NAMES), Preparation())
    assert np.max(abs(log.acceleration)) < 1.5 * 0.1 * np.pi**2


def test_a_small_motion_is_not_erased_by_the_filter(tmp_path):
    t = np.arange(0, 20, 1e-3)
    x = 3.5e-4 * np.sign(np.sin(2 * np.pi * t)) * abs(np.sin(2 * np.pi * t)) ** 0.2
    x = np.round(x / 2e-5) * 2e-5 + 1e-6 * np.random.default_rng(0).standard_normal(len(t))
    log = load_log([_csv(tmp_path / "log.csv", _rows(t, x, np.cos(t)))], ColumnNames(NAMES), Preparation())
    assert np.ptp(log.position) > 0.9 * np.ptp(x)
    kept = np.searchsorted(t, log.time - 1e-6)
    assert np.std(log.position - x[kept]) < 0.12 * np.std(x)


@pytest.mark.parametrize(("wrong", "factor"), [(False, 1.0), (True, 60 / (2 * np.pi))])
def test_a_tachometer_s_zero_and_a_wrapped_angle_do_not_hide_the_unit(wrong, factor):
    """A zero of 2 m/s on motion in one direction was taken for a wrong unit; rpm beside a wrapped angle, or a zero, passed."""
    v = 1.5 + np.cos(8 * T)
    x = 1.5 * T + np.sin(8 * T) / 8
    for position, velocity in (
        (x, v + 2),
        (np.angle(np.exp(12j * x)) / 12, v),
        (np.sin(8 * T) / 8, np.cos(8 * T) + 0.5),
    ):
        log = {"t": T, "x": position, "v": factor * velocity, "i": F}
        with pytest.raises(InputError, match="times the slope") if wrong else nullcontext():
            load_log([log], ColumnNames({**NAMES, "velocity": "v"}))


@pytest.mark.parametrize(("unit", "turn"), [("rad", 2 * np.pi), ("deg", 360.0), ("rev", 1.0)])
@pytest.mark.parametrize("begin", [0.0, -0.5])
def test_an_angle_that_begins_anew_after_each_turn_goes_on(unit, turn, begin, tmp_path):
    x = 2.5 * turn * np.sin(8 * T)
    wrapped = np.round((x / turn - begin) % 1 + begin, 4) * turn
    names, columns = ColumnNames(NAMES, {"x": unit}), []
    for name, angle in (("whole", x), ("wrapped", wrapped)):
        columns.append(load_log([_csv(tmp_path / f"{name}.csv", _rows(x=angle))], names, Preparation(0.0)))
    whole, again = columns
    turns = (again.position - whole.position) / (2 * np.pi)
    assert abs(turns - turns[0]).max() < 1e-3
    assert abs(turns[0] - round(turns[0])) < 1e-3
    assert any("wraps after each turn" in note for note in again.quality)
    assert not any("wraps" in note for note in whole.quality)


@pytest.mark.parametrize("slip", [3.5, 5.0, -6.0])
def test_a_slip_is_no_turn(slip):
    """Within one turn, and further than half of one from a row to the next: no motion goes on over it."""
    x = np.where(T < 0.2, 0.0, slip) + 0.02 * np.sin(8 * T)
    same, turns = unwrapped(T, x)
    assert (same.tolist(), turns) == (x.tolist(), 0)


def test_jumps_of_whole_turns_alone_are_turns():
    """No other change showed a speed: it was a traceback."""
    same, turns = unwrapped(T, 2 * np.pi * (np.arange(len(T)) % 2))
    assert (np.ptp(same), turns) == (0.0, len(T) - 1)


def test_a_turn_goes_on_over_lost_rows_and_beside_a_slip():
    x = 8 * np.sin(20 * T) + np.where(T < 0.3, 0.0, 4.0)
    x[np.searchsorted(x, np.pi) - 2 :][:5] = np.nan
    whole, turns = unwrapped(T, (x + np.pi) % (2 * np.pi) - np.pi)
    moved = np.diff((whole - x)[np.isfinite(x)])
    slip = np.flatnonzero(abs(np.diff(x[np.isfinite(x)])) > 3)
    assert turns > 2
    assert len(slip) == 1
    assert abs(np.delete(moved, slip)).max() < 1e-9


@pytest.mark.parametrize(("period", "off"), [(4.013e-3, 1e-5), (4.43e-3, 1e-5), (7.99e-3, 2e-4)])
def test_a_clock_that_drifts_against_the_rows_is_found_again(period, off):
    """Its samples are seen late by up to a row: taken at the rows that first show them, 1 % of F_s was lost."""
    time = np.arange(20000) * 1e-3
    true = np.sin(3 * time)
    own = np.arange(0, 20, period)
    columns = {"time": time, "position": np.sin(3 * own)[np.searchsorted(own, time + 1e-12, "right") - 1]}
    notes = []
    columns = released(columns, "log", notes)
    assert f"one sample in {period / 1e-3:.5g} rows" in notes[0]
    inner = slice(100, -100)
    assert np.max(abs(columns["position"] - true)[inner]) < 9 / 8 * period**2 + off


def test_a_force_that_a_drifting_clock_holds_is_taken_at_its_own_samples():
    """Lines between them crossed the jump where the motion turns round: F_c came out 1 to 8 % too small, sigma_2 too large."""
    rng, rows = np.random.default_rng(50), 1e-3 * np.arange(8000)
    mass, F_c, sigma_2 = 2.0, 6.0, 5.0
    waves = [(0.41, 0.3), (0.87, 1.1), (1.33, 4.0)]
    at = lambda t, k: sum(0.05 * (2 * np.pi * f) ** k * np.sin(2 * np.pi * f * t + p + k * np.pi / 2) for f, p in waves)  # noqa: E731
    own = 0.0042 + 10.37e-3 * np.arange(-1, 775)
    force = mass * at(own, 2) + F_c * np.sign(at(own, 1)) + sigma_2 * at(own, 1) + 0.02 * rng.standard_normal(len(own))
    data = {
        "t": rows, "x": at(rows, 0) + 1e-6 * rng.standard_normal(len(rows)),
        "i": force[np.searchsorted(own, rows, "right") - 1],
    }  # fmt: skip
    fitted = fit(data, "coulomb_viscous", columns=NAMES)
    for name, truth in {"F_c": F_c, "sigma_2": sigma_2, "mass": mass}.items():
        reported = (fitted.estimates | fitted.body)[name]
        assert reported.low < truth < reported.high, (name, reported)
        assert reported.high - reported.low < 0.02 * truth, (name, reported)


def test_single_forces_beyond_all_others_are_put_right_and_told():
    """One row of 1e6 N turned a fit into a refusal: "force acts against the motion"."""
    draw = np.random.default_rng(2)
    force, hit = F + 0.1 * np.std(F) * draw.standard_normal(len(T)), np.array([120, 200, 311])
    force[hit] += (1e6, -1e6, 50 * np.std(F))
    log = load_log([{"t": T, "x": X, "i": force}], ColumnNames(NAMES))
    assert abs(log.force).max() < 2 * abs(F).max()
    assert any("force: isolated outliers: 3" in note for note in log.quality)


def _glitchy():
    t = np.arange(2000) * 2e-3
    draw = np.random.default_rng(0)
    x = 0.1 * np.sin(2 * np.pi * 0.7 * t) + 1e-6 * draw.standard_normal(len(t))
    return t, x


def test_single_positions_that_no_body_takes_are_replaced():
    """Twenty of ten thousand positions off by 1 mm: a fit of the motion missed 35 times its noise, and knew nothing."""
    t, x = _glitchy()
    rows = np.array([100, 333, 334, 700, 1500])
    wild = x.copy()
    wild[rows] += [1e-3, 2e-4, -5e-4, 6e-5, -1e-2]
    result = clean({"time": t, "position": wild, "force": np.sin(t)}, "log.csv")
    assert np.max(abs(result.columns["position"] - x)) < 6e-6
    assert any("isolated outliers: 5, up to 0.01" in note for note in result.notes)
    assert np.array_equal(np.delete(result.columns["position"], rows), np.delete(x, rows))


@pytest.mark.parametrize(
    "event",
    [
        lambda t: np.where(t > 2, 1e-3, 0.0),  # a jump
        lambda t: 0.05 * np.maximum(t - 2, 0.0),  # a kink: a stop that is hit
        lambda t: 50 * np.maximum(t - 2, 0.0) ** 2,  # a blow that goes on
        lambda t: np.where((t > 2) & (t < 2.008), 1e-3, 0.0),  # there and back in four rows
    ],
)
def test_what_a_body_does_is_left_as_it_is(event):
    t, x = _glitchy()
    x = x + event(t)
    result = clean({"time": t, "position": x.copy(), "force": np.sin(t)}, "log.csv")
    assert np.array_equal(result.columns["position"], x)
    assert not any("single rows" in note for note in result.notes)


@pytest.mark.parametrize(
    ("damage", "text"),
    [("twice", "has this column more than once"), ("no rows", "has a head but no rows"), ("flipped", "cannot be read")],
)
def test_parquet_files_that_are_wrong_behind_their_head(tmp_path, damage, text):
    """Two were tracebacks, one came too late as exit status 1."""
    path = tmp_path / "log.parquet"
    x = np.linspace(0, 1, 0 if damage == "no rows" else 4000)
    names = ["t", "y", "F", "F"] if damage == "twice" else ["t", "y", "F", "G"]
    parquet.write_table(
        pa.Table.from_arrays([pa.array(np.sin(k * x)) for k in range(1, 5)], names=names), path, compression="gzip"
    )
    if damage == "flipped":
        content = path.read_bytes()
        path.write_bytes(content[:1000] + bytes(500) + content[1500:])
    with pytest.raises(InputError, match=text):
        read(path, ColumnNames({"time": "t", "position": "y", "force": "F"}))


def test_pandas_is_not_read_for_a_file(tmp_path):
    """Arrow reads it before it gives a column away: a quarter of a second, in which a Ctrl-C was lost."""
    table = pa.table({"t": pa.array([1, None, 3], pa.int32()), "x": pa.array([0.5, 0.5, None]).dictionary_encode()})
    parquet.write_table(table, tmp_path / "a.parquet")
    (tmp_path / "a.csv").write_text("t,x\n1,0.5\n,0.5\n3,\n")
    code = "import sys; from stribeck.recorded import opened_with as r; w = {'t': 't', 'x': 'x'}\n"
    code += "print([v.tolist() for p in sys.argv[1:] for v in r(p, w).columns(w).values()], 'pandas' in sys.modules)"
    files = [str(tmp_path / name) for name in ("a.csv", "a.parquet")]
    done = subprocess.run([sys.executable, "-c", code, *files], capture_output=True, text=True, check=True)
    assert done.stdout == f"{[[1.0, math.nan, 3.0], [0.5, 0.5, math.nan]] * 2} False\n"


def test_runs_of_which_nothing_is_left_are_told(tmp_path):
    """Of 21 runs 20 were dropped without a word."""
    t = np.arange(0, 6, 1e-3)
    y = 0.01 * np.sin(2 * np.pi * 0.4 * t) + 1e-7 * np.random.default_rng(1).standard_normal(len(t))
    run = np.where(t < 4, 0.0, 1 + np.floor((t - 4) / 0.1))
    file = tmp_path / "log.csv"
    np.savetxt(file, np.c_[t, y, np.sign(np.cos(2.5 * t)), run], delimiter=",", header="t,y,F,run", comments="")
    columns = ColumnNames({"time": "t", "position": "y", "force": "F", "run": "run"})
    result = load_log([file], columns, Preparation(cutoff=15.0))
    assert [line for line in result.quality if line.startswith("20 of 21 runs (2000 rows) were left out")]
    assert len(set(result.run.tolist())) == 1


def test_the_error_of_a_prediction_is_not_that_of_the_filter_s_end():
    """1.89 % of the torque was told as missed where the rows before the last tenth of a second miss 1.61 %."""
    t = np.arange(0, 12, 1e-3)
    y = 0.9 * np.sin(1.3 * t) + 0.25 * np.sin(3.8 * t + 1)
    v = np.gradient(y, 1e-3)
    noise = np.random.default_rng(1).standard_normal((2, len(t)))
    force = 1.5 * np.tanh(v / 0.02) + 0.1 * np.gradient(v, 1e-3) + 2.5 * np.sin(y) + 0.03 * noise[0]
    data = {"t": t, "x": y + 2e-5 * noise[1], "i": force}
    for published, left in ((False, 300), (True, 0)):
        log = load_log([data], ColumnNames(NAMES), Preparation(cutoff=5.0, published=published))
        assert 12000 - 999 - len(log) == left
        assert any("last 300 rows" in line for line in log.quality) == bool(left)
