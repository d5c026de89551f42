"""Recorded tables: only what is named is read, and only from the file itself."""

import os
import struct
import subprocess
import sys
import tracemalloc
import zipfile
import zlib
from decimal import Decimal

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from scipy.io import savemat

from stribeck import platforms
from stribeck.errors import InputError, StribeckNote
from stribeck.recorded import opened, opened_with
from stribeck.recorded.layout import is_units
from stribeck.recorded.units import LENGTH, TIME

T = np.arange(200) * 1e-3
WANTED = {"time": "time", "position": "position"}


@pytest.fixture(params=["pyarrow", "lines"])
def either_reader(request, monkeypatch):
    """CSV files are read by pyarrow, or without it line by line."""
    if request.param == "lines":
        monkeypatch.setattr("stribeck.recorded.find_spec", lambda name: None)


def mat73(path, fill):
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        file["time"] = T
        fill(h5py, file)
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, HDF5 schema 1.00 .".ljust(116) + bytes(8) + b"\x00\x02IM")
    return path


def read_columns(data, wanted):
    return opened_with(data, wanted).columns(wanted)


def zeros_in_npz(path, count):
    """An NPZ with two short columns and one of zeros, of which nothing is in memory."""
    np.savez(path, time=T, position=T**2)
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive, archive.open("other.npy", "w") as file:
        np.lib.format.write_array_header_1_0(file, {"descr": "<f8", "fortran_order": False, "shape": (count,)})
        for _ in range(count >> 17):
            file.write(bytes(1 << 20))
    return path


@pytest.mark.parametrize(
    ("line", "units"),
    [("s,mm,N", True), ("[s],[mm],[N]", True), ("s,,N", True), (",,", False), ("s,mm", False), ("s,mm,1.5", False),
     ("s,millimetres,N", False), ("0,1,2", False)],
)  # fmt: skip
def test_a_line_of_units_has_a_short_word_or_nothing_for_each_column(line, units):
    assert is_units(line, ",", 3) is units


@pytest.mark.parametrize("first", ["0", '"1,000"'])
def test_a_quoted_comma_of_thousands_between_commas_is_named(tmp_path, first, either_reader):
    """It was reported as text, and in the first row as a missing column."""
    (tmp_path / "log.csv").write_text(f't,v\n0,{first}\n1,"1,250.5"\n2,"2,500"\n')
    row, cell = ("2", "1,000") if first != "0" else ("3", "1,250.5")
    text = f"v: column 'v': '{cell}': must be written without the comma of thousands \\(.*log.csv, row {row}\\)"
    with pytest.raises(InputError, match=text):
        read_columns(tmp_path / "log.csv", {"v": "v"})


def test_columns_of_matrices_and_constants_of_a_mat_file(tmp_path):
    savemat = pytest.importorskip("scipy.io").savemat
    savemat(tmp_path / "a.mat", {"time": T[:, None], "q": np.stack([T, T**2], axis=1), "rate": 200.0, "note": "hello"})
    source = opened(tmp_path / "a.mat")
    assert {"time", "q", "q[0]", "q[1]"} <= set(source.names)
    assert source.constants == {"rate": 200.0}
    found = source.columns({"time": "time", "one": "q[0]", "two": "q[1]", "again": "q[1]"})
    assert found["two"].tolist() == (T**2).tolist()
    found["two"][0] = 7.0
    assert found["again"][0] == 0.0
    with pytest.raises(InputError, match=r"is a matrix, \(200, 2\); its columns are q\[0\], q\[1\]"):
        source.columns({"position": "q"})
    with pytest.raises(InputError, match="holds text or dates"):
        source.columns({"position": "note"})


def test_a_title_with_a_number_is_not_the_table(tmp_path):
    (tmp_path / "a.csv").write_text("Rig,7\nday,2\n\nt,F\n0,1\n1,2\n2,3\n")
    assert opened(tmp_path / "a.csv").names == ["t", "F"]


