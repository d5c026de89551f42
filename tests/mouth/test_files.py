"""Files are whole or not there; JSON is JSON; thinned lines keep their peaks."""

import json
import os
import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stribeck.files import together, trouble, write_json, write_text, write_with
from stribeck.mouth.document import Chapter, Document, FigureSvg, Table
from stribeck.mouth.page import html
from stribeck.mouth.plots import in_time, thin
from stribeck.mouth.terminal import lines


def test_a_failed_write_leaves_the_old_file_and_nothing_beside(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def fail(beside):
        beside.write_text("half")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_with(path, fail)
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]
    assert path.read_text() == "old"


def test_a_brief_chapter_has_five_facts_on_the_screen():
    notes = Chapter("notes", "Notes", facts=[f"fact {k}" for k in range(7)], brief=True)
    shown = [line.strip() for line in lines(Document("run", "done", chapters=(notes,)))]
    assert "fact 4" in shown
    assert "fact 5" not in shown


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes by name")
def test_a_pipe_is_written_directly(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    read = list[str]()
    reader = threading.Thread(target=lambda: read.append((tmp_path / "pipe").read_text()), daemon=True)
    reader.start()
    write_text(tmp_path / "pipe", "through")
    reader.join(10)
    assert read == ["through"]
    assert [p.name for p in tmp_path.iterdir()] == ["pipe"]


def test_a_folder_in_the_place_of_one_file_leaves_the_older_result_whole(tmp_path):
    for name in ("a.csv", "summary.json"):
        (tmp_path / name).write_text("old")
    (tmp_path / "b.svg").mkdir()

    def write():
        with together(tmp_path) as beside:
            for name in ("a.csv", "b.svg", "summary.json"):
                (beside / name).write_text("new")

    with pytest.raises(IsADirectoryError, match="must be a file"):
        write()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "b.svg", "summary.json"]
    assert (tmp_path / "a.csv").read_text() == (tmp_path / "summary.json").read_text() == "old"


def test_a_link_to_nothing_is_no_folder_and_said_to_be_a_link(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    assert "link to nothing" in trouble(tmp_path / "link", folder=True)
    (tmp_path / "file").touch()
    assert "is a file; must be a folder" in trouble(tmp_path / "file" / "below", folder=True)


def test_one_long_name_in_a_path_is_said_before_any_work(tmp_path):
    assert trouble(tmp_path / ("n" * 300)) == "cannot be written: File name too long"
    assert trouble(tmp_path / "n") is None


def test_json_has_null_for_what_is_not_finite(tmp_path):
    write_json(tmp_path / "a.json", {"a": [1.0, float("nan")], "b": float("inf")})
    assert json.loads((tmp_path / "a.json").read_text()) == {"a": [1.0, None], "b": None}


@given(st.integers(1, 60_000), st.integers(0, 100))
def test_a_thinned_line_keeps_its_ends_and_extremes(count, seed):
    rng = np.random.default_rng(seed)
    x, y = np.arange(count, dtype=float), rng.standard_normal(count)
    a, b = thin(x, y)
    assert len(a) == len(b) <= max(count, 1)
    assert len(a) < 20_000
    assert (a[0], a[-1]) == (x[0], x[-1])
    assert (b.min(), b.max()) == (y.min(), y.max())
    assert np.isin(a, x).all()


def test_page_escapes_text_and_keeps_figures_apart():
    svg = '<?xml version="1.0"?>\n<svg width="10pt" height="5pt" viewBox="0 0 10 5"><path id="p"/><use xlink:href="#p"/></svg>'
    figures = [FigureSvg("one", svg, "a < b"), FigureSvg("two", svg, "c")]
    page = html("T & U", "about", ["<script>"], [Chapter("k", "Title", ["x"], [Table(["h"], [["1 < 2"]])], figures)])
    assert "<script>" not in page
    assert "a &lt; b" in page
    assert 'id="one-p"' in page
    assert 'xlink:href="#two-p"' in page
    assert 'width="10pt"' not in page


def test_a_line_over_times_breaks_where_rows_lack_and_where_a_file_begins():
    """It was drawn straight across them."""
    time = np.concatenate([np.arange(0, 1, 0.01), np.arange(1.5, 2, 0.01), np.arange(1.99, 3, 0.01)])
    x, y = in_time(time, np.arange(len(time)))
    assert np.flatnonzero(np.isnan(y)).tolist() == [100, 151]
    assert np.isnan(x[[100, 151]]).all()
    assert np.array_equal(y[np.isfinite(y)], np.arange(len(time)))
    long = np.concatenate([np.arange(0, 100, 1e-3), np.arange(200, 300, 1e-3)])
    x, y = in_time(long, np.sin(long))
    (broken,) = np.flatnonzero(np.isnan(x))
    assert len(x) < 10_000
    assert x[broken - 1] < 100 < 200 <= x[broken + 1]
