"""What the documentation's site shows: nothing is missing, every link leads somewhere, every example runs."""

import functools
import importlib
import inspect
import re
import runpy
import shlex
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
import typer

import stribeck
from stribeck.cli import _status
from stribeck.cli.app import app

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(p for p in DOCS.rglob("*.md") if "made" not in p.parts)
SCRIPTS = sorted((DOCS / "gallery").glob("*.py"))
NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))


def blocks(page, language):
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), re.S)


def anchors(page):
    heads = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).strip().replace(" ", "-") for head in heads}


# -- references ------------------------------------------------------------------------------------------------------


def test_every_public_name_stands_in_the_reference():
    page = (DOCS / "reference" / "python.md").read_text(encoding="utf-8")
    shown = re.findall(r"^\.\. auto\w+:: stribeck\.(\w+)((?:\.\w+)?)$", page, re.M)
    shown.remove(("loops", ".Design"))  # a result, as those with longer paths are
    assert sorted({name for name, _ in shown}) == sorted(stribeck.__all__)
    kinds = {each.__name__ for each in stribeck.signals.SignalTable.kinds.values()}
    assert {inner.lstrip(".") for name, inner in shown if name == "signals"} == kinds
    assert all(name == "signals" for name, inner in shown if inner)


@pytest.mark.parametrize("name", stribeck.__all__)
def test_an_entry_of_the_reference_is_whole(name):
    thing = getattr(stribeck, name)
    text = inspect.getdoc(thing) or ""
    assert text
    if inspect.isfunction(thing):
        assert "Raises:" in text, "which errors?"
        assert not (silent := [p for p in inspect.signature(thing).parameters if p not in text]), silent
    elif inspect.isclass(thing) and not issubclass(thing, BaseException):
        own = {n: m for n, m in vars(thing).items() if not n.startswith("_") and callable(getattr(thing, n, None))}
        assert not (silent := [n for n in own if not inspect.getdoc(getattr(thing, n))]), silent


def test_every_command_is_in_the_reference_with_all_its_options(monkeypatch):
    pytest.importorskip("sphinx")
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    from commands import reference

    result = reference()
    group = typer.main.get_command(app)
    assert set(result) == set(group.commands)
    for name, lines in result.items():
        assert lines[0][1], name
        assert lines[-1][1].startswith("Example"), name
        assert not (silent := [words for words, meaning in lines[1:-1] if not meaning]), (name, silent)
        written = " ".join(words for words, _ in lines)
        for p in group.commands[name].params:
            assert (
                p.name == "help"
                or getattr(p, "hidden", False)
                or max(p.opts, key=len) in written
                or p.metavar in written
            )


@pytest.mark.parametrize("part", ["elements", "signals", "drive", "solve,output"])
def test_every_key_of_a_file_has_a_meaning_and_a_default(part, monkeypatch):
    pytest.importorskip("sphinx")
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    from reference import tables

    rows = re.findall(r"^\| `(\S+)` \| (.*) \| (.*) \| (.*) \|$", "".join(tables(part)), re.M)
    assert rows
    assert not [row for row in rows if not row[1] or not row[3]]


def test_a_stated_default_moves_into_its_column(monkeypatch):
    pytest.importorskip("sphinx")
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    from reference import default_of

    assert default_of("backlash, m; 0 unless given", None) == ("backlash, m", "0")
    assert default_of("unit of the column; the file's, or SI, unless given", None)[1] == "the file's, or SI"
    assert default_of("relative tolerance", 1e-8)[1] == "1e-8"
    assert default_of("mass, kg", None) == ("mass, kg", "none")


def test_signatures_of_the_reference_are_those_that_one_writes(monkeypatch):
    pytest.importorskip("sphinx")
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    from signatures import of_table

    assert of_table(stribeck.Link).startswith("(name, start, end='ground', *, stiffness, damping=None")
    assert of_table(stribeck.Contact).startswith("(name, start, law, *")
    assert of_table(stribeck.signals.Sine) == "(amplitude, frequency, offset=0.0, phase=0.0)"


def test_no_property_of_the_reference_begins_like_a_type():
    """Napoleon takes 'WORDS: text' at the beginning of a property's docstring for a type."""
    page = (DOCS / "reference" / "python.md").read_text(encoding="utf-8")
    for path, members in re.findall(r"^\.\. autoclass:: (\S+)\n   :members: (.*)$", page, re.M):
        module, _, name = path.rpartition(".")
        kind = getattr(importlib.import_module(module), name)
        for member in members.split(", "):
            thing = inspect.getattr_static(kind, member)
            if isinstance(thing, property | functools.cached_property):
                assert ": " not in (inspect.getdoc(thing) or "").splitlines()[0], f"{path}.{member}"


def test_a_thumbnail_of_the_gallery_has_the_text_of_its_title(monkeypatch):
    backreferences = pytest.importorskip("sphinx_gallery.backreferences")
    pytest.importorskip("sphinx-mathjax-offline")
    monkeypatch.setattr(backreferences, "THUMBNAIL_TEMPLATE", backreferences.THUMBNAIL_TEMPLATE)
    runpy.run_path(str(DOCS / "conf.py"))
    words = {"tags": "", "intro": "", "thumbnail": "hunting.png", "doc_name": "hunting", "title": "Hunting: a loop"}
    assert ":alt: Hunting: a loop\n" in backreferences.THUMBNAIL_TEMPLATE.format(**words)


