"""Signals from recorded files: what is refused, and how it is read."""

from __future__ import annotations

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet

from stribeck import InputError, Scenario
from stribeck.recorded import opened_with
from tests.scenario.valid_scenarios import VALID, edited, toml

DATA = VALID["velocity_file"]


def load(folder, text, name="record.csv", **signal):
    """The scenario driven by a file with this text; its columns are t and v unless said."""
    if text is not None:
        (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    keys = {"kind": "file", "path": name, "time": "t", "value": "v", **signal}
    path = folder / "scenario.toml"
    path.write_text(toml(edited(DATA, "drive.signal", value=keys)))
    return Scenario.load(path)


@pytest.mark.parametrize(
    ("text", "key", "said"),
    [
        (None, "path", "cannot be read"),
        ("", "path", "is empty"),
        (b"t,v\n0,\xff\xfe\n", "path", "cannot be read"),
        ("time,v\n0,1\n", "time", "no such column (it has time, v)"),
        ("t,speed\n0,1\n", "value", "no such column (it has t, speed)"),
        ("t,v\n", "path", "has a head but no rows"),
        ("t,v\n0,a\n1,2\n", "value", "holds text: 'a', not numbers"),
        ("t,v\n0,true\n1,false\n", "value", "not numbers"),
        ("t,v\n0,1\n1,\n", "value", "has 1 empty or nan cells"),
        ("t,v\n,1\n,2\n", "time", ""),
        ("t,v\n0,nan\n1,2\n", "value", "has 1 empty or nan cells"),
        ("t,v\n0,1\ninf,2\n", "path", "inf: must be a finite number"),
        ("t,v\n0,1\n2,2\n1,3\n", "path", "1.0: times must not decrease (the one before is 2.0)"),
        ("t,v\n2024-01-01,1\n2024-01-02,2\n", "time", "not numbers"),
        ("t,v\n0,1\n1,2,3\n", "time", "no such column"),
        ("t,v,v\n0,1,2\n", "value", "more than once"),
    ],
    ids=range(16),
)
def test_bad_files(text, key, said, tmp_path):
    with pytest.raises(InputError) as error:
        load(tmp_path, text)
    line = error.value.problems[0]
    assert line.startswith(f"drive.signal.{key}: ")
    assert said in line
    assert all(each.isprintable() and len(each) <= 300 for each in error.value.problems)


@pytest.mark.parametrize("name", ["missing.parquet", "missing.csv", ".", "a\0b.csv", "record\n.csv"])
def test_files_that_are_not_there(name, tmp_path):
    with pytest.raises(InputError, match=r"^drive.signal.path: .*cannot be read") as error:
        load(tmp_path, None, name)
    assert len(error.value.problems) == 1
    assert error.value.problems[0].isprintable()


def test_a_file_that_is_not_parquet(tmp_path):
    with pytest.raises(InputError, match=r"^drive.signal.path: .*record.parquet'?: cannot be read"):
        load(tmp_path, "t,v\n0,1\n", "record.parquet")


def test_both_columns_are_reported(tmp_path):
    with pytest.raises(InputError) as error:
        load(tmp_path, "time,velo\n0,1\n", time="tim", value="veloc")
    assert [line.split(": ")[0] for line in error.value.problems] == ["drive.signal.time", "drive.signal.value"]
    assert "(did you mean 'time'?)" in error.value.problems[0]
    assert "(did you mean 'velo'?)" in error.value.problems[1]


def test_csv_and_parquet_give_the_same_signal(tmp_path):
    t, v = np.array([0.0, 0.1, 0.1, 1 / 3]), np.array([1e-300, -0.1, 2 / 3, 7.0])
    parquet.write_table(pyarrow.table({"t": t, "v": v}), tmp_path / "record.parquet")
    text = "t,v\n" + "".join(f"{a!r},{b!r}\n" for a, b in zip(t.tolist(), v.tolist(), strict=True))
    from_csv = load(tmp_path, text).signal
    from_parquet = load(tmp_path, None, "record.parquet").signal
    times = np.linspace(-1, 1, 1001)
    assert np.array_equal(from_csv.at(times), from_parquet.at(times))
    assert from_csv.at(0.1) == 2 / 3  # continuous from the right


def test_whole_numbers_and_other_widths_are_read(tmp_path):
    table = pyarrow.table({"t": np.arange(3), "v": np.array([1, 2, 3], np.float32)})
    parquet.write_table(table, tmp_path / "record.pq")
    signal = load(tmp_path, None, "record.pq").signal
    assert signal.at([0, 0.5, 2]).tolist() == [1.0, 1.5, 3.0]


def test_the_path_is_relative_to_the_scenario(tmp_path, monkeypatch):
    (tmp_path / "inner").mkdir()
    monkeypatch.chdir(tmp_path)
    load(tmp_path / "inner", "t,v\n0,1\n1,2\n")
    (tmp_path / "record.csv").write_text("t,v\n0,5\n")
    assert Scenario.load("inner/scenario.toml").signal.at(1.0) == 2.0


def test_a_german_spreadsheet_in_other_units_is_read_as_fit_reads_it(tmp_path):
    found = load(tmp_path, "t;Weg\n0;1\n250;1,25\n500;-2\n", value="Weg", unit="mm", time_unit="ms", scale=-2.0)
    assert found.signal.t.tolist() == [0.0, 0.25, 0.5]
    np.testing.assert_allclose(found.signal.value, [-2e-3, -2.5e-3, 4e-3], rtol=1e-15)


def test_the_units_that_a_file_states_are_used(tmp_path):
    text = "t;Weg\n[ms];mm\n0;1\n250;1,25\n"
    found = load(tmp_path, text, value="Weg")
    assert found.signal.t.tolist() == [0.0, 0.25]
    np.testing.assert_allclose(found.signal.value, [1e-3, 1.25e-3], rtol=1e-15)
    np.testing.assert_allclose(load(tmp_path, text, value="Weg", unit="um").signal.value, [1e-6, 1.25e-6], rtol=1e-15)
    assert load(tmp_path, text, value="Weg", time_unit="s").signal.t.tolist() == [0.0, 250.0]


def test_tabs_and_numpy_archives_are_read(tmp_path):
    assert load(tmp_path, "t\tv\n0\t1\n1\t2\n", "record.tsv").signal.at(0.5) == 1.5
    np.savez(tmp_path / "record.npz", t=[0.0, 1.0], v=[3.0, 5.0])
    assert load(tmp_path, None, "record.npz").signal.at(0.5) == 4.0


@pytest.mark.parametrize(("key", "unit"), [("unit", "mmm"), ("time_unit", "sec")])
def test_an_unknown_unit_is_refused(key, unit, tmp_path):
    with pytest.raises(InputError, match=rf"^drive.signal.{key}: '{unit}': no such unit"):
        load(tmp_path, "t,v\n0,1\n", **{key: unit})


def test_csv_is_read_the_same_without_pyarrow(tmp_path, monkeypatch):
    text = "t;v\n0;0,1\n1;1e-3\n2;\n"
    (tmp_path / "log.csv").write_text(text)
    wanted = {"time": "t", "value": "v"}
    with_arrow = opened_with(tmp_path / "log.csv", wanted).columns(wanted)
    monkeypatch.setattr("stribeck.recorded.find_spec", lambda name: None)
    without = opened_with(tmp_path / "log.csv", wanted).columns(wanted)
    for name in ("time", "value"):
        np.testing.assert_array_equal(with_arrow[name], without[name])
    (tmp_path / "bad.csv").write_text("t,v\n0,1\n1,abc\n")
    with pytest.raises(InputError, match=r"^value: column 'v' holds text: 'abc', not numbers"):
        opened_with(tmp_path / "bad.csv", wanted).columns(wanted)
