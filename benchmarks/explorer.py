"""The explorer: from a slider's event to the curves in sight redrawn, for 40 s of stick-slip in a headless Chromium.

Each drag moves F_s to another place and waits until a canvas over every chart in sight has been drawn anew and the frame
with it is done. ``solved`` is when the worker's result is back; both count from the slider's event, on the wall.
Where other processes are at work, the processor time of the page's main thread up to then says more.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import Any

from measure import Given, run, spread

from stribeck import Scenario, examples
from stribeck.explorer import explore

_SIZES = {"desk, 1280 x 1000": (1280, 1000, False), "phone, 390 x 844": (390, 844, True)}

# Strokes tell which canvases were drawn, and when: a drag is over when all in sight have had theirs.
_WATCH = """
const stroke = CanvasRenderingContext2D.prototype.stroke;
window.drawn = new Map();
CanvasRenderingContext2D.prototype.stroke = function (...given) {
  window.drawn.set(this.canvas, performance.now());
  return stroke.apply(this, given);
};
"""
_DRAG = """
const [share, done] = arguments;
const slider = document.querySelector("input[type=range][data-path='law.parameters.F_s']");
const charts = Object.keys(data.panels).map((name) => Bokeh.index.find_one(model(name)).el.getBoundingClientRect())
  .filter((r) => r.bottom > 0 && r.top < innerHeight);
const found = { solved: 0, drawn: 0, charts: charts.length }, begun = performance.now(), until = begun + 3000;
const heard = (event) => { if (event.data.result) found.solved ||= event.timeStamp - begun; }; // the page hears it first
worker.addEventListener("message", heard);
window.drawn.clear();
const look = () => {
  const places = [...window.drawn].filter(([, at]) => found.solved && at >= begun + found.solved)
    .map(([canvas]) => canvas.getBoundingClientRect());
  const anew = (chart) => places.some((r) => r.left >= chart.left - 1 && r.right <= chart.right + 1
    && r.top >= chart.top - 1 && r.bottom <= chart.bottom + 1);
  if (charts.every(anew)) found.drawn = performance.now() - begun;
  if (found.drawn || performance.now() > until) {
    worker.removeEventListener("message", heard);
    done(found);
    return;
  }
  requestAnimationFrame(() => { const c = new MessageChannel(); c.port1.onmessage = look; c.port2.postMessage(0); });
};
slider.value = share;
slider.dispatchEvent(new Event("input", { bubbles: true }));
look();
"""

_SETTLED = """
const done = arguments[0], look = () => window.stribeck?.idle && window.stribeck.result ? done() : setTimeout(look, 20);
look();
"""


def drags(page: Path, size: tuple[int, int, bool], repetitions: int) -> dict[str, Any]:
    """The times of one window, in ms."""
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or shutil.which("google-chrome") or ""
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
        options.add_argument(word)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver")))
    try:
        width, height, mobile = size
        shape = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile}
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", shape)
        driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": _WATCH})
        driver.set_script_timeout(60)
        driver.get(page.as_uri())
        driver.execute_async_script(_SETTLED)
        places = [560 + 20 * (i % 10) for i in range(repetitions)]

        def drag(place: int) -> dict[str, float]:
            result: dict[str, float] = driver.execute_async_script(_DRAG, place)
            driver.execute_async_script(_SETTLED)
            return result

        for warm in (600, 550, 580):
            drag(warm)
        result = [drag(place) for place in places]
        if not all(each["drawn"] and each["charts"] for each in result):
            raise SystemExit("the page was not redrawn after a drag")
    finally:
        driver.quit()
    return {
        "charts": result[0]["charts"],
        "solved_ms": spread([each["solved"] for each in result]),
        "drawn_ms": spread([each["drawn"] for each in result]),
    }


def benchmark(given: Given) -> dict[str, Any]:
    """Every size of window."""
    with tempfile.TemporaryDirectory() as folder:
        page = explore(Scenario.load(examples.path("stick_slip")), Path(folder) / "page.html", ())
        cases = {name: drags(page, size, given.repetitions) for name, size in _SIZES.items()}
    return {"benchmark": "the explorer", "cases": cases}


if __name__ == "__main__":
    run(benchmark, __doc__, "explorer", repetitions=(20, 3))
