"""Runs a case in a folder of its own and compares what came out with what is kept."""

import contextlib
import difflib
import io
import json
import os
import re
import shlex
import shutil
import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from stribeck import examples
from stribeck.version import __version__
from tests.kept import logs, shown

OUTPUTS, INPUTS = Path(__file__).parent / "outputs", Path(__file__).parent / "inputs"
PLACES = (INPUTS, examples.path("arm").parent, Path(__file__).parent.parent / "reference" / "unseen")
NOISE = "NOISE"  # a number on which C and WebAssembly differ
NUMBER = re.compile(NOISE + "|(?<![\\w.])[-+\N{MINUS SIGN}]?\\d+(?:\\.\\d+)?(?:e[-+]?\\d+)?(?![\\w]|\\.\\d)")
EXACT, COARSE = 1e-9, 1e-5  # of what is proved or given; of what a solver or a fit finds, whose counts may differ too
BLANK = """<?xml version="1.0"?>
<svg xmlns="http://www.w3.org/2000/svg" width="9pt" height="9pt" viewBox="0 0 9 9"><!--{}--></svg>
"""
VARYING = (  # what differs from run to run, or from machine to machine
    (re.escape(__version__), "VERSION"),
    (r"\b[0-9a-f]{64}\b", "SHA256"),
    (r"\{[0-9a-f]{8}-[0-9a-f-]{27}\}|\b[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\b", "GUID"),
    (r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?(Z|\+00:00)?", "DATE"),
    (r"(seconds\"?: )[\d.e-]+", r"\1TIME"),
    (r"\bin [\d.]+ (s|ms|µs|min)\b", "in TIME"),
    (r"(lanes in \d+ parts?, )[\d.]+ s", r"\1TIME"),
    (r"((?:rejected|smallest_step|largest_step)\"?: )[\d.e-]+", r"\1WORK"),
    (r"\(\d+ rejected\)", "(WORK rejected)"),
    (r"(backend\"?: )\"(c|wasm)\"", r"\1BACKEND"),
    (r"(built\"?: )(true|false)", r"\1BUILT"),
    (r"\b(x86_64|aarch64|arm64|amd64|win64|linux64|darwin64)\b(-(linux|windows|darwin))?", "PLATFORM"),
)


@dataclass(frozen=True)
class Case:
    """One kept output: its text is made in an empty folder.

    ``tolerance``: of its numbers, relative. What is proved, counted or given must be the same, but for the rounding of libraries.
    """

    name: str
    make: Callable[[], list[str]]
    tolerance: float = EXACT
    thorough: bool = False
    backend: str = ""

    @property
    def path(self):
        return OUTPUTS / f"{self.name}.txt"

    @property
    def digits(self):
        return 12 if self.tolerance == EXACT else 7

    def lines(self, folder):
        """What comes out now."""
        with _as_kept(folder, self.backend):
            text = "\n".join(self.make())
        text = text.replace(str(folder), "FOLDER").replace(str(PLACES[0].parents[2]), "ROOT")
        for pattern, word in VARYING:
            text = re.sub(pattern, word, text)
        return [line.rstrip() for line in text.split("\n")]

    def differences(self, folder):
        """What comes out, and the lines of a diff from what is kept; none where they agree."""
        kept = self.path.read_text(encoding="utf-8").splitlines() if self.path.exists() else []
        new = self.lines(folder)
        if len(kept) == len(new):
            new = [a if agree(a, b, self.tolerance) else b for a, b in zip(kept, new, strict=True)]
        return new, list(difflib.unified_diff(kept, new, "kept", "now", "", "", 1, lineterm=""))


def agree(kept, new, tolerance):
    """Whether two lines have the same words, and numbers within a tolerance; of a solver, or one unit of their last place."""
    if kept == new:
        return True
    pairs = _numbers(kept, new)
    return pairs is not None and all(near(a, b, tolerance) for a, b in pairs)


def marked(lines, others, tolerance):
    """The lines, with a mark in the place of each number that is another one in ``others``."""
    result = []
    for line, other in zip(lines, others, strict=True):
        told = iter([a if near(a, b, tolerance) else NOISE for a, b in _numbers(line, other) or ()])
        result.append(NUMBER.sub(lambda _, told=told: next(told), line) if _numbers(line, other) else line)
    return result


def _numbers(line, other):
    """The numbers of two lines side by side; None where their words differ."""
    words, others = (re.sub(r"\s+", " ", NUMBER.sub("#", x)) for x in (line, other))
    return list(zip(NUMBER.findall(line), NUMBER.findall(other), strict=True)) if words == others else None


def near(a, b, tolerance):
    """Whether two numbers, as they are written, are the same but for rounding."""
    if a == b or NOISE in (a, b):
        return True
    if not ("." in a + b or "e" in a + b):  # counts of a solver's work, and rounded numbers
        return tolerance >= COARSE and abs(int(a) - int(b)) <= 0.02 * abs(int(a))
    x, y, place = (*(float(n.replace("\N{MINUS SIGN}", "-")) for n in (a, b)), max(map(_place, (a, b))))
    return abs(x - y) <= tolerance * max(abs(x), abs(y)) + 1.01 * place * (tolerance > EXACT)


def _place(number):
    """One unit of the last place that is shown."""
    mantissa, _, power = number.partition("e")
    return float(f"1e{int(power or 0) - len(mantissa.partition('.')[2])}")  # inf of a digest such as 3e400


@contextlib.contextmanager
def _as_kept(folder, backend):
    """The folder, a terminal of 100 columns, no progress, figures as their lines."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("COLUMNS", "100")
        if backend:
            patch.setenv("STRIBECK_BACKEND", backend)
        patch.setattr("stribeck.cli.progress._EVERY", 1e6)
        patch.setattr(
            "stribeck.mouth.plots.svg", lambda made: BLANK.format("\n".join(shown.figure(made)).replace("--", "- -"))
        )
        yield


def commands(name, words, tolerance=EXACT, backend="", thorough=False):
    """A case of commands, one after the other in one folder: what each prints, and then the files that they wrote."""
    case = Case(name, lambda: _commands(words, case.digits), tolerance, thorough, backend)
    return case


def _commands(words, digits):
    here = Path.cwd()
    given = inputs("\n".join(words))
    lines = []
    for command in words:
        status, out, err = call(*shlex.split(command))
        lines += [f"$ stribeck {command}"] + [f"status {status}"] * bool(status)
        try:
            lines += shown.tree(json.loads(out), digits) if out.startswith("{") else out.splitlines()
        except json.JSONDecodeError:
            lines += out.splitlines()
        lines += [f"! {line}" for line in err.splitlines()]
    for path in sorted(p for p in here.rglob("*") if p not in given and (p.is_file() or not any(p.iterdir()))):
        name = path.relative_to(here).as_posix()
        if path.is_dir():
            lines.append(f"-- {name}/ is empty")
            continue
        if path.suffix in (".svg", ".parquet") and any(path.parent.glob("*.html")):
            continue  # the page shows the figure, and the CSV file has the table
        lines += [f"-- {name}", *shown.file(name, path.read_bytes(), digits)]
    return lines


def inputs(text):
    """Copy the files that a text names, and those that a copied one names."""
    copied = set()
    names = set(re.findall(r"[\w./-]+\.(?:toml|csv|py|json|xml|npz|mat|txt)\b", text))
    while names:
        name = names.pop()
        source = next((place / name for place in PLACES if (place / name).is_file()), None)
        if (target := Path.cwd() / name) in copied or not (source or name in logs.MADE):
            continue
        copied.add(target)
        if source is None:
            logs.write(name, target)
            continue
        shutil.copy(source, target)
        if source.suffix == ".toml":
            names |= set(re.findall(r'"([\w./-]+\.(?:csv|py|toml))', source.read_text(encoding="utf-8")))
    return copied


def call(*words):
    """Run the command in this process: its status, output and errors."""
    from stribeck.cli import _status

    out, err = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, warnings.catch_warnings():
        patch.setattr(sys, "argv", ["stribeck", *words])
        patch.setenv("STRIBECK_BACKEND", os.environ.get("STRIBECK_BACKEND", ""))
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            status = _status([str(word) for word in words])
    return status, out.getvalue(), err.getvalue()