@pytest.mark.parametrize(
    ("head", "names"),
    [
        ("Test,12\nt,v\n", ["t", "v"]),  # short names below a title, not its units
        ("12,2026\nt,v\n", ["t", "v"]),  # a title of numbers, not a row
        ("Test,12\nt,v\ns,mm\n", ["t", "v"]),
        ("Test,12\ntime_of_day,angle\n", ["time_of_day", "angle"]),
        ("time,1\ns,mV\n", ["time", "1"]),  # a channel's number, with its unit below
        ("time,1\n[s],[V]\n", ["time", "1"]),
        ("Test,12,3\nt,v\n", ["t", "v"]),  # a title of another width
    ],
)  # fmt: skip
def test_names_stand_directly_above_the_rows_or_their_units(tmp_path, head, names):
    (tmp_path / "a.csv").write_text(head + "0,1\n1,2\n2,3\n")
    found = opened(tmp_path / "a.csv")
    assert found.names == names
    assert found.columns({"position": names[1]})["position"].tolist() == [1, 2, 3]


@pytest.mark.parametrize(
    "head", ["t,v\n\n", "t,v\n\n\n\n", "t,v\ns,mm\n\n", "t,v\n\ns,mm\n", "Rig 7\n\nt,v\n  \n", "\nt,v\n"]
)
def test_blank_lines_do_not_part_the_names_from_the_rows(tmp_path, either_reader, head):
    (tmp_path / "a.csv").write_text(head + "0,1\n1,2\n\n2,3\n")
    found = opened(tmp_path / "a.csv")
    assert found.names == ["t", "v"]
    assert found.stated == ({"t": "s", "v": "mm"} if "mm" in head else {})
    assert found.columns({"position": "v"})["position"].tolist() == [1, 2, 3]


def test_a_row_of_missing_numbers_below_the_names_is_a_row(tmp_path, either_reader):
    (tmp_path / "a.csv").write_text("t,v\n,\n1,2\n2,3\n")
    read = opened(tmp_path / "a.csv").columns({"position": "v"})["position"]
    assert np.array_equal(read, [np.nan, 2, 3], equal_nan=True)


@pytest.mark.parametrize("mark", ["\v", "\f", "\x1c", "\x1d", "\x1e", "\x85", "\u2028", "\u2029"])
def test_marks_of_unicode_end_no_line(tmp_path, either_reader, mark):
    """Readers of rows end lines at CR and LF alone; a head that is counted otherwise loses rows."""
    path = tmp_path / "log.csv"
    path.write_text(f"# made{mark} by me\nt,v{mark}a\n0,5\n1,6\n", encoding="utf-8", newline="")
    names = {"t": "t", "v": f"v{mark}a"}
    x = opened(path).columns(names)
    assert x["t"].tolist() == [0, 1]
    assert x["v"].tolist() == [5, 6]


def test_a_quote_that_is_never_closed_is_named(tmp_path):
    """It swallowed the rows below it, without a word."""
    rows = [f"{i},{2 * i},x" for i in range(400)]
    rows[100] = '100,200,"oops'
    (tmp_path / "a.csv").write_text("\n".join(["t,v,note", *rows]) + "\n")
    with pytest.raises(InputError, match="row 102 has a quote that is never closed"):
        opened(tmp_path / "a.csv").columns({"position": "v"})
    rows[100] = '100,200,5" pipe'  # within a cell it is a letter
    (tmp_path / "a.csv").write_text("\n".join(["t,v,note", *rows]) + "\n")
    assert len(opened(tmp_path / "a.csv").columns({"position": "v"})["position"]) == 400


@pytest.mark.parametrize("micro", ["us,um", "\u00b5s,\u00b5m", "\u03bcs,\u03bcm"])
def test_micro_has_three_spellings(tmp_path, micro):
    (tmp_path / "a.csv").write_text(f"t,y\n{micro}\n0,1\n1,2\n", encoding="utf-8")
    read = opened(tmp_path / "a.csv")
    assert [(TIME | LENGTH)[unit] for unit in read.stated.values()] == [1e-6, 1e-6]


