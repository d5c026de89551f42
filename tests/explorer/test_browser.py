"""The page in a real browser."""

import json
import shutil
import time
import tomllib

import numpy as np
import pytest

from stribeck import Scenario, simulate

webdriver = pytest.importorskip("selenium.webdriver")
CHROMIUM, DRIVER = shutil.which("chromium") or shutil.which("google-chrome"), shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="Chromium and chromedriver are not installed")


@pytest.fixture(scope="module")
def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for word in (
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-dev-shm-usage",
        "--window-size=1280,1000",
    ):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    result = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    yield result
    result.quit()


@pytest.fixture
def page(browser, built):
    browser.get("about:blank")
    browser.get(built.as_uri())
    settle(browser)
    return browser


def settle(browser):
    """Wait until the page shows the present setting."""
    until = time.monotonic() + 60
    while not browser.execute_script("return window.stribeck?.result && window.stribeck.idle"):
        assert time.monotonic() < until, browser.execute_script("return document.body.innerText")[:500]
        time.sleep(0.02)


def slide(browser, path, share):
    """Move a slider as a hand does."""
    browser.execute_script(
        "const s = document.querySelector(`input[type=range][data-path='${arguments[0]}']`);"
        "s.value = arguments[1]; s.dispatchEvent(new Event('input', {bubbles: true}));", path, round(1000 * share)
    )  # fmt: skip
    settle(browser)


def value(browser, path):
    return float(browser.execute_script(f"return document.getElementById('n-{path}').value"))


def same_as_run(browser, scenario):
    solution = simulate(scenario)
    for name, peak in solution.peaks.items():
        shown = np.array(browser.execute_script(f"return Array.from(window.stribeck.result.columns['{name}'])"))
        assert np.max(abs(shown - solution[name])) <= 1e-9 * peak, name
    reported = browser.execute_script("return window.stribeck.result.events")
    slips = [t for t, what in reported if not what & 1]
    assert slips == pytest.approx(solution.events["slip"].tolist(), abs=1e-6)


def test_a_slider_moves_the_numbers_of_run(page, scenario):
    same_as_run(page, scenario)
    before = page.find_element("id", "status").text
    slide(page, "law.parameters.F_s", 0.6)
    assert value(page, "law.parameters.F_s") == pytest.approx(1.5 * 10**0.2, rel=1e-3)
    same_as_run(page, scenario.with_changes({"law.parameters.F_s": value(page, "law.parameters.F_s")}))
    assert page.find_element("id", "status").text != before
    assert [e for e in page.get_log("browser") if e["level"] == "SEVERE"] == []
    assert page.execute_script("return performance.getEntriesByType('resource').map(e => e.name)"
                               ".filter(name => !name.startsWith('blob:'))") == []  # fmt: skip


def test_a_chart_tells_its_values_by_keyboard(page, scenario):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    page.execute_script("document.getElementById('link').focus()")
    inner = "let e = document.activeElement; while (e.shadowRoot?.activeElement) e = e.shadowRoot.activeElement;"
    for _ in range(80):
        ActionChains(page).send_keys(Keys.TAB).perform()
        if "bk-events" in page.execute_script(f"{inner} return e.className"):
            break
    assert "the arrow keys tell values" in page.execute_script(f"{inner} return e.getAttribute('aria-label')")
    ActionChains(page).send_keys(Keys.END).perform()
    last = simulate(scenario)
    assert page.find_element("id", "reading").text == (
        f"t {last.t[-1]:.3g} s: y position {last['y'][-1]:.3g} m, x spring's end {last['x'][-1]:.3g} m"
    )
    ActionChains(page).key_down(Keys.SHIFT).send_keys(Keys.ARROW_LEFT * 100).key_up(Keys.SHIFT).perform()
    reported = page.find_element("id", "reading").text
    assert reported.startswith(f"t {last.t[-101]:.3g} s: y position {last['y'][-101]:.3g} m")
    ActionChains(page).send_keys(Keys.ESCAPE).perform()
    assert not page.find_element("id", "reading").is_displayed()
    assert [e for e in page.get_log("browser") if e["level"] == "SEVERE"] == []


