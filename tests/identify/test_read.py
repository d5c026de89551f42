"""Files, units and damaged data: what is read, what is said, what is refused."""

import h5py
import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from scipy import signal
from scipy.io import savemat

from stribeck import InputError
from stribeck.identify.data.filters import decimate, shifted, zero_phase
from stribeck.identify.data.prepare import Preparation, load
from stribeck.identify.data.quality import clean
from stribeck.identify.data.read import Columns, read

T = np.arange(400) * 1e-3
X, F = np.sin(8 * T), np.cos(8 * T) + 3
NAMES = {"time": "t", "position": "x", "force": "i"}


def _csv(path, rows, head="t,x,i"):
    path.write_text(head + "\n" + "\n".join(rows) + "\n")
    return path


def _rows(t=T, x=X, f=F):
    return [f"{a!r},{b!r},{c!r}" for a, b, c in zip(t.tolist(), x.tolist(), f.tolist(), strict=True)]


def _write(kind, path):
    columns = {"t": T, "x": X, "i": F}
    if kind == "csv":
        _csv(path, _rows())
    elif kind == "parquet":
        parquet.write_table(pa.table(columns), path)
    elif kind == "npz":
        np.savez(path, **columns)
    elif kind == "mat5":
        savemat(path, {name: x[:, None] for name, x in columns.items()} | {"gain": 2.5})
    else:
        with h5py.File(path, "w", userblock_size=512) as file:
            for name, x in columns.items():
                file[name] = x[None, :]
        with path.open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz", "mat5", "mat73"])
def test_every_format_gives_the_same_columns_in_si(kind, tmp_path):
    path = tmp_path / f"log.{kind.rstrip('573')}"
    _write(kind, path)
    found = read(path, Columns(NAMES, {"t": "ms", "x": "mm", "i": "A"}, 2.0))
    np.testing.assert_allclose(found["time"], 1e-3 * T, rtol=1e-15)
    np.testing.assert_allclose(found["position"], 1e-3 * X, rtol=1e-15)
    np.testing.assert_allclose(found["force"], 2 * F, rtol=1e-15)


def test_columns_may_stand_in_a_file_beside_the_data_and_the_gain_in_the_data(tmp_path):
    path = tmp_path / "log.mat"
    _write("mat5", path)
    (tmp_path / "log.toml").write_text(
        'force_gain = "gain"\n[columns]\ntime = "t"\nposition = "i"\nforce = "i"\n[units]\nt = "ms"\n'
    )
    found = read(path, Columns({"position": "x"}))
    np.testing.assert_allclose(found["force"], 2.5 * F, rtol=1e-15)
    np.testing.assert_array_equal(found["position"], X)


def test_a_csv_file_without_a_head_has_numbered_columns(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("\n".join(row.replace(",", "\t") for row in _rows()))
    found = read(path, Columns({"time": "1", "velocity": "2", "force": "3"}))
    np.testing.assert_array_equal(found["velocity"], X)


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        (Columns({"position": "x", "force": "i"}), "^time: must be given"),
        (Columns({**NAMES, "position": "y"}), "^position: 'y': .* has no such column"),
        (Columns(NAMES, {"x": "kg"}), "^units: 'x=kg': no unit of position"),
        (Columns(NAMES, {"q": "mm"}), "^units: 'q': no column of that name is used"),
        (Columns(NAMES, {"i": "A"}), "^force_gain: must be given"),
        (Columns(NAMES, {}, "nothing"), "^force_gain: 'nothing': must be a number"),
        (Columns(NAMES, {}, 0.0), "^force_gain: 0.0: must be a finite number other than 0"),
    ],
)
def test_bad_columns_are_one_clear_line(columns, said, tmp_path):
    with pytest.raises(InputError, match=said) as caught:
        read(_csv(tmp_path / "log.csv", _rows()), columns)
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([], "has a head but no rows"),
        ([*_rows()[:300], "0.3,abc,1", *_rows()[301:]], "column 'x' holds text: 'abc'"),
        (_rows()[:3], "has 3 rows; a fit needs 50"),
        ([*_rows()[:200], *_rows()[100:]], "time goes backwards in row 201"),
        (_rows(f=np.full(400, np.nan)), "400 of 400 cells are empty"),
    ],
)
def test_bad_files_are_one_clear_line(rows, said, tmp_path):
    with pytest.raises(InputError, match=said) as caught:
        load([_csv(tmp_path / "log.csv", rows)], Columns(NAMES))
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize("name", ["empty.csv", "junk.mat", "junk.parquet", "junk.npz", "none.csv", "log.xls"])
def test_files_that_are_none_are_refused(name, tmp_path):
    if name != "none.csv":
        (tmp_path / name).write_bytes(b"" if "empty" in name else b"no such thing" * 50)
    with pytest.raises(InputError, match=r"^data: "):
        read(tmp_path / name, Columns(NAMES))


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
    found = clean(c, "log")
    told = "\n".join(found.notes)
    for words in (
        "3 cells are empty",
        "repeat the time",
        "gaps in time",
        "repeats one value",
        "clipped at its smallest",
    ):
        assert words in told
    assert sum(r.stop - r.start for r in found.runs) == 3000 - 3 - 1 - 200 - 20
    kept = np.concatenate([found.columns["force"][r] for r in found.runs])
    assert np.max(np.diff(np.flatnonzero(np.append(True, np.diff(kept) != 0)))) < 5


def test_uneven_samples_are_put_on_an_even_grid(tmp_path):
    rng = np.random.default_rng(1)
    t = T + 3e-4 * rng.random(len(T))
    log = load([_csv(tmp_path / "log.csv", _rows(t, np.sin(8 * t), F))], Columns(NAMES), Preparation(cutoff=0))
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
    from stribeck.identify.data.prepare import prepare

    log = prepare(parts, Preparation())
    assert 3 < log.bandwidth < 100
    assert "low-pass" in log.quality[0]


def test_the_filters_in_pieces_are_the_filters():
    rng = np.random.default_rng(3)
    x = np.cumsum(rng.standard_normal(2_100_000))
    b, a = signal.butter(4, 0.2)
    np.testing.assert_allclose(zero_phase(b, a, x), signal.filtfilt(b, a, x, padlen=12), rtol=0, atol=1e-6)
    c = signal.cheby1(8, 0.05, 0.08)
    np.testing.assert_allclose(decimate(x[:5000], 10), signal.filtfilt(*c, x[:5000], padlen=24)[1::10], rtol=1e-12)


@pytest.mark.parametrize("shift", [0.0, 0.3, -0.7, 2.0, 3.4, -5.9])
def test_a_shift_moves_samples(shift):
    t = np.arange(300)
    np.testing.assert_allclose(shifted(np.sin(0.1 * t), shift)[10:-10], np.sin(0.1 * (t + shift))[10:-10], atol=1e-5)


def test_decimal_commas_go_with_semicolons(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t;y;F\n0,0;1,5;-2,25\n0,5;2,5;3\n")
    found = read(path, Columns({"time": "t", "position": "y", "force": "F"}))
    assert found["time"].tolist() == [0.0, 0.5]
    assert found["force"].tolist() == [-2.25, 3.0]


def test_a_file_in_another_encoding_is_refused(tmp_path):
    path = tmp_path / "log.csv"
    path.write_bytes("t,y,F\n0,1,2\n".encode("utf-16"))
    with pytest.raises(InputError, match="is not text in UTF-8"):
        read(path, Columns({"time": "t", "position": "y", "force": "F"}))