@pytest.mark.parametrize("names", ["t,v\n", "t,v\ns,mm\n", "Rig,12\nt,v\n", "t,v\n\n"])
@pytest.mark.parametrize(("row", "count"), [("0,1,", 3), ("0,1,5", 3), ("0,1,5,6", 4), ("0", 1), ("0,1,\n7,7,7", 3)])
def test_a_first_row_of_another_width_is_named(tmp_path, either_reader, names, row, count):
    """The names were lost, and the columns were said not to be there."""
    (tmp_path / "a.csv").write_text(f"{names}{row}\n1,2\n2,3\n3,4\n")
    found = opened(tmp_path / "a.csv")
    assert found.names == ["t", "v"]
    at = names.count("\n") + 1
    text = rf"(Row #{at}: Expected 2 columns, got {count}:|row {at} has {count} cells, not 2)"
    with pytest.raises(InputError, match=text):
        found.columns({"position": "v"})


def test_a_row_of_another_width_without_names_above_is_named(tmp_path):
    """A search of the table's first line that looked far ahead passed over the rows above."""
    (tmp_path / "a.csv").write_text("0,1\n1,2\n2,3\n3\n4,5\n5,6\n6,7\n7,8\n")
    with pytest.raises(InputError, match=r"Row #4: Expected 2 columns, got 1:|row 4 has 1 cells, not 2"):
        opened(tmp_path / "a.csv").columns({"position": "2"})


@pytest.mark.parametrize("cell", ["", "nan", "bad"])
def test_a_cell_that_is_no_number_makes_its_row_no_line_of_names(tmp_path, cell):
    (tmp_path / "a.csv").write_text(f"0,1\n1,{cell}\n2,3\n")
    assert opened(tmp_path / "a.csv").names == ["1", "2"]


def test_a_first_row_with_a_word_in_it_is_no_line_of_names(tmp_path):
    (tmp_path / "a.csv").write_text("position,force\n0,bad\n1,2\n2,3\n")
    assert opened(tmp_path / "a.csv").names == ["position", "force"]


def test_complex_numbers_are_refused(tmp_path):
    savemat = pytest.importorskip("scipy.io").savemat
    savemat(tmp_path / "a.mat", {"time": T, "force": T + 1j})
    with pytest.raises(InputError, match=r"^force: 'force': this column of .* holds complex numbers, not real ones$"):
        read_columns(tmp_path / "a.mat", {"time": "time", "force": "force"})

    def fill(h5py, file):
        file["position"] = np.array([(1.0, 2.0)] * 200, [("real", "f8"), ("imag", "f8")])

    with pytest.raises(InputError, match="holds complex numbers"):
        read_columns(mat73(tmp_path / "b.mat", fill), WANTED)


@pytest.mark.parametrize("chunks", [None, (50,)])
def test_rows_that_were_never_written_are_not_zeros(tmp_path, chunks):
    def fill(h5py, file):
        x = file.create_dataset("position", (200,), "f8", chunks=chunks)
        if chunks:
            x[:50] = 1.0

    with pytest.raises(InputError, match=r"position: 'position': this column of .* has rows that were never written"):
        read_columns(mat73(tmp_path / "a.mat", fill), WANTED)


def test_cells_of_other_columns_may_hold_line_breaks(tmp_path, either_reader):
    path = tmp_path / "a.csv"
    path.write_text("t,x,what\n" + "".join(f'{k},{k}.5,"a,""b\nc"\n' for k in range(9)))
    assert read_columns(path, {"time": "t", "x": "x"})["x"].tolist() == [k + 0.5 for k in range(9)]


def zeros_in(kind, folder, count):
    """A file with two short columns and one of zeros, of which nothing is in memory."""
    if kind == "npz":
        return zeros_in_npz(folder / "big.npz", count)
    if kind == "mat 5":
        return mat5(folder / "big.mat", count)

    def fill(h5py, file):
        file["position"] = T**2
        x = file.create_dataset("other", shape=(count,), dtype="f8", chunks=(1 << 20,), compression="gzip")
        for begin in range(0, count, 1 << 20):
            x[begin : begin + (1 << 20)] = 0.0

    return mat73(folder / "big.mat", fill)


