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
    assert ".scroll, nav ol { overflow-x: auto;" in STYLE
    assert '<meta name="viewport" content="width=device-width' in page
    wide = Wide()
    wide.feed(page)
    assert {tag for tag, _ in wide.found} >= {"table", "svg"}
    assert [tag for tag, about in wide.found if "scroll" not in about] == []


@pytest.mark.thorough
@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
def test_a_browser_makes_one_column(page, tmp_path):
    script = (
        "const left = [...d.querySelectorAll('section')].map(e => Math.round(e.getBoundingClientRect().left));"
        "document.title = [d.documentElement.scrollWidth, left.length, new Set(left).size].join(' ');"
    )
    outer = tmp_path / "outer.html"
    outer.write_text(
        f'<iframe width="{PHONE}" height="800" srcdoc="{html.escape(page)}"></iframe><script>'
        f"onload = () => {{ const d = document.querySelector('iframe').contentDocument; {script} }};</script>"
    )
    words = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--dump-dom"]
    shown = subprocess.run([*words, outer.as_uri()], capture_output=True, text=True, timeout=120, check=True).stdout
    width, sections, columns = map(int, re.search(r"<title>(.*?)</title>", shown)[1].split())
    assert width <= PHONE
    assert sections > 2
    assert columns == 1
