"""A user's words on a terminal and on pages: one line each, and nothing that a terminal obeys or a page turns round."""

import json
from html import unescape

import pytest

from stribeck.errors import printable, unbroken
from stribeck.explorer import explore
from stribeck.mouth import page, plots, terminal
from stribeck.mouth.document import Amount, Chapter, Document, Figure, Head, Table
from stribeck.scenario import Scenario
from tests.cli.conftest import stribeck  # noqa: F401
from tests.simulation.rig import needs_compiler

HOSTILE = "\x1b[31m\u202e\u2066\u2028\u2029\x85\x9b\x00\x7f\u200f\u00ad\ufeff\ud800"
SHOWN = r"\x1b[31m\u202e\u2066\u2028\u2029\x85\x9b\x00\x7f\u200f\xad\ufeff\ud800"


def plain(text):
    """Whether a text has printable characters and line feeds alone."""
    return printable(text, but="\n") == text


def document(words):
    def draw():
        figure, axes = plots.figure([["a"], ["b"]], 6.0)
        plots.line(axes["a"], 0, [0, 1], [0, 1], words)
        axes["a"].set(title=words, xlabel=words, ylabel=words)
        axes["b"].text(0, 0, words)
        plots.legend(figure, axes["a"])
        return figure

    table = Table([words, Head(words, 3), "unit", "meaning"], [[words, Amount(1.0, words), words, words]])
    chapter = Chapter(
        "k", words, [words], [table, Table([words, words], [[words, words]], prose=True)],
        [Figure("drawn", words, draw)], facts=[words], code=f"{HOSTILE}\nsecond line", headed=True,
    )  # fmt: skip
    return Document(words, words, [words], [chapter], (words, words))


def test_words_are_on_one_line_and_the_rest_is_escaped():
    assert printable("a b\u00e9\n") == "a b\u00e9\\n"
    assert printable("a\nb\t", but="\n") == "a\nb\\t"
    assert unbroken("  two\n\t lines \r\n") == "two lines"
    assert unbroken(HOSTILE) == SHOWN


def test_a_terminal_gets_nothing_that_it_obeys():
    lines = list(terminal.lines(document(f"one {HOSTILE}\n\ntwo"), [HOSTILE]))
    assert all(map(str.isprintable, lines))
    assert sum(line.count(SHOWN) for line in lines) >= 12
    assert len(lines) == len(list(terminal.lines(document(f"one {SHOWN} two"), [SHOWN])))


@pytest.mark.pictures
def test_a_page_and_its_figures_show_what_could_turn_it_round(tmp_path):
    paths = page.write(document(f"one {HOSTILE}\ntwo"), tmp_path, SHOWN)
    assert [path.name for path in paths] == ["drawn.svg", "report.html"]
    for path in paths:
        text = path.read_text(encoding="utf-8")
        assert plain(text)
        assert SHOWN in text
    whole = paths[-1].read_text(encoding="utf-8")
    assert "\nsecond line</code>" in whole
    assert whole.count(SHOWN) >= 20


@pytest.mark.pictures
def test_a_label_that_begins_with_an_underscore_is_kept():
    with plots.style():
        figure, axes = plots.figure([["a"]], 2.0)
        plots.line(axes["a"], 0, [0, 1], [0, 1], "_hidden")
        plots.legend(figure, axes["a"])
        text = plots.svg(figure)
    assert ">_hidden<" in text
    assert plain(text)


LAW = """
from stribeck.constants import Constant
from stribeck.laws import StaticLaw


class Mine(StaticLaw):
    {words}
    name = {words}
    source = {words}
    c = Constant({words}, {words}, at_least=0)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.c * v
"""

RIG = """
schema = 1
name = {words}
law = {{ name = "mine.py:Mine", c = 2.0 }}
plant.mass = 1.0
drive = {{ kind = "force", signal = {{ kind = "sine", amplitude = 1.0, frequency = 1.0 }} }}
solve.t_end = 0.1
output.step = 0.01
"""


@pytest.fixture
def rig(tmp_path):
    """A scenario and a law of a user's file, every text of which is hostile."""
    words = HOSTILE.replace("\ud800", "") + "\nline"
    (tmp_path / "mine.py").write_text(LAW.format(words=ascii(words)))
    (tmp_path / "rig.toml").write_text(RIG.format(words=json.dumps(words).replace("\\u007f", "\\u007F")))
    return tmp_path / "rig.toml"


@needs_compiler
@pytest.mark.pictures
@pytest.mark.parametrize(
    "words",
    [("library", "mine.py:Mine"), ("run", "rig.toml", "--out", "out"), ("run", "rig.toml", "--show"),
     ("check", "mine.py:Mine", "--set", "c=2", "--out", "out"), ("run", "rig.toml", "--set", "law.c=-1"),
     ("run", "rig.toml", "--set", "solve.max_steps=1"),
     ("run", "rig.toml", "--law", "dahl:sigma_0=1e4,F_c=1", "--law", "mine.py:Mine:c=3")],
    ids=" ".join,
)  # fmt: skip
def test_a_users_law_and_scenario_are_shown_escaped(words, stribeck, rig, monkeypatch):  # noqa: F811
    monkeypatch.chdir(rig.parent)
    monkeypatch.setattr("sys.argv", ["stribeck", *words, HOSTILE])  # the page says the command
    outcome = stribeck(*words)
    assert outcome.status == {"law.c=-1": 2, "solve.max_steps=1": 1}.get(words[-1], 0), outcome.err
    assert plain(outcome.out)
    assert plain(outcome.err)
    for path in [*(rig.parent / "out").glob("*.[sht][vtmo][gml]*"), *rig.parent.glob("*.c")]:
        assert plain(path.read_text(encoding="utf-8")), path


@needs_compiler
def test_the_explorer_shows_them_escaped(rig):
    pytest.importorskip("bokeh")
    text = explore(Scenario.load(rig), rig.parent / "page.html", law=[]).read_text(encoding="utf-8")
    assert plain(text)


def test_rows_that_do_not_fold_take_the_terminal_and_words_fold_at_a_hundred(monkeypatch):
    wide = Table(["name", *"abcdef", "state"], [["n" * 30, *["1234567890123"] * 6, "identified"]])
    prose = Table(["name", "how"], [["n", "word " * 60]])
    shown = Document("t", "lead", [], [Chapter("k", "K", [], [wide]), Chapter("l", "L", [], [prose])])
    for columns, above in ((160, False), (100, True)):
        monkeypatch.setenv("COLUMNS", str(columns))
        lines = list(terminal.lines(shown))
        assert any(line.strip() == "n" * 30 for line in lines) == above
        assert max(len(line) for line in lines if "word" in line) <= 100


def test_a_sentence_keeps_the_name_that_it_begins_with(tmp_path):
    words = ("overcompensated.toml replays it", "lugre_majorant with sigma_0 = 1 N/m", "quiet from here")
    page.write(Document("t", "lead", words, []), tmp_path, pictures=False)
    text = unescape((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert "overcompensated.toml replays it." in text
    assert "lugre_majorant with" in text
    assert "Quiet from here." in text


def test_a_page_that_cannot_be_written_is_an_error(tmp_path, monkeypatch):
    def full(path, text):
        path.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(page, "write_text", full)
    with pytest.raises(OSError, match="No space left"):
        page.write(document("one"), tmp_path, pictures=False)
    assert not list(tmp_path.iterdir())