def test_the_page_says_what_to_drag(page):
    assert "Try F_s" in page.find_element("id", "measured").text


def test_a_machine_moves_with_its_numbers(browser, tmp_path):
    from stribeck import examples
    from stribeck.explorer import explore

    scenario = Scenario.load(examples.path("belt"), {"solve.rtol": 1e-10, "solve.t_end": 2.0})
    browser.get(explore(scenario, tmp_path / "belt.html").as_uri())
    settle(browser)
    path = "contacts.sole.law.parameters.F_s"
    slide(browser, path, 0.55)
    assert value(browser, path) > 6.0
    solution = simulate(scenario.with_changes({path: value(browser, path)}))
    for name, peak in solution.peaks.items():
        shown = np.array(browser.execute_script(f"return Array.from(window.stribeck.result.columns['{name}'])"))
        assert np.max(abs(shown - solution[name])) <= 1e-9 * peak, name
    reported = browser.execute_script("return ['slip', 'stick'].map(k => happened(window.stribeck.result, 'sole', k))")
    for times, kind in zip(reported, ("slip", "stick"), strict=True):
        assert times == pytest.approx(solution.events["sole"][kind].tolist(), abs=1e-6)
    browser.execute_script("window.stribeck.set(arguments[0], 1.0)", path)
    settle(browser)
    assert browser.find_element("id", "problem").text == f"{path}: 1: must be at least F_c"
    browser.execute_script("window.stribeck.set('bodies.slider.mass', 1e3)")
    assert "bodies.slider.mass: 1000: must be from 0.1 to 10 kg" in browser.find_element("id", "problem").text
    browser.find_element("id", "reset").click()
    settle(browser)
    slide(browser, "links.spring.stiffness", 0.6)
    browser.find_element("id", "toml").click()
    (tmp_path / "mine.toml").write_text(browser.execute_script("return window.stribeck.copied"))
    copied = Scenario.load(tmp_path / "mine.toml")
    assert copied.elements.values["links.spring", "stiffness"] == value(browser, "links.spring.stiffness") != 400.0
    assert [e for e in browser.get_log("browser") if e["level"] == "SEVERE"] == []


def test_what_is_copied_runs_again(page, scenario, tmp_path):
    page.find_element("css selector", "option[value=elastoplastic]").click()
    settle(page)
    slide(page, "plant.mass", 0.55)
    page.find_element("id", "toml").click()
    (tmp_path / "mine.toml").write_text(page.execute_script("return window.stribeck.copied"))
    copied = Scenario.load(tmp_path / "mine.toml")
    assert copied.law.name == "elastoplastic"
    assert copied.elements.mass == value(page, "plant.mass") != 1.0
    assert tomllib.loads((tmp_path / "mine.toml").read_text())["solve"]["rtol"] == scenario.solve.rtol
    same_as_run(page, copied)
    link = page.current_url
    page.get("about:blank")
    page.get(link)
    settle(page)
    same_as_run(page, copied)
    page.find_element("id", "reset").click()
    settle(page)
    same_as_run(page, scenario)


def test_passivity_follows_the_numbers_and_bad_ones_are_named(page):
    def passive():
        return page.execute_script("return document.querySelector('[data-claim=passive]').dataset.holds")

    assert passive() == "no"  # sigma_2 F_c < sigma_1 (F_s - F_c)
    field = page.find_element("id", "n-law.parameters.sigma_2")
    field.clear()
    field.send_keys("200")
    settle(page)
    assert passive() == "yes"
    assert "200" in page.find_element("id", "equations").text
    rows = page.execute_script("return window.stribeck.result.rows")
    page.execute_script("window.stribeck.set('law.parameters.F_s', 0.5)")
    settle(page)
    assert page.find_element("id", "problem").text == "F_s: 0.5: must be at least F_c"
    page.execute_script("window.stribeck.set('plant.mass', -1)")
    assert page.find_element("id", "problem").text == "plant.mass: -1: must be > 0 kg"
    assert page.execute_script("return window.stribeck.result.rows") == rows