# -- links, blocks ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md"], ids=lambda p: p.stem)
def test_every_link_leads_somewhere(page):
    text = re.sub(r"```.*?```|`[^`]*`", "", page.read_text(encoding="utf-8"), flags=re.S)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"\w+:", target):
            continue
        path, _, anchor = target.partition("#")
        if re.match(r"(\.\./)?made/", path):  # the gallery's pages are made from its scripts
            name = path.rsplit("/", 1)[1]
            assert name == "index" or (DOCS / "gallery" / f"{name}.py").is_file(), target
            continue
        file = (page.parent / path) if path else page
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), target


def test_every_page_is_in_a_table_of_contents():
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    listed = {
        line.strip() for part in re.findall(r"```\{toctree\}\n(.*?)```", index, re.S) for line in part.splitlines()
    }
    missing = [
        p for p in PAGES if p.name != "index.md" and p.relative_to(DOCS).with_suffix("").as_posix() not in listed
    ]
    assert not missing, missing


def commands(page):
    lines = [line for block in blocks(page, "sh") for line in block.splitlines()]
    return [words for line in lines if (words := shlex.split(line, comments=True)) and words[0] == "stribeck"]


@pytest.mark.parametrize("page", [p for p in PAGES if commands(p)], ids=lambda p: p.stem)
def test_every_command_is_one_that_there_is(page):
    group = typer.main.get_command(app)
    for words in commands(page):
        command = group.commands[words[1]]
        command.make_context(words[1], list(words[2:]))  # unknown options and wrong values raise


@pytest.mark.parametrize("page", [p for p in PAGES if "evidence" not in p.parts], ids=lambda p: p.stem)
def test_every_option_in_a_sentence_is_one_that_there_is(page):
    group = typer.main.get_command(app).commands
    options = {name: {o for p in command.params for o in p.opts} for name, command in group.items()}
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
    assert not set(re.findall(r"(?<![\w-])--[a-z][\w-]*", text)) - set().union(*options.values())
    if page.stem == "fit-files":  # its table is that of the options of 'fit'
        listed = "".join(re.findall(r"^\| `--.*?\|", text, re.M))
        assert not set(re.findall(r"--[a-z][\w-]*", listed)) - options["fit"]
    for name, rest in re.findall(r"`stribeck (\w+)([^`]*)`", text):
        assert not set(re.findall(r"(?<![\w-])--[a-z][\w-]*", rest)) - options[name], f"stribeck {name}"


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p, "python")], ids=lambda p: p.stem)
def test_every_block_of_python_is_python_and_names_what_there_is(page):
    for block in blocks(page, "python"):
        compile(block, page.name, "exec")
        for alias in re.findall(r"^import stribeck as (\w+)$", block, re.M) or ["stribeck"]:
            for name in re.findall(rf"(?<![\w.]){alias}\.([a-z_A-Z]\w*)", block):
                known = name in (*stribeck.__all__, "__version__") or find_spec(f"stribeck.{name}")
                assert known, name


GUIDES = sorted([*(DOCS / "tutorials").glob("*.md"), *(DOCS / "howto").glob("*.md")])
SLOW = {
    "hunting", "joint", "fit-a-joint", "fit-a-log", "log-for-identification", "will-it-hunt", "prove-passive", "choose-kv",
}  # they fit, judge or prove  # fmt: skip


