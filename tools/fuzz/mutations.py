"""Input files and options, mutated: every one must end in a status, clear lines and nothing half-written."""

from __future__ import annotations

import contextlib
import io
import math
import random
import signal
import tempfile
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from stribeck import examples
from stribeck.cli import _status

_TOKENS = (
    "nan", "inf", "-inf", "1e400", "-1", "0", "1e-320", "1e308", "true", "''", '"\\u001b[2J"', "[]", "{}", "[[[]]]", "9" * 400,
    "1979-05-27", '"$\\\\foo$"', "=", "[law]", "[[links]]", "#", '"' + "x" * 500 + '"', "../../etc/passwd", "-", ".py:X", "\\x00",
)  # fmt: skip
_MOST_WORK, _LONGEST_WAIT = 20.0, 600  # s of the processor and on the wall, after which a command counts as hanging
# Runs that would be long for good reasons are no fault: the time is cut, and the steps are counted.
_FIT = ("fit", "--time", "t", "--position", "y", "--force", "F")
_SHORT = ("--set", "solve.t_end=0.05", "--set", "solve.max_steps=20000")


class Hang(BaseException):
    """A command that did not end."""


def commands(place: Path, rng: random.Random) -> list[str]:
    """A command on the file in this folder, sometimes with a mutated option."""
    file, out = str(place / "rig.toml"), str(place / "out")
    words = rng.choice([
        ["run", file, *_SHORT], ["run", file, *_SHORT, "--out", out], ["run", file, *_SHORT, "--json"],
        ["run", file, "--law", "lugre", "--law", "dahl", *_SHORT],
        ["sweep", file, "--vary", "law.parameters.F_s=1.6:2:2", "--summary", *_SHORT, "--out", out],
        ["export", "lugre", "--parameters", str(place / "set.toml"), "--target", rng.choice(["c", "table"]), "--out", out],
        ["check", "dahl", "--parameters", str(place / "set.toml")],
        ["library", str(place / "mine.py") + ":Mine"],
        ["predict", str(place / "log.csv"), "--machine", file, "--time", "t", "--position", "y", *_SHORT, "--out", out],
        [*_FIT, str(place / "log.csv"), "--law", "coulomb_viscous"],
        [*_FIT, str(place / "log.csv"), "--law", "coulomb_viscous", "--out", out],
        ["predict", str(place / "log.csv"), "--fit", str(place / "fit.json")],
    ])  # fmt: skip
    if rng.random() < 0.3:
        at = rng.randrange(1, len(words) + 1)
        words.insert(
            at,
            rng.choice(("--set", "--law", "--vary", "--out", "--target", "--term", "--unit", *_TOKENS)).replace(
                "\\x00", ""
            ),
        )
    return words


def mutated(text: str, rng: random.Random) -> bytes:
    """The text with one to three changes: a value, a key, a line, some bytes."""
    for _ in range(rng.randint(1, 3)):
        lines = text.splitlines() or [""]
        i = rng.randrange(len(lines))
        way = rng.randrange(7)
        if way == 0:
            lines[i] = lines[i].partition("=")[0] + "= " + rng.choice(_TOKENS)
        elif way == 1:
            del lines[i]
        elif way == 2:
            lines.insert(i, lines[rng.randrange(len(lines))])
        elif way == 3:
            lines[i] = lines[i].replace(rng.choice('=.[]"e10 '), rng.choice(_TOKENS), 1)
        elif way == 4:
            lines[i], lines[0] = lines[0], lines[i]
        elif way == 5:
            at = rng.randrange(len(lines[i]) + 1)
            lines[i] = lines[i][:at] + chr(rng.choice((0, 7, 27, 0x202E, 0x10FFFF, 65, 0xE9))) + lines[i][at:]
        else:
            lines = lines[: i + 1]
        text = "\n".join(lines)
    data = text.encode("utf-8", "replace")
    if rng.random() < 0.15:
        at = rng.randrange(len(data) + 1)
        data = data[:at] + rng.randbytes(rng.randint(1, 4)) + data[at:]
    return data


_LAW = """
from stribeck.constants import Constant
from stribeck.laws import StaticLaw

class Mine(StaticLaw):
    "Viscous."
    c = Constant("N s/m", "viscous friction", at_least=0)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.c * v
"""
_SET = (
    "title = 'x'\nmotion = 'linear'\n[parameters]\nsigma_0 = {value = 1e5, low = 9e4, unit = 'N/m', determined = true}\n"
    "sigma_1 = 300.0\nsigma_2 = 0.4\nF_c = 1.0\nF_s = 1.5\nv_s = 1e-3\n"
)