def test_a_long_run_shows_its_progress_and_can_be_left(page):
    page.execute_script("window.stribeck.set('solve.t_end', 40000); window.stribeck.set('output.step', 1)")
    until = time.monotonic() + 20
    while not page.execute_script("return !document.getElementById('progress').hidden"):
        assert time.monotonic() < until
        time.sleep(0.02)
    page.find_element("id", "reset").click()
    settle(page)
    assert page.execute_script("return window.stribeck.result.columns.t.at(-1)") == pytest.approx(40.0)


def test_what_a_link_sets_is_in_sight_and_stick_slip_begins_as_F_s_is_dragged(browser, built):
    browser.get("about:blank")
    browser.get(f"{built.as_uri()}#law.parameters.F_s=1")
    settle(browser)
    low, high = browser.execute_script(
        "const r = (e) => e.getBoundingClientRect(), box = r(document.getElementById('controls'));"
        "const at = r(document.getElementById('n-law.parameters.F_s')); return [at.top - box.top, box.bottom - at.bottom]"
    )
    assert min(low, high) > 0
    assert "stick" not in browser.find_element("id", "status").text
    slide(browser, "law.parameters.F_s", 0.55)
    assert browser.find_element("id", "status").text.startswith("Sticks and slips")


def test_a_ghost_stays(page):
    page.find_element("id", "keep").click()
    slide(page, "law.parameters.F_s", 0.6)
    ghost, now = (
        page.execute_script(f"return Array.from(model('position-{which}').data.y)") for which in ("ghost", "now")
    )
    assert len(ghost) == len(now)
    assert not np.allclose(ghost, now)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 390])