@pytest.mark.share(2)
@pytest.mark.parametrize(
    "page", [pytest.param(p, marks=[pytest.mark.thorough] * (p.stem in SLOW), id=p.stem) for p in GUIDES]
)
def test_a_guide_can_be_followed(page, tmp_path, monkeypatch, capfd):
    """Its files are written and its commands run in their order; they print what it shows, but for digits and spaces.

    A file's block begins with the file's name. A block of text that begins with a command is not run.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "110")
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    printed = ""
    for language, block in re.findall(r"^ *```(\w+)\n(.*?)^ *```", page.read_text(encoding="utf-8"), re.S | re.M):
        if named := re.match(r"# (\w+\.(?:py|toml))\n", block):
            Path(named[1]).write_text(block, encoding="utf-8")
        if language == "sh":
            for line in block.splitlines():
                words = shlex.split(line, comments=True)
                if words and words[0] == "stribeck":
                    assert _status(words[1:]) == 0, line
                elif words and words[0] != "pip":
                    if shutil.which("cc") is None:
                        pytest.skip("no C compiler")
                    subprocess.run(words, check=True)
        elif language == "text" and not re.match(r" *(stribeck|arm-none)", block):
            assert not (missing := [line for line in block.splitlines() if plain(line) not in printed]), missing
        elif language == "python" and ("import torch" not in block or find_spec("torch")):
            exec(compile(block, page.name, "exec"), {"__name__": page.stem})
        printed += plain(" ".join(capfd.readouterr()))


def plain(text):
    """Without what differs from run to run: numbers, and where lines are broken."""
    return " ".join(re.sub(r"[\d.]+(e[+-]?\d+)?", "#", text).split())


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_every_formula_can_be_shown(page):
    """By a reader of TeX other than the one that draws it on the site; and on one line, as a forge wants it."""
    pytest.importorskip("sphinx")
    from docutils.utils.math.latex2mathml import tex2mathml

    text = re.sub(r"```.*?```|`[^`]*`", "", page.read_text(encoding="utf-8"), flags=re.S)
    shown = re.findall(r"\$\$(.*?)\$\$", text, re.S)
    inline = re.findall(r"(?<!\\)\$([^$]+)\$", re.sub(r"\$\$.*?\$\$", "", text, flags=re.S))
    assert not [each for each in inline if "\n" in each or each != each.strip()]
    for each in (*shown, *inline):
        assert tex2mathml(each.strip(), as_block=each in shown), each


def test_the_figures_of_the_guides_are_drawn_by_their_script(tmp_path):
    """Each is there and on a page; one is drawn, and shows both laws."""
    pytest.importorskip("matplotlib")
    module = runpy.run_path(str(DOCS / "pictures" / "guides.py"))
    shown = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    for name in module["PICTURES"]:
        assert (DOCS / "pictures" / name).stat().st_size > 1000
        assert f"pictures/{name})" in shown, name
    module["draw_kv"](tmp_path / "kv.svg")
    drawn = (tmp_path / "kv.svg").read_text(encoding="utf-8")
    assert "lugre_sobczyk" in drawn
    assert "lugre_majorant" in drawn


# -- the gallery, notebooks, the site --------------------------------------------------------------------------------


def test_the_gallery_is_a_gallery():
    assert len(SCRIPTS) >= 16
    for script in SCRIPTS:
        assert len(re.findall(r"^# \.\. explorer:: \S+", script.read_text(encoding="utf-8"), re.M)) == 1, script.name


@pytest.mark.share(6)
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda p: p.stem)
def test_a_script_of_the_gallery(script, monkeypatch, capsys):
    plt = pytest.importorskip("matplotlib.pyplot")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    plt.switch_backend("Agg")
    plt.close("all")
    runpy.run_path(str(script))
    axes = [axes for number in plt.get_fignums() for axes in plt.figure(number).axes]
    assert axes
    for each in axes:
        shown = [*each.lines, *each.collections]
        assert shown, "an empty axis"
        assert all(len(line.get_xdata()) > 1 for line in each.lines)
    assert any(each.get_xlabel() and each.get_ylabel() for each in axes)
    plt.close("all")
    capsys.readouterr()


@pytest.mark.thorough
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda p: p.stem)
def test_a_notebook_runs(notebook, tmp_path, monkeypatch):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    monkeypatch.setenv("JUPYTER_PLATFORM_DIRS", "1")
    book = nbformat.reads(notebook.read_text(encoding="utf-8"), as_version=4)
    assert not any(cell.get("outputs") for cell in book.cells), "kept without results: they are made where it runs"
    nbclient.NotebookClient(
        book, timeout=120, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    results = [cell.outputs for cell in book.cells if cell.cell_type == "code"]
    assert all(results[1:])


@pytest.mark.thorough
def test_the_site_is_built_without_a_warning(tmp_path):
    """All but the gallery's runs, which have tests of their own, and the explorers."""
    pytest.importorskip("sphinx_gallery")
    source = tmp_path / "docs"
    shutil.copytree(DOCS, source, ignore=shutil.ignore_patterns("made", "sg_execution_times.rst"))
    (tmp_path / "src").symlink_to(ROOT / "src")
    (tmp_path / "benchmarks").symlink_to(ROOT / "benchmarks")
    (source / "_ext" / "explorer.py").write_text(
        "from docutils.parsers.rst import Directive\n\nclass None_(Directive):\n    required_arguments = 1\n"
        "    final_argument_whitespace = True\n    def run(self):\n        return []\n\n"
        "def setup(app):\n    app.add_directive('explorer', None_)\n"
    )
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", "-D", "plot_gallery=0"]
    process = subprocess.run(
        [*command, str(source), str(tmp_path / "site")], capture_output=True, text=True, check=False
    )
    assert process.returncode == 0, process.stderr[-2000:]
    assert "stribeck run" in (tmp_path / "site" / "reference" / "commands.html").read_text(encoding="utf-8")
    reference = (tmp_path / "site" / "reference" / "python.html").read_text(encoding="utf-8")
    assert "InputError" in reference
    theory = (tmp_path / "site" / "explanation" / "theory.html").read_text(encoding="utf-8")
    (drawn,) = re.findall(r'src="([^"]*tex-svg[^"?]*)', theory)
    assert (tmp_path / "site" / "explanation" / drawn).is_file(), "formulas are drawn by what the site brings"
    assert not re.findall(r'<script[^>]*src="https?:|<link[^>]*stylesheet[^>]*href="https?:', theory)
    assert "a controller or a machine for another tool" in reference
    assert list((tmp_path / "site" / "_downloads").rglob("p01_stick_slip.ipynb")), "no notebook to download"
