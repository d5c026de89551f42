"""The page of a sweep: cells and lines that are lanes, and the trajectories that they show."""

import json
import re
from html import unescape

import numpy as np
import pytest

import stribeck
from stribeck import Scenario, simulate
from stribeck.sweeps import page
from stribeck.sweeps.maps import axis_of, spread_lanes, varied, whole_grid
from tests.simulation.rig import needs_compiler

pytest.importorskip("matplotlib")
pytest.importorskip("pyarrow")
pytestmark = [needs_compiler, pytest.mark.pictures]
SCENARIO = Scenario(
    law={"name": "lugre_majorant", "k_v": 1e6, "parameters": "canudas1995"}, plant={"mass": 1.0},
    drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
    solve={"t_end": 10.0}, output={"step": 0.05},
)  # fmt: skip
GRID = {
    "law.parameters.F_s": np.repeat([1.2, 1.5, 1.8], 2), "plant.mass": np.tile([0.5, 2.0], 3)
}  # fmt: skip


@pytest.fixture(autouse=True)
def _no_prints(monkeypatch):
    """The pictures for the page alone, not those to print."""
    monkeypatch.setattr("stribeck.report.plots.prints", lambda made, pdf: (b"png", b"pdf"))


@pytest.fixture(params=["summary", "trajectories"])
def written(request, tmp_path):
    found = stribeck.sweep(SCENARIO, GRID, tmp_path / "out", summary=request.param == "summary")
    page.write_sweep_page(found, "stribeck sweep")
    return (tmp_path / "out" / "_report" / "report.html").read_text()


def lanes_in(text, figure):
    return re.findall(rf'id="{figure}-lane-(\d+)"', text)


def panels_of(text, figure):
    return json.loads(unescape(re.search(rf'aria-label="{figure}"[^>]* data-axes="([^"]*)"', text)[1]))


def kept_in(text):
    return json.loads(re.search(r'class="picked-data">(.*?)</script>', text, re.S)[1])


