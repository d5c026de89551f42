"""stribeck sweep: what it writes, and that it goes on where it was stopped."""

import json
import os
import signal
import subprocess
import sys
import time
from hashlib import sha256
from io import BytesIO

import numpy as np
import pyarrow.parquet as parquet
import pytest

from stribeck.files import parquet_of
from stribeck.platforms import locked
from stribeck.sweeps import job as module
from tests.shared import LINKS

GRID = ("--vary", "law.k_v=1e6:1e8:3:log", "--vary", "law.parameters.F_s=0.9:1.8:4")


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.fixture
def small_parts(monkeypatch):
    """Five lanes a part, so that some sweeps have several."""
    monkeypatch.setattr(module, "_PART_BYTES", 5 * 8.0 * 7 * 1001)


def test_amplitude_and_period_of_a_limit_cycle(stribeck, tmp_path):
    stribeck("new", "limit_cycle", "--out", tmp_path / "cycle.toml")
    words = ("--vary", "law.k_v=1e6:1e6:1", "--summary", "--set", "law.name=lugre_sobczyk")
    assert stribeck("sweep", tmp_path / "cycle.toml", *words, "--out", tmp_path / "out").status == 0
    (row,) = parquet.read_table(tmp_path / "out").to_pylist()
    assert row["amplitude"] == pytest.approx(0.063093, abs=2e-5)  # theory.md, section 4
    assert row["period"] == pytest.approx(24.64, abs=0.02)


@pytest.mark.share(3)
@pytest.mark.parametrize("where", [0.3, 0.5, 0.7])
def test_a_part_that_is_damaged_in_its_middle_is_made_again(where, stribeck, scenario, tmp_path, small_parts):
    """Its end, which says what it holds, can still be read."""
    out = tmp_path / "out"
    stribeck("sweep", scenario, *GRID, "--summary", "--out", out)
    whole = files(out)
    manifest = json.loads(whole["_manifest.json"])
    assert {n: sha256(b).hexdigest() for n, b in whole.items() if n.startswith("part")} == manifest["sha256"]
    part = bytearray(whole["part-000001.parquet"])
    part[int(where * len(part))] ^= 0xFF
    (out / "part-000001.parquet").write_bytes(part)
    data = json.loads(stribeck("sweep", scenario, *GRID, "--summary", "--out", out, "--json").out)
    assert data["parts_found"] == data["parts"] - 1
    assert files(out) == whole


