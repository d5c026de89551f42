"""How the documentation reads: the length of its sentences, its words, its length, its figures."""

import re
import statistics
from pathlib import Path

import pytest
import typer

from stribeck.cli.app import app
from stribeck.cli.options import ADVANCED

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = sorted(p for p in DOCS.rglob("*.md") if "made" not in p.parts)
# Words of everyday speech for which the field has a term (the guide's table), as whole phrases.
AVOIDED = (
    "is told", "are told", "not told", "untold", "what is missed", "the fit misses", "beyond chance", "told apart",
    "stand for each other", "comes to rest", "come to rest", "stands off", "end of what is tried", "where the search last stood",
    "what pushes", "is refused", "are refused", "refuses", "such a one", "that which", "what more is wanted",
    "beside and renamed", "what is found", "data left out", "another motion that", "coarse scale", "slower clock",
)  # fmt: skip


def sentences(text):
    """The sentences of a page of Markdown as lists of words; code, formulas, tables' rules and headings are left out."""
    text = re.sub(r"```.*?```|<!--.*?-->|\$\$.*?\$\$", " . ", text, flags=re.S)
    lines = []
    for line in text.splitlines():
        bare = line.strip()
        if not bare or re.match(r"^\|?[\s:|-]+\|?$", bare) or bare.startswith("#") or line.startswith("    "):
            lines.append(" . ")
        elif bare.startswith("|"):
            lines.append(" . " + bare.strip("|").replace("|", " . ") + " . ")
        else:
            lines.append(re.sub(r"^([-*+]|\d+\.)\s+", " . ", bare))
    text = re.sub(r"`[^`]*`|\$[^$]*\$|!?\[([^\]]*)\]\([^)]*\)|https?://\S+", lambda m: m[1] or "X", " ".join(lines))
    text = re.sub(r"(\d)\.(\d)|\b(e\.g|i\.e|etc|vs|al)\.", r"\1\2\3", text)
    result = (re.findall(r"[^\W\d_][\w'-]*", each) for each in re.split(r"[.!?](?=\s|$)|\s[.:;]\s", text))
    return [words for words in result if len(words) >= 4]


def prose(page):
    return re.sub(r"```.*?```|`[^`]*`", " ", page.read_text(encoding="utf-8"), flags=re.S)


def test_sentences_are_short():
    lengths = [
        len(each) for page in (ROOT / "README.md", *PAGES) for each in sentences(page.read_text(encoding="utf-8"))
    ]
    assert statistics.mean(lengths) <= 15
    assert sum(n > 25 for n in lengths) <= 0.08 * len(lengths)
    assert sum(n > 35 for n in lengths) <= 0.01 * len(lengths)


def test_a_long_sentence_is_counted():
    assert [
        len(each) for each in sentences("One two three four. `code` " + "word " * 40 + ".\n\n# A heading of many words")
    ] == [4, 41]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_a_page_uses_the_field_s_words(page):
    text = " ".join(prose(page).lower().split())
    assert not [words for words in AVOIDED if re.search(rf"\b{words}\b", text)]


def test_help_shows_few_options_first_and_uses_the_field_s_words():
    texts = {}
    for name, command in typer.main.get_command(app).commands.items():
        options = [p for p in command.params if p.param_type_name == "option" and p.rich_help_panel != ADVANCED]
        assert len(options) <= 12, name
        texts[name] = " ".join(
            [command.help or "", *(p.help or "" for p in command.params if hasattr(p, "help"))]
        ).lower()
    assert not {n: w for n, text in texts.items() for w in AVOIDED if re.search(rf"\b{w}\b", text)}


def test_the_site_is_short():
    """Without blocks of code."""
    texts = (re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S) for page in PAGES)
    assert sum(len(text.split()) for text in texts) <= 28_000


@pytest.mark.parametrize("page", sorted((DOCS / "howto").glob("*.md")), ids=lambda p: p.stem)
def test_a_guide_is_short_and_has_a_figure(page):
    text = page.read_text(encoding="utf-8")
    assert 200 <= len(text.split()) <= 600
    assert re.search(r"!\[[^\]]+\]\([^)]+\.(svg|gif|png)\)|```\{explorer\}", text)


@pytest.mark.parametrize("page", sorted((DOCS / "tutorials").glob("*.md")), ids=lambda p: p.stem)
def test_a_tutorial_begins_with_a_picture(page):
    assert "![" in page.read_text(encoding="utf-8").split("##")[0]