@pytest.mark.parametrize("kind", ["npz", "mat 7.3"])
def test_a_column_that_nobody_names_takes_no_memory(tmp_path, kind):
    path = zeros_in(kind, tmp_path, 1 << 24)  # 134 MB
    tracemalloc.start()
    try:
        found = read_columns(path, WANTED)
        assert tracemalloc.get_traced_memory()[1] < 20e6
    finally:
        tracemalloc.stop()
    assert found["position"].tolist() == (T**2).tolist()


@pytest.mark.parametrize("kind", ["npz", "mat 7.3", "mat 5"])
def test_lengths_are_compared_before_a_column_is_read(tmp_path, monkeypatch, kind):
    source = opened(zeros_in(kind, tmp_path, 1 << 20))
    monkeypatch.setattr(type(source), "_read", lambda self, name: pytest.fail(f"{name} is read"))
    words = rf"force: 'other': this column of .* has {1 << 20} rows, its times \(time\) have 200"
    with pytest.raises(InputError, match=words):
        source.columns({"force": "other", "time": "time", "position": "position"})
    with pytest.raises(InputError, match=rf"has 200 rows, its times \(other\) have {1 << 20}"):
        source.columns({"time": "time", "force": "position", "t": "other"}, {"force": "t"})


def test_a_mat_7_3_file_is_what_matlab_shows(tmp_path):
    """The columns of a square matrix are those of the same matrix in version 5; text and empty arrays are no numbers."""
    q = np.arange(float(len(T) ** 2)).reshape(len(T), len(T))

    def fill(h5py, file):
        file["q"] = q.T  # as MATLAB writes it
        for name, x, attribute in [
            ("words", np.arange(200, dtype="u2"), {"MATLAB_class": np.bytes_("char")}),
            ("nothing", np.array([0, 0], "u8"), {"MATLAB_class": np.bytes_("double"), "MATLAB_empty": np.uint8(1)}),
        ]:
            file[name] = x
            file[name].attrs.update(attribute)
        file["names"] = np.array([b"a"] * 200)

    path, wanted = mat73(tmp_path / "new.mat", fill), {"time": "time", "position": "q[1]"}
    savemat(tmp_path / "old.mat", {"time": T, "q": q})
    for file in (path, tmp_path / "old.mat"):
        assert read_columns(file, wanted)["position"].tolist() == q[:, 1].tolist()
    for name, said in [("words", "holds text or dates"), ("names", "holds text or dates"), ("nothing", "is empty")]:
        with pytest.raises(InputError, match=f"position: '{name}'.*{said}"):
            read_columns(path, {"time": "time", "position": name})


@pytest.mark.parametrize(
    "of",
    [
        lambda x: np.array(x, object), lambda x: pd.Series(x, dtype=object), lambda x: [Decimal(repr(v)) for v in x],
        lambda x: pd.array(x, dtype="Float64"), lambda x: pa.table({"F": x})["F"],
    ],
)  # fmt: skip
def test_numbers_of_any_kind_in_a_table_are_numbers(of):
    found = read_columns({"time": T, "F": of((T**2).tolist())}, {"time": "time", "force": "F"})
    assert found["force"].tolist() == (T**2).tolist()


def test_missing_masked_and_huge_cells_of_a_table():
    x = (T**2).tolist()
    for column in (
        [None, *x[1:]], pd.Series([pd.NA, *x[1:]], dtype=object), np.ma.array([1e9, *x[1:]], mask=T == 0),
        [10**400, *x[1:]],
    ):  # fmt: skip
        found = read_columns({"time": T, "F": column}, {"time": "time", "force": "F"})["force"]
        assert not np.isfinite(found[0])
        assert found[1:].tolist() == x[1:]
    for column in (
        ["1.0", *x[1:]], pd.Series(["1.0", *x[1:]], dtype=object), [[1.0], *x[1:]], [1 + 1j, *x[1:]],
    ):  # fmt: skip
        with pytest.raises(InputError):
            read_columns({"time": T, "F": column}, {"time": "time", "force": "F"})
    with pytest.raises(InputError, match="force: 'F': this variable of the table is one value"):
        read_columns({"time": T, "F": 3.0}, {"time": "time", "force": "F"})


