"""A click on a cell of a sweep's page, in a real browser."""

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
    browser.execute_script(
        "document.querySelector(\"[id='map-lane-3']\").dispatchEvent(new MouseEvent('click', {bubbles: true}))"
    )
    assert browser.execute_script(about) == "law.parameters.F_s = 1.5, plant.mass = 2"
    assert browser.execute_script("return document.querySelector('.picked input').value") == "3"
    drawn = browser.execute_script("return document.querySelector('.picked svg path').getAttribute('d')")
    heights = np.array([float(word.split(" ")[1]) for word in drawn[1:].split("L")])
    assert heights[0] > heights[-1] + 50  # the body goes up the chart
    chosen = browser.execute_script(
        "return [...document.querySelectorAll('.chosen')].map(e => e.id.split('-lane-').pop())"
    )
    assert set(chosen) == {"3"}