def test_every_lane_is_a_cell_of_each_map_and_shows_its_own_run(written):
    kept, panels = kept_in(written), panels_of(written, "map")
    assert sorted(kept["cells"]) == list(range(6))
    assert len(panels) >= 3
    peak = next(panel for panel in panels if panel["title"] == "largest |F| (N)")
    assert (len(peak["cells"]["x"]), len(peak["cells"]["y"])) == (4, 3)
    assert sorted(map(int, kept["curves"])) == list(range(6))
    assert (peak["x"]["label"], peak["y"]["label"]) == ("law.parameters.F_s (N)", "plant.mass (kg)")
    for lane in (1, 4):
        values = {path: float(x[lane]) for path, x in GRID.items()}
        solution = simulate(SCENARIO.with_changes(values))
        cell = kept["cells"].index(lane)
        assert peak["cells"]["values"][cell] == pytest.approx(solution.peaks["F"], rel=1e-3)
        for k, side in enumerate("xy"):  # the cell is where its lane's values are
            at = [cell % 3, cell // 3][k]
            low, high = peak["cells"][side][at : at + 2]
            assert low < list(values.values())[k] < high
        assert kept["about"][str(lane)].startswith(
            f"law.parameters.F_s = {values['law.parameters.F_s']:.6g} N, plant.mass = {values['plant.mass']:.6g} kg: "
        )
        assert f"largest |F| {solution.peaks['F']:.3g} N" in kept["about"][str(lane)]
        for name, x in zip(kept["columns"], kept["curves"][str(lane)], strict=True):
            column = name.split(" ")[0]
            factor = 1e3 if "(m" in name and "(m)" not in name and "(m/" not in name else 1
            expected = np.interp(kept["t"], solution.t, solution[column])
            # five figures each; a lane and a single run, which is compiled otherwise, differ by less
            assert np.max(abs(np.array(x) / factor - expected)) <= 1e-4 * solution.peaks[column], column


def test_ranges_and_axes_have_the_units_that_a_person_would_use():
    wide = page.Quantity("y at the end", "m", "", np.array([3.95e-5, 7.54]))
    narrow = page.Quantity("largest |F|", "N", "", np.array([1.09, 1.97]))
    assert page._in_short(2, [wide, narrow]) == "2 lanes: y at the end 39.5 µm to 7.54 m, largest |F| 1.09 to 1.97 N."
    values = {
        "law.parameters.v_s": np.array([1e-3, 2e-3]), "drive.signal.rate": np.array([0.1, 0.6]), "solve.rtol": np.ones(2)
    }  # fmt: skip
    over = varied(SCENARIO, values)
    assert [q.unit for q in over] == ["m/s", "m/s", ""]
    shown = axis_of(over[0])
    assert (shown.label, shown.of(over[0].values).tolist()) == ("law.parameters.v_s (mm/s)", [1.0, 2.0])


def test_a_grid_of_two_numbers_is_a_map_up_to_200_values_a_side():
    side = np.arange(200.0)
    grid = {"a": np.repeat(side, 200), "b": np.tile(side, 200)}
    assert [len(each) for each in whole_grid(grid)] == [200, 200]


def test_many_cells_are_an_image_and_the_page_stays_small(tmp_path, monkeypatch):
    monkeypatch.setattr("stribeck.sweeps.page._PICKED", 8)
    monkeypatch.setattr("stribeck.sweeps.page._PATIENCE", 0.0)
    grid = {
        "plant.mass": np.repeat(np.linspace(0.5, 2, 24), 24),
        "law.parameters.F_s": np.tile(np.linspace(1.1, 2, 24), 24),
    }
    short = SCENARIO.with_changes({"solve.t_end": 0.5})
    page.write_sweep_page(stribeck.sweep(short, grid, tmp_path / "out", summary=True))
    text = (tmp_path / "out" / "_report" / "report.html").read_text()
    assert len(text) < 700_000  # 1.7 MB with a shape a cell
    assert kept_in(text)["cells"][1] == 24  # from below: the next cell has the next mass
    assert len(panels_of(text, "map")[0]["cells"]["values"]) == 576


def test_more_numbers_have_parallel_axes(tmp_path):
    rng = np.random.default_rng(0)
    values = {**{path: rng.uniform(1.2, 1.8, 9) for path in GRID}, "drive.stiffness": rng.uniform(1.0, 3.0, 9)}
    page.write_sweep_page(stribeck.sweep(SCENARIO, values, tmp_path / "out", summary=True))
    text = (tmp_path / "out" / "_report" / "report.html").read_text()
    assert sorted(lanes_in(text, "axes")) == [str(i) for i in range(9)]
    assert all("largest |F|" in about for about in kept_in(text)["about"].values())
    assert 'aria-label="map"' not in text


def test_one_number_has_no_map_and_still_its_lanes(tmp_path):
    page.write_sweep_page(stribeck.sweep(SCENARIO, {"plant.mass": [0.5, 1.0, 2.0]}, tmp_path / "out", summary=True))
    text = (tmp_path / "out" / "_report" / "report.html").read_text()
    assert "-lane-" not in text
    assert len(kept_in(text)["curves"]) == 3


def test_of_slow_lanes_few_are_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(page, "_PATIENCE", 0.0)
    masses = {"plant.mass": np.linspace(1.0, 2.0, 20)}
    page.write_sweep_page(stribeck.sweep(SCENARIO, masses, tmp_path / "out", summary=True))
    text = (tmp_path / "out" / "_report" / "report.html").read_text()
    assert sorted(map(int, kept_in(text)["curves"])) == [0, 3, 5, 8, 11, 14, 16, 19]


def test_of_a_large_sweep_no_more_lanes_are_kept_than_said(tmp_path, monkeypatch):
    monkeypatch.setattr(page, "_PICKED", 10)
    masses = {"plant.mass": np.linspace(1.0, 2.0, 37)}
    page.write_sweep_page(stribeck.sweep(SCENARIO, masses, tmp_path / "out", summary=True))
    kept = sorted(map(int, kept_in((tmp_path / "out" / "_report" / "report.html").read_text())["curves"]))
    assert (len(kept), kept[0], kept[-1]) == (10, 0, 36)


def test_what_is_a_grid():
    along, up = whole_grid(GRID)
    assert (along.tolist(), up.tolist()) == ([1.2, 1.5, 1.8], [0.5, 2.0])
    assert whole_grid({"a": np.array([1.0, 2.0]), "b": np.array([1.0, 2.0])}) is None  # a diagonal
    assert whole_grid({"a": np.array([1.0, 1.0]), "b": np.array([1.0, 2.0])}) is None  # a line
    assert (
        whole_grid({"a": np.array([1.0, 1.0, 2.0, 2.0]), "b": np.array([1.0, 1.0, 3.0, 4.0])}) is None
    )  # twice the same


@pytest.mark.parametrize(("across", "up", "apart"), [(50, 40, 3.9), (3, 700, 11.1), (400, 2, 4.1)])
def test_of_a_large_grid_a_lane_near_each_cell_is_kept(across, up, apart):
    order = np.random.default_rng(0).permutation(across * up)
    x, y = (each.ravel()[order] for each in np.meshgrid(np.arange(across), np.arange(up)))
    values = {"a": x + 1.0, "b": y + 1.0}
    lanes = spread_lanes(values, whole_grid(values), 100)
    assert 80 <= len(lanes) <= 100
    assert len(set(lanes.tolist())) == len(lanes)
    far = np.hypot(x[:, None] - x[lanes], y[:, None] - y[lanes]).min(axis=1)
    assert far.max() < apart