def test_a_table_of_arrow_is_a_table():
    found = read_columns(pa.table({"time": T, "F": T**2}), {"time": "time", "force": "F"})
    assert found["force"].tolist() == (T**2).tolist()


def test_lengths_of_matrices_and_tables_in_memory_are_compared():
    table = {"time": T, "q": np.zeros((150, 3)), "F": T[:, None], "name": ["a"] * 200}
    assert len(read_columns(table, {"time": "time", "force": "F"})["force"]) == 200
    with pytest.raises(InputError, match=r"^position: 'q\[1\]'.* has 150 rows, its times \(time\) have 200$"):
        read_columns(table, {"time": "time", "position": "q[1]", "force": "F"})
    with pytest.raises(InputError, match="holds text or dates"):
        read_columns(table, {"time": "time", "force": "name"})


def mat5(path, count):
    """A compressed MAT 5 file of two short columns and one of zeros, of which nothing is in memory."""
    pytest.importorskip("scipy.io").savemat(path, {"time": T, "position": T**2}, do_compression=True)
    words = [14, 8 * count + 48, 6, 8, 6, 0, 5, 8, count, 1, 1, 5]  # a matrix, its flags (double), shape and name
    packed = zlib.compressobj(1)
    with path.open("ab") as file:
        start = file.tell()
        file.write(bytes(8))
        file.write(packed.compress(struct.pack("<12I", *words) + b"other\0\0\0" + struct.pack("<2I", 9, 8 * count)))
        for _ in range(count >> 17):
            file.write(packed.compress(bytes(1 << 20)))
        file.write(packed.flush())
        size = file.tell() - start - 8
    with path.open("r+b") as file:
        file.seek(start)
        file.write(struct.pack("<2I", 15, size))
    return path


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform != "linux", reason="needs the peak memory of a process, as /proc has it")
def test_a_column_of_mat_5_that_nobody_names_takes_bounded_memory(tmp_path):
    """SciPy passes over it in pieces of some 100 MB, however long the column is."""
    path = mat5(tmp_path / "big.mat", 1 << 27)
    assert opened(path).variables["other"].shape == (1 << 27, 1)
    text = f"""
from pathlib import Path
from stribeck.recorded import opened_with
found = opened_with({str(path)!r}, {WANTED!r}).columns({WANTED!r})
lines = Path("/proc/self/status").read_text().splitlines()
print(found["position"].sum(), next(line.split()[1] for line in lines if line.startswith("VmHWM:")))
"""
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    total, peak = map(float, done.stdout.split())
    assert total == pytest.approx(np.sum(T**2))
    assert 1024 * peak < 2**29  # half of the column


def test_columns_that_do_not_fit_are_refused_before_they_are_read(tmp_path, monkeypatch):
    path = zeros_in_npz(tmp_path / "big.npz", 1 << 17)
    monkeypatch.setattr(platforms, "free_memory", lambda: 1e6)
    assert len(read_columns(path, WANTED)) == 2
    with pytest.raises(InputError, match=r"cannot be read: the columns take 1\.05 MB, and 1 MB are free"):
        read_columns(path, {"position": "other"})


ELSEWHERE = {
    "external storage": lambda h5py, file, there: file.create_dataset(
        "position", shape=(200,), dtype="u1", external=[(str(there), 0, 200)]
    ),
    "an external link": lambda h5py, file, there: file.__setitem__("position", h5py.ExternalLink(str(there), "/x")),
    "a virtual dataset": lambda h5py, file, there: file.create_virtual_dataset("position", virtual(h5py, there)),
}