def test_nothing_sticks_out_on_a_desk_or_a_phone(page, tmp_path, width, scheme):
    features = [{"name": "prefers-color-scheme", "value": scheme}]
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    page.refresh()
    settle(page)
    shot = page.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})
    assert len(json.dumps(shot)) > 20_000
    assert page.execute_script("return document.documentElement.scrollWidth") <= width
    light = page.execute_script("return getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert light is (scheme == "light")
    assert page.execute_script("return [...document.querySelectorAll('.chart')].every(c => c.clientWidth > 250)")
    page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


_MOVING = """
const [path, at, done] = arguments, before = window.stribeck.result;
const slider = document.querySelector(`input[type=range][data-path='${path}']`);
const wait = () => {
  if (window.stribeck.result === before) { setTimeout(wait); return; }
  clearTimeout(waiting.timer);  // the hand does not rest
  setTimeout(() => done(window.stribeck.result.rows), 150);
};
slider.value = at;
slider.dispatchEvent(new Event("input", { bubbles: true }));
wait();
"""


def move(browser, path, share):
    """Move a slider, and stop the page before it takes the hand for resting."""
    return browser.execute_async_script(_MOVING, path, round(1000 * share))


_PIXELS = """
const [name, column] = arguments, figure = model(name), canvas = boards.get(name), list = window.stribeck.result.columns[column];
const most = list.reduce((best, x, i) => x > list[best] ? i : best, 0), step = value("output.step"), [, yf] = scaled.get(name);
const zoom = canvas.width / canvas.clientWidth, share = (range, x) => (x - range.start) / (range.end - range.start);
const x = share(figure.x_range, most * step) * canvas.width, y = (1 - share(figure.y_range, list[most] / yf)) * canvas.height;
const found = canvas.getContext("2d").getImageData(Math.round(x) - 3, Math.round(y) - 3, 7, 7).data, colors = [];
for (let i = 0; i < found.length; i += 4) colors.push([found[i], found[i + 1], found[i + 2]]);
return { inside: y >= 0 && y <= canvas.height, colors, hidden: canvas.hidden };
"""


def test_curves_follow_a_slider_that_does_not_rest_and_the_charts_follow_when_it_does(page):
    old = page.execute_script("return Array.from(model('velocity-now').data.v)")
    for share in (
        0.53,
        0.56,
        0.58,
        0.6,
        0.6,
        0.6,
        0.601,
        0.602,
        0.603,
    ):  # to 1.6 times the peak; axes follow one by one
        move(page, "law.parameters.F_s", share)
    result = page.execute_script(_PIXELS, "velocity", "v")
    assert result["inside"]
    assert not result["hidden"]
    assert any(abs(r - 0x1B) < 60 and abs(g - 0x87) < 60 and abs(b - 0xC9) < 60 for r, g, b in result["colors"])
    page.execute_script("draw(window.stribeck.result)")
    settle(page)
    time.sleep(0.3)
    factor = page.execute_script("return scaled.get('velocity')[1]")
    shown = np.array(page.execute_script("return Array.from(model('velocity-now').data.v)")) * factor
    assert shown.tolist() == pytest.approx(page.execute_script("return Array.from(window.stribeck.result.columns.v)"))
    assert max(shown) > 1.2 * max(old) * 1e-3
    assert page.execute_script("return [...boards.values()].every(each => each.hidden)")


def test_a_hand_that_rests_has_each_chart_painted_once_and_keeps_the_legends(page):
    page.execute_script(
        "window.painted = {}; for (const name of Object.keys(data.panels)) { const view = Bokeh.index.find_one(model(name));"
        "const paint = view._actual_paint; view._actual_paint = function () {"
        "  window.painted[name] = (window.painted[name] ?? 0) + 1; return paint.call(this); }; }"
        "const legend = model('position').above[0];"
        "window.items = Bokeh.index.find_one(model('position')).views.find_one(legend).entries.map(e => e.el);"
    )
    slide(page, "law.parameters.F_s", 0.6)
    time.sleep(0.5)
    painted = page.execute_script("return window.painted")
    assert set(painted) == set(page.execute_script("return Object.keys(data.panels)"))
    assert set(painted.values()) <= {1, 2}
    assert list(painted.values()).count(2) <= 1  # the one whose axes followed meanwhile
    assert page.execute_script("return window.items.length && window.items.every(e => e.isConnected)")


def test_a_zoomed_chart_keeps_its_axes_while_a_slider_moves(page):
    page.execute_script(
        "const r = model('velocity').y_range; r.have_updated_interactively = true; r.setv({start: 0, end: 1});"
    )
    time.sleep(0.3)
    move(page, "law.parameters.F_s", 0.6)
    assert page.execute_script("return misfit('velocity', window.stribeck.result)") == 0
    assert page.execute_script("return model('velocity').y_range.end") == 1


@pytest.mark.thorough
def test_many_rows_are_thinned_while_a_slider_moves_and_whole_when_it_rests(page):
    page.execute_script("window.stribeck.set('output.step', 0.001)")
    settle(page)
    whole, drawn = page.execute_script(
        "const found = [], keep = (...p) => found.push(p), pen = { moveTo: keep, lineTo: keep, beginPath() {}, stroke() {} };"
        "const { t, F } = window.stribeck.result.columns, glyph = { line_alpha: 1, line_color: 'red', line_width: 1 };"
        "line(pen, [t, F], [x => 20 * x, x => 100 * x], glyph); return [Array.from(F), found];"
    )
    whole, drawn = np.array(whole), np.array(drawn)
    at = 20 * 0.001 * np.arange(len(whole))
    assert len(whole) == 40001 > 3 * len(drawn)
    last = np.searchsorted(drawn[:, 0], at * (1 + 1e-12), side="right") - 1
    assert np.max(abs(at - drawn[last, 0])) <= 1.0001
    assert np.max(abs(100 * whole - drawn[last, 1])) <= 1.0001
    assert page.execute_script("return model('position-now').data.y.length") == len(whole)


@pytest.mark.thorough
def test_legends_keep_their_place_when_light_becomes_dark(page):
    places = (
        "return Object.keys(data.panels).flatMap(name => { const view = Bokeh.index.find_one(model(name));"
        "return model(name).above.map(each => view.views.find_one(each).el.getBoundingClientRect().right); })"
    )
    page.execute_cdp_cmd(
        "Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "light"}]}
    )
    time.sleep(0.5)
    before = page.execute_script(places)
    page.execute_cdp_cmd(
        "Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark"}]}
    )
    time.sleep(0.5)
    assert page.execute_script(places) == before
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
