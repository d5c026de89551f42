"""A click on a cell of a sweep's page, in a real browser."""

import re

import numpy as np
import pytest

import stribeck
from stribeck.sweeps import page
from tests.explore.test_browser import browser, pytestmark  # noqa: F401
from tests.sweeps.test_page import GRID, SCENARIO, _no_prints  # noqa: F401


@pytest.mark.pictures
def test_a_click_shows_the_lane(browser, tmp_path):  # noqa: F811
    found = stribeck.sweep(SCENARIO, GRID, tmp_path / "out", summary=True)
    page.write_sweep_page(found)
    browser.get((tmp_path / "out" / "_report" / "report.html").as_uri())
    about = "return document.querySelector('.picked span').textContent"
    assert "plant.mass = 0.5" in browser.execute_script(about)
    assert not browser.get_log("browser")
    # lane 3, the middle of the upper row
    where = "const svg = document.querySelector('svg[aria-label=map]'), [x, y, w, h] = JSON.parse(svg.dataset.axes)[0].box;" \
        "const p = new DOMPoint(x + w / 2, y + h / 4).matrixTransform(svg.getScreenCTM());" \
        "svg.dispatchEvent(new MouseEvent(arguments[0], {bubbles: true, clientX: p.x, clientY: p.y}));"  # fmt: skip
    browser.execute_script(where, "click")
    told = browser.execute_script(about)
    assert told.startswith("law.parameters.F_s = 1.5 N, plant.mass = 2 kg: largest |F| ")
    browser.execute_script(where, "pointermove")
    tip = browser.execute_script("return document.querySelector('.tip').innerText").replace("\n", ", ")
    assert tip.startswith("law.parameters.F_s = 1.5 N, plant.mass = 2 kg")
    peak = float(re.search(r"largest \|F\| = ([\d.]+) N", tip)[1])
    assert f"largest |F| {peak:.3g} N" in told
    assert browser.execute_script("return document.querySelector('.picked input').value") == "3"
    drawn = browser.execute_script("return document.querySelector('.picked svg path').getAttribute('d')")
    heights = np.array([float(word.split(" ")[1]) for word in drawn[1:].split("L")])
    assert heights[0] > heights[-1] + 50  # the body goes up the chart
    assert browser.execute_script("return document.querySelectorAll('.cell').length") >= 3  # in each map


@pytest.mark.pictures
def test_a_click_on_a_cell_that_was_not_kept_shows_the_nearest_cell(browser, tmp_path, monkeypatch):  # noqa: F811
    monkeypatch.setattr("stribeck.sweeps.page._PICKED", 9)
    grid = {
        "law.parameters.F_s": np.repeat(np.linspace(1.2, 1.8, 9), 9), "plant.mass": np.tile(np.linspace(0.5, 2.0, 9), 9)
    }  # fmt: skip
    found = stribeck.sweep(SCENARIO.with_changes({"solve.t_end": 0.5}), grid, tmp_path / "out", summary=True)
    page.write_sweep_page(found)
    browser.get((tmp_path / "out" / "_report" / "report.html").as_uri())
    maps = browser.execute_script(
        "return JSON.parse(document.querySelector('svg[aria-label=map]').dataset.axes).length"
    )
    assert browser.execute_script("return document.querySelectorAll('.kept').length") == 9 * maps
    browser.execute_script(
        "const svg = document.querySelector('svg[aria-label=map]'), [x, y, w, h] = JSON.parse(svg.dataset.axes)[0].box;"
        "const p = new DOMPoint(x + w * 0.95, y + h * 1.5 / 9).matrixTransform(svg.getScreenCTM());"
        "svg.dispatchEvent(new MouseEvent('click', {bubbles: true, clientX: p.x, clientY: p.y}));"
    )
    told = browser.execute_script("return document.querySelector('.picked span').textContent")
    assert told.startswith(
        "law.parameters.F_s = 1.8 N, plant.mass = 2 kg:"
    )  # lane 80; by its number 76 would be next to 79
    assert told.endswith("(lane 80, the one kept here that is next to 79: dots mark those kept)")
    assert not browser.get_log("browser")