_MODEL = """{
 "format": 2,
 "law": "coulomb_viscous",
 "method": "static",
 "values": {"F_c": 1.0,
  "sigma_2": 0.05},
 "fit": {"relative_force_error": 0.01,
  "cross_validated_error": 0.01,
  "friction_error": 0.01,
  "decimation": 1},
 "others": {"least squares": {"law": "coulomb_viscous",
  "values": {"F_c": 1.0,
   "sigma_2": 0.05}}},
 "data_sha256": "",
 "files": ["log.csv"],
 "columns": {"time": "t", "position": "y",
  "force": "F"},
 "units": {},
 "force_gain": null,
 "cutoff": null,
 "output": "force",
 "drive": null,
 "published": false
}"""
_LOG = "t,y,F\n" + "\n".join(
    f"{0.01 * i:.2f},{0.1 * math.sin(0.05 * i):.6f},{(math.cos(0.05 * i) > 0) * 2 - 1 - 0.05 * math.sin(0.05 * i):.6f}"
    for i in range(400)
)


def _files(place: Path, rng: random.Random) -> None:
    name = rng.choice([name for name in examples.names() if name != "measured"])
    text = {"rig.toml": examples.path(name).read_text(encoding="utf-8"), "set.toml": _SET, "mine.py": _LAW,
            "log.csv": _LOG, "fit.json": _MODEL}  # fmt: skip
    which = rng.choice(["rig.toml", "rig.toml", "rig.toml", "set.toml", "mine.py", "log.csv", "fit.json"])
    for file, content in text.items():
        (place / file).write_bytes(mutated(content, rng) if file == which else content.encode())


@contextlib.contextmanager
def _time_limit() -> Iterator[None]:
    """Processor time counts, as the machine may be busy; and the wall's for what waits."""

    def late(number: int, frame: object) -> None:
        raise Hang

    before = [signal.signal(number, late) for number in (signal.SIGPROF, signal.SIGALRM)]
    signal.setitimer(signal.ITIMER_PROF, _MOST_WORK)
    signal.alarm(_LONGEST_WAIT)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.alarm(0)
        signal.signal(signal.SIGPROF, before[0])
        signal.signal(signal.SIGALRM, before[1])


def campaign(
    seed: int, count: int, ended: Counter[str] | None = None, faults: list[str] | None = None
) -> tuple[Counter[str], list[str]]:
    """How the commands ended, and what is wrong: one line for each fault, with the seed that shows it again; both are also
    added to what is given."""
    ended, faults = Counter() if ended is None else ended, [] if faults is None else faults
    for i in range(count):
        rng = random.Random(f"{seed}/{i}")
        with tempfile.TemporaryDirectory() as folder:
            place = Path(folder)
            _files(place, rng)
            words = commands(place, rng)
            fault = one(words, place, ended)
            if fault:
                faults.append(f"mutation {seed}/{i}: {fault}: {' '.join(words)[:200]}")
    return ended, faults


def one(words: list[str], place: Path, ended: Counter[str]) -> str | None:
    """Run one command; what is wrong with how it ended."""
    out, err = io.StringIO(), io.StringIO()
    before = set(place.rglob("*"))
    try:
        with _time_limit(), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
            status = _status(words)
    except Hang:
        return "hangs"
    except SystemExit as error:
        status = error.code if isinstance(error.code, int) else 1
    except BaseException as error:
        return f"traceback: {type(error).__name__}: {str(error)[:100]}"
    if status == 130:
        raise KeyboardInterrupt
    ended[f"exit status {status}"] += 1
    if status not in (0, 1, 2):
        return f"exit status {status}"
    if "Traceback" in err.getvalue():
        return "traceback on the screen"
    bad = [line for line in err.getvalue().splitlines() if not line.isprintable() or len(line) > 320]
    if bad:
        return f"a line that no terminal should get: {bad[0][:100]!r}"
    left = {path for path in place.rglob("*") if path.suffix == ".tmp" or path.name.startswith(".")}
    if left:
        return f"left behind: {left}"
    if status == 2 and out.getvalue():
        return "refused, with words on standard output"
    new = {path for path in set(place.rglob("*")) - before if path.is_file()}
    return f"refused, and wrote {new}" if status == 2 and new else None
