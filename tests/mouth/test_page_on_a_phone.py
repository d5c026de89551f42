"""A page on a screen as narrow as a phone's: one column, in which what is wide scrolls by itself."""

import html
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import pytest

from stribeck import examples, mouth
from stribeck.loops import design
from stribeck.mouth import plots
from stribeck.mouth.document import Chapter, Document, Figure
from stribeck.mouth.page import write

PHONE = 390  # pixels
STYLE = re.search(r"<style>(.*?)</style>", (Path(mouth.__file__).parent / "page.html").read_text(), re.S)[1]
CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
pytestmark = pytest.mark.pictures


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A design: figures of two panels, tables of many columns, code."""
    document = design(examples.path("axis_hunts")).document()
    return write(document, tmp_path_factory.mktemp("page"), pictures=False)[-1].read_text()


class Wide(HTMLParser):
    """Where the tables, pictures and lines of code of a page lie: the classes about each."""

    def __init__(self):
        super().__init__()
        self.about, self.found = [], []

    def handle_starttag(self, tag, attributes):
        if tag in ("table", "svg", "pre"):
            self.found.append((tag, [name for names in self.about for name in names]))
        if tag in ("div", "figure", "section"):
            self.about.append((dict(attributes).get("class") or "").split())

    def handle_endtag(self, tag):
        if tag in ("div", "figure", "section"):
            self.about.pop()


@pytest.mark.thorough
def test_what_is_wide_scrolls_by_itself(page):
    assert ".scroll { overflow-x: auto; }" in STYLE
    assert '<meta name="viewport" content="width=device-width' in page
    wide = Wide()
    wide.feed(page)
    assert {tag for tag, _ in wide.found} >= {"table", "svg"}
    assert [tag for tag, about in wide.found if "scroll" not in about] == []


def in_a_browser(page, folder, script):
    """The text to which a script on the page, on a narrow screen, evaluates; ``d`` is the page's document."""
    outer = folder / "outer.html"
    outer.write_text(
        f'<iframe width="{PHONE}" height="800" srcdoc="{html.escape(page)}"></iframe><script>'
        f"onload = () => {{ const d = document.querySelector('iframe').contentDocument; {script} }};</script>"
    )
    words = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--dump-dom"]
    shown = subprocess.run([*words, outer.as_uri()], capture_output=True, text=True, timeout=120, check=True).stdout
    return re.search(r"<title>(.*?)</title>", shown)[1]


@pytest.mark.thorough
@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
def test_a_browser_makes_one_column(page, tmp_path):
    title = in_a_browser(
        page,
        tmp_path,
        "const left = [...d.querySelectorAll('section')].map(e => Math.round(e.getBoundingClientRect().left));"
        "const wide = [...d.querySelectorAll('figure svg')].filter(e => e.clientWidth > e.closest('.scroll').clientWidth);"
        "const e = d.querySelector('figure svg[data-axes]'), r = e.getBoundingClientRect();"
        "const at = { clientX: r.left + 0.6 * r.width, clientY: r.top + 0.9 * r.height };"
        "e.dispatchEvent(new PointerEvent('pointermove', at));"
        "const read = [...d.querySelectorAll('.tip div')].map(e => e.textContent).join(', ');"
        "const sizes = [d.documentElement.scrollWidth, left.length, new Set(left).size, wide.length];"
        "document.title = `${sizes.join(' ')} | ${read}`;",
    )
    sizes, read = re.fullmatch(r"([\d ]+) \| (.*?)", title).groups()
    width, sections, columns, scrolled = map(int, sizes.split())
    assert width <= PHONE
    assert sections > 2
    assert columns == 1
    assert scrolled == 0  # a figure of two columns has one here
    assert re.search(r"^time = [\d.]+ s, error = ", read), read  # of the lowest panel, which stood on the right


@pytest.mark.thorough
@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
@pytest.mark.parametrize("layout", ["abcd efgh", "aab", "aaa bbb cde", "aab cde"])
def test_panels_of_many_columns_stand_below_each_other(layout, tmp_path):
    def draw():
        figure, axes = plots.figure([list(row) for row in layout.split()], 4.0)
        for name, axis in axes.items():
            axis.plot([0, 1], [0, 1])
            axis.set(xlabel="time (s)", ylabel=f"{name} (mm)", title=name)
        return figure

    document = Document("many", "", [], [Chapter("plots", "Plots", figures=[Figure("plots", "Plots.", draw)])])
    page = write(document, tmp_path, pictures=False)[-1].read_text()
    title = in_a_browser(
        page,
        tmp_path,
        "const e = d.querySelector('figure svg');"
        "const boxes = [...e.querySelectorAll('g[id*=\"-axes_\"]')].map(g => g.querySelector('path').getBoundingClientRect());"
        "boxes.sort((a, b) => a.top - b.top);"
        "const beside = boxes.filter((b, i) => i && b.top < boxes[i - 1].bottom).length;"
        "const words = [...e.querySelectorAll('g[id*=\"-axes_\"] text')].filter(t => t.textContent === 'time (s)');"
        "const size = t => { const r = t.getBoundingClientRect(); return `${Math.round(r.width)} ${Math.round(r.height)}`; };"
        "const over = e.clientWidth - e.closest('.scroll').clientWidth, sizes = new Set(words.map(size));"
        "document.title = `${boxes.length} ${beside} ${over} ${words.length} ${sizes.size}`;",
    )
    panels, beside, over, labels, sizes = map(int, title.split())
    assert panels == labels == len(set(layout) - {" "})
    assert sizes == 1, "letters of one size, also of a panel that is squeezed"
    assert beside == 0
    assert over <= 0