def virtual(h5py, there):
    layout = h5py.VirtualLayout(shape=(200,), dtype="f8")
    layout[:] = h5py.VirtualSource(str(there), "x", shape=(200,))
    return layout


@pytest.mark.parametrize("what", list(ELSEWHERE))
def test_a_column_that_lies_in_another_file_is_refused(tmp_path, what):
    there = tmp_path / "secret"
    there.write_bytes(bytes(range(200)) * 8)
    path = mat73(tmp_path / "a.mat", lambda h5py, file: ELSEWHERE[what](h5py, file, there))
    with pytest.raises(InputError, match=rf"position: 'position': this column of .* lies in another file \({what}\)"):
        read_columns(path, WANTED)
    assert read_columns(path, {"time": "time"})["time"].tolist() == T.tolist()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes by name")
def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    path = mat73(
        tmp_path / "a.mat",
        lambda h5py, file: ELSEWHERE["external storage"](h5py, file, tmp_path / "pipe"),
    )
    with pytest.raises(InputError, match="lies in another file"):
        read_columns(path, WANTED)


@pytest.mark.parametrize("way", ["time", "/no/where", "position"])
def test_a_link_is_not_followed(tmp_path, way):
    path = mat73(tmp_path / "a.mat", lambda h5py, file: file.__setitem__("position", h5py.SoftLink(way)))
    with pytest.raises(
        InputError, match=f"position: 'position': this column of .* is a link to '{way}'; must be in the file"
    ):
        read_columns(path, WANTED)
    assert read_columns(path, {"time": "time"})["time"].tolist() == T.tolist()


def test_a_name_that_is_no_text_hides_no_other_column(tmp_path):
    def fill(h5py, file):
        file["position"] = T**2
        file.id.links.create_soft(b"\xff", b"\xff/x")

    assert read_columns(mat73(tmp_path / "a.mat", fill), WANTED)["position"].tolist() == (T**2).tolist()


@pytest.mark.parametrize(
    "cell",
    ["1e3", "+1", "-.5", "5.", "inf", "NaN", "NAN", "null", "#N/A", "n/a", "", " 2 ", "1_000", "\u0663", "1\xa0", "0x10",
     "1d0", "1,5", "1.234,5", "  "],
)  # fmt: skip
@pytest.mark.parametrize("decimal", [".", ","])
def test_a_cell_is_the_same_number_without_pyarrow(tmp_path, monkeypatch, cell, decimal):
    pytest.importorskip("pyarrow")
    path = tmp_path / "a.csv"
    path.write_text(f"time;force\n0;0{decimal}5\n1;1{decimal}5\n2;{cell}\n3;2{decimal}5\n", encoding="utf-8")
    found = []
    for _ in range(2):
        try:
            found.append(repr(read_columns(path, {"force": "force"})["force"].tolist()))
        except InputError as error:
            found.append(str(error).partition(", not numbers")[2])
        monkeypatch.setattr("stribeck.recorded.find_spec", lambda name: None)
    assert found[0] == found[1]


@pytest.mark.parametrize("cell", ["1,004", "1.004", "-12,345"])
def test_a_number_that_may_be_thousands_is_asked_about(tmp_path, cell):
    path = tmp_path / "a.csv"
    path.write_text("time;force\n" + "".join(f"{i};{x}\n" for i, x in enumerate(["3", cell, "250", "7", "12"])))
    with pytest.warns(StribeckNote, match=f"{cell!r} in column 'force' is read as {cell.replace(',', '.')}"):
        found = read_columns(path, {"time": "time", "force": "force"})
    assert found["force"][1] == float(cell.replace(",", "."))


@pytest.mark.parametrize("cell", ["1.004", "2.000"])
def test_it_is_asked_about_wherever_it_stands(tmp_path, cell):
    """Beyond the beginning from which the marks are known."""
    path = tmp_path / "a.csv"
    path.write_text("time;force\n" + "".join(f"{i};{cell if i == 15_000 else i % 900}\n" for i in range(20_000)))
    with pytest.warns(StribeckNote, match=f"{cell!r} in column 'force' is read as"):
        read_columns(path, {"time": "time", "force": "force"})