@pytest.mark.thorough
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
def test_killed_at_any_moment_it_ends_with_the_same_bytes(stribeck, scenario, tmp_path):
    code = (
        "import sys; from stribeck.sweeps import job; job._PART_BYTES = 40 * 8.0 * 7 * 1001; "
        "from stribeck.cli import main; main(sys.argv[1:])"
    )
    words = [scenario, "--vary", "law.k_v=1e6:1e8:1000:log", "--summary", "--out"]
    command = [sys.executable, "-c", code, "sweep", *map(str, words)]
    killed, whole = tmp_path / "killed", tmp_path / "whole"
    for parts in (1, 7):
        process = subprocess.Popen([*command, str(killed)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while len(list(killed.glob("part-*"))) < parts and process.poll() is None:
            time.sleep(0.005)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        assert len(list(killed.glob("part-*"))) < 25
    for folder in (killed, whole):
        assert subprocess.run([*command, str(folder)], check=False, capture_output=True).returncode == 0
    assert files(killed) == files(whole)
    assert len(files(whole)) == 26


def test_another_sweep_is_not_overwritten(stribeck, scenario, tmp_path):
    out = tmp_path / "out"
    stribeck("sweep", scenario, *GRID, "--summary", "--out", out)
    before = files(out)
    for words in (GRID[:2], (*GRID, "--set", "plant.mass=2.0"), (*GRID, "--set", "solve.rtol=1e-7")):
        result = stribeck("sweep", scenario, *words, "--summary", "--out", out)
        assert result.status == 2
        assert result.err.startswith(f"--out: {str(out)!r}: holds another sweep")
    assert files(out) == before
    (out / "_manifest.json").unlink()
    assert "unknown sweep" in stribeck("sweep", scenario, *GRID, "--summary", "--out", out).err


def test_one_process_at_a_time(stribeck, scenario, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    with locked(out):
        result = stribeck("sweep", scenario, *GRID, "--out", out)
    assert (result.status, list(out.iterdir())) == (2, [])
    assert "another process is at work there" in result.err


def test_a_table_holds_texts_numbers_and_what_is_missing():
    values = {"reason": ["", "\u00e9", "b"], "lane": [3, 2**53 + 1, -1], "F": [np.nan, 1.5, np.nan]}
    columns = [(name, "N", "what it is", np.array(x)) for name, x in values.items()]
    table = parquet.read_table(BytesIO(parquet_of(columns)))
    assert table.to_pydict() == values | {"F": [None, 1.5, None]}
    assert table.schema.field("F").metadata == {b"unit": b"N", b"meaning": b"what it is"}


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes by name")
def test_damage_that_is_no_file(stribeck, scenario, tmp_path):
    """A manifest nested too deep and a link to itself ended in tracebacks; pipes were waited for; a folder that kill -9 left
    (of a run into the same place) kept the sweep from going on."""
    out = tmp_path / "out"
    words = ("sweep", scenario, *GRID[:2], "--summary", "--out", out)
    stribeck(*words)
    whole = files(out)
    (part,) = (out / name for name in whole if name.startswith("part"))

    def again(damage):
        damage()
        assert stribeck(*words).status == 0
        assert files(out) == whole

    (out / ".12-0a1b2c3d.tmp").mkdir()
    again(lambda: (out / ".12-0a1b2c3d.tmp" / "half").write_bytes(b"half"))
    for make in (os.mkfifo, lambda path: path.symlink_to(path.name), lambda path: path.symlink_to("/dev/zero")):
        part.unlink()
        again(lambda make=make: make(part))
    manifest = out / "_manifest.json"
    manifest.write_text("[" * 100_000)
    assert stribeck(*words).status == 2
    manifest.unlink()
    os.mkfifo(manifest)
    assert stribeck(*words).status == 2


def test_what_somebody_else_put_into_the_folder(stribeck, scenario, tmp_path, small_parts):
    """Digests that are none ended in a traceback; a part too many was read with the others; a link's target was written."""
    out, mine = tmp_path / "out", tmp_path / "mine"
    words = ("sweep", scenario, *GRID, "--summary", "--out", out)
    stribeck(*words)
    whole = files(out)
    manifest = json.loads(whole["_manifest.json"])
    manifest["sha256"] |= {
        "part-000001.parquet": [1],
        "part-000002.parquet": {},
        "../x": "0",
        "part-000007.parquet": "0",
    }
    (out / "_manifest.json").write_text(json.dumps(manifest))
    assert stribeck(*words).status == 0
    assert files(out) == whole
    mine.write_bytes(b"mine")
    if LINKS:
        (out / "part-000001.parquet").unlink()
        (out / "part-000001.parquet").symlink_to(mine)
        assert stribeck(*words).status == 0
        assert files(out) == whole
        assert mine.read_bytes() == b"mine"
    for name in ("part-000003.parquet", "part-000001.csv"):
        (out / name).write_bytes(b"")
        answer = stribeck(*words)
        assert (answer.status, answer.err.count("\n")) == (2, 1)
        assert f"holds {name}, which is no part of this sweep" in answer.err
        (out / name).unlink()
    for text in ("", "{", "[]"):
        (out / "_manifest.json").write_text(text)
        answer = stribeck(*words)
        assert (answer.status, answer.err.count("\n")) == (2, 1)
        assert "_manifest.json in it is damaged" in answer.err
