"""Recorded tables: only what is named is read, and only from the file itself."""

import os
import struct
import subprocess
import sys
import tracemalloc
import zipfile
import zlib

import numpy as np
import pytest
from scipy.io import savemat

from stribeck import platforms
from stribeck.errors import InputError
from stribeck.recorded import opened, opened_with

T = np.arange(200) * 1e-3
WANTED = {"time": "time", "position": "position"}


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


def test_complex_numbers_are_refused(tmp_path):
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
        result = read_columns(path, WANTED)
        assert tracemalloc.get_traced_memory()[1] < 20e6
    finally:
        tracemalloc.stop()
    assert result["position"].tolist() == (T**2).tolist()


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
    for name, message in [("words", "holds text or dates"), ("names", "holds text or dates"), ("nothing", "is empty")]:
        with pytest.raises(InputError, match=f"position: '{name}'.*{message}"):
            read_columns(path, {"time": "time", "position": name})


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
    path = mat73(tmp_path / "a.mat", lambda h5py, file: ELSEWHERE["external storage"](h5py, file, tmp_path / "pipe"))
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


def test_an_npz_with_a_column_twice(tmp_path):
    """NumPy itself takes the last one."""
    path = tmp_path / "twice.npz"
    np.savez(path, t=T, u=T)
    duplicate = pytest.warns(UserWarning, match="Duplicate name")
    with zipfile.ZipFile(path, "a") as archive, duplicate, archive.open("u.npy", "w") as file:
        np.lib.format.write_array(file, 2 * T)
    source = opened(path)
    columns = source.columns({"time": "t", "position": "t"})
    assert [x.tolist() for x in columns.values()] == [T.tolist()] * 2
    assert not np.shares_memory(*columns.values())  # one column for two roles
    with pytest.raises(InputError, match=r"'u'.*is there twice"):
        source.columns({"time": "t", "force": "u"})