def test_a_head_that_is_longer_than_the_beginning_is_read(tmp_path):
    path = tmp_path / "a.csv"
    names = ["time", "force", *(f"channel_{i}" for i in range(9_000))]
    path.write_text(",".join(names) + "\n" + "".join(",".join([str(i)] * len(names)) + "\n" for i in range(9)))
    assert read_columns(path, {"time": "time", "force": "force"})["force"].tolist() == list(range(9))


@pytest.mark.parametrize("separator", [";", "\t"])
@pytest.mark.parametrize("mark", [",", "."])
def test_one_note_asks_where_every_cell_has_such_a_mark(tmp_path, either_reader, separator, mark):
    path = tmp_path / "a.csv"
    rows = [["time", "force"], *([f"{100 + i},00{i}", f"-{i + 1},250"] for i in range(9))]
    path.write_text("".join(separator.join(row).replace(",", mark) + "\n" for row in rows))
    with pytest.warns(StribeckNote) as notes:
        found = read_columns(path, {"time": "time", "force": "force"})
    assert found["force"][0] == -1.25
    assert [str(each.message) for each in notes] == [
        f"'{path}': '100{mark}000' in column 'time' is read as 100.000, not as a number of thousands, and so are others in "
        "force: write such numbers without the mark if they are thousands"
    ]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "rows",
    [
        ["0;0,004", "1;3", "2;1,5", "3;0"],
        ["0;1,004", "1;3", "2;4500", "3;0"],  # thousands of this column have no mark
        ["0,001;1,004", "0,002;1,250", "0,003;2,000"],  # the times show what the comma is
        ["0.000;1.004", "0.001;1.250", "0.002;2.000"],
        ["999.999;1.004", "1000.000;1.250", "1000.001;1.250"],
        ["1,004;1e3", "2,250;-1,5e0"],
        ["100.000,1.004", "100.001,1.250", "100.002,2.000"],  # columns that commas part
        ["100.000\t1.0041", "100.001\t1.250"],
        ["1;2", "2;4", "3;5"],
        ["1;nan", "2;", "3;"],
    ],
    ids=" ".join,
)
def test_plain_decimals_are_not_asked_about(tmp_path, rows):
    path = tmp_path / "a.csv"
    names = next(s for s in ";\t," if s in rows[0]).join(("time", "force"))
    path.write_text("\n".join([names, *rows]) + "\n")
    assert len(read_columns(path, {"time": "time", "force": "force"})["force"]) == len(rows)


@pytest.mark.filterwarnings("error")
def test_a_column_that_nobody_names_shows_the_mark_too(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("time;force;speed\n" + "".join(f"{i};1,004;0,0{i}\n" for i in range(9)))
    read_columns(path, {"time": "time", "force": "force"})


def test_a_mark_of_the_other_kind_shows_nothing(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("time;force;speed;date\n" + "".join(f"{i};1.004;2,5;12.05.2024\n" for i in range(9)))
    with pytest.warns(StribeckNote, match=r"'1\.004' in column 'force' is read as 1\.004"):
        read_columns(path, {"time": "time", "force": "force"})


def test_an_npz_with_a_column_twice(tmp_path):
    """NumPy itself takes the last one."""
    path = tmp_path / "twice.npz"
    np.savez(path, t=T, u=T)
    duplicate = pytest.warns(UserWarning, match="Duplicate name")
    with zipfile.ZipFile(path, "a") as archive, duplicate, archive.open("u.npy", "w") as file:
        np.lib.format.write_array(file, 2 * T)
    source = opened(path)
    assert source.columns({"time": "t"})["time"].tolist() == T.tolist()
    with pytest.raises(InputError, match=r"'u'.*is there twice"):
        source.columns({"time": "t", "force": "u"})
