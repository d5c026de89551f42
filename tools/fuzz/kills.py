"""Commands killed at random instants over an older result: what is there afterwards is whole, and the next one works."""

from __future__ import annotations

import json
import math
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from contextlib import suppress
from pathlib import Path

import tomli_w

import stribeck
from stribeck import examples

# Each command (its first word): its words for the older result, what is added for the newer one, and the file that says that
# the result is whole.
_SUMMARY, _PLAN = "summary.json", ("--plan", "stroke=0.05,speed=0.1,force=50", "--simulate")
_LOG = ("--time", "t", "--position", "y", "--force", "F")
COMMANDS: dict[str, tuple[tuple[str, ...], tuple[str, ...], str | None]] = {
    "run": (("stick_slip.toml",), ("--set", "solve.t_end=40.0"), _SUMMARY),
    "sweep": (("stick_slip.toml", "--vary", "law.k_v=1e6:1e8:40:log"), (), None),
    "check": (("lugre", "--parameters", "canudas1995"), ("--set", "sigma_1=100"), "report.html"),
    "check creep": (("lugre_sobczyk", "--parameters", "canudas1995", "--creep", "1e-6"), ("--share", "0.5"), "report.html"),
    "fit": (("log.csv", *_LOG, "--law", "coulomb_viscous"), ("--mass", "2.0"), "parameters.toml"),
    "predict": (("log.csv", *_LOG, "--fit", "model"), (), None),
    "fit plan": (_PLAN, ("--seed", "3"), "program.csv"),
    "design": (("machine.toml",), ("--set", "controllers.axis.K_p=600"), _SUMMARY),
    "export": (("lugre", "--target", "fmu", "--parameters", "canudas1995"), ("--fmi", "2"), None),
    "explore": (("stick_slip.toml",), ("--set", "solve.t_end=3.0"), None),
    "new": (("servo",), (), None),
    "library": (("mx106",), (), None),
    "predict machine": (
        ("log.csv", "--machine", "stick_slip.toml", "--time", "t", "--position", "y"), ("--set", "plant.mass=1.1"), None,
    ),
    "import": (("bam", "servo.json"), (), None),
    "fit dynamic": (
        ("log.csv", *_LOG, "--law", "lugre", "--method", "dynamic", "--starts", "2"), ("--seed", "3"), "parameters.toml",
    ),
    "fit logs": (("axis.toml", "--logs", "logs.toml", "--starts", "1"), ("--seed", "3"), "parameters.toml"),
    "check level": (("lugre", "--parameters", "canudas1995", "--level", "0.8:1.2"), ("--set", "sigma_1=100"), "report.html"),
}  # fmt: skip
FILES = {  # in out
    "export": "law.fmu",
    "explore": "page.html",
    "new": "new.toml",
    "library": "machine_set.toml",
    "import": "servo.toml",
}
_JOURNALS = ("fit.partial.json",)  # from which a search goes on; of no result
FIRST_ONLY = ("new", "library")  # refuse what is there
_SIGNALS = [getattr(signal, name) for name in ("SIGKILL", "SIGTERM", "SIGINT", "SIGHUP") if hasattr(signal, name)]
_LAST = 1.2  # of the time that the command takes; some kills come after its end


def campaign(
    seed: int, count: int, ended: Counter[str] | None = None, faults: list[str] | None = None,
    names: tuple[str, ...] = tuple(COMMANDS),
) -> tuple[Counter[str], list[str]]:  # fmt: skip
    """How the processes ended, and what is wrong; both are also added to what is given."""
    ended, faults = Counter() if ended is None else ended, [] if faults is None else faults
    tried = dict[str, float]()
    for i in range(count):
        rng = random.Random(f"{seed}/{i}")
        with tempfile.TemporaryDirectory() as folder:
            fault = _one(Path(folder), names[i % len(names)], rng, ended, tried)
            if fault:
                faults.append(f"kill {seed}/{i}: {fault}")
    return ended, faults


def prepare(place: Path) -> None:
    """Write the input of every command."""
    for name in ("stick_slip", "machine"):
        (place / f"{name}.toml").write_bytes(examples.path(name).read_bytes())
    solution = stribeck.simulate(stribeck.Scenario.load(place / "stick_slip.toml", {"solve.t_end": 5.0}))
    rows = zip(*(x.tolist() for x in (solution.t, solution["y"], solution["F"])), strict=True)
    (place / "log.csv").write_text("t,y,F\n" + "".join(f"{t!r},{y!r},{f!r}\n" for t, y, f in rows))
    with warnings.catch_warnings(action="ignore"):
        model = stribeck.fit(place / "log.csv", "coulomb_viscous", time="t", position="y", force="F", forms=False)
    model.save(place / "model")
    bam = {"kt": 1.5, "R": 2.0, "armature": 0.02, "friction_base": 0.05, "friction_viscous": 0.06}
    (place / "servo.json").write_text(json.dumps(bam))
    _recorded(place)


def _recorded(place: Path) -> None:
    """A machine and a recording of it, for ``fit --logs``."""
    t = [0.01 * i for i in range(101)]
    push = [4 * math.sin(9 * x) * (1 + 0.6 * math.sin(23 * x)) for x in t]
    guide = {"sigma_0": 2e4, "sigma_1": 60.0, "sigma_2": 4.0, "F_c": 1.0, "F_s": 1.3, "v_s": 0.02}
    axis = {
        "schema": 2, "bodies": {"a": {"mass": 1.0}}, "solve": {"t_end": 1.0}, "output": {"step": 0.01},
        "contacts": {"guide": {"from": "a", "law": {"name": "lugre_majorant", "k_v": 1e4, "parameters": guide}}},
        "loads": {"push": {"on": "a", "kind": "signal", "signal": {"kind": "points", "t": t, "value": push}}},
    }  # fmt: skip
    y, rng = stribeck.simulate(stribeck.Scenario(axis))["a.y"].tolist(), random.Random(1)
    rows = "".join(f"{a!r},{b + rng.gauss(0, 2e-5)!r},{c!r}\n" for a, b, c in zip(t, y, push, strict=True))
    (place / "run.csv").write_text("t,y,u\n" + rows)
    (place / "axis.toml").write_text(tomli_w.dumps(axis))
    entry = {"file": "run.csv", "outputs": {"a.y": "y"}, "inputs": {"loads.push.signal": "u"}}
    logs = {"log": [entry], "unknown": {"bodies.a.mass": {"low": 0.5, "high": 2.0}}}
    (place / "logs.toml").write_text(tomli_w.dumps(logs))


def _one(place: Path, what: str, rng: random.Random, ended: Counter[str], took: dict[str, float]) -> str | None:
    prepare(place)
    environment = os.environ | {"STRIBECK_CACHE": os.environ.get("STRIBECK_CACHE", str(place / "cache"))}
    out = place / "out"
    older, added, last = COMMANDS[what]
    target = out / FILES[what] if what in FILES else out
    command = [sys.executable, "-m", "stribeck", what.split()[0], *older, "--out", str(target)]
    out.mkdir()
    if what not in FIRST_ONLY or what not in took:
        began = time.monotonic()
        done = subprocess.run(command, env=environment, cwd=place, check=False, capture_output=True)
        took[what] = min(took.get(what, math.inf), time.monotonic() - began)  # the first compiles
        if done.returncode:
            return f"{what}: {done.stderr.decode()[:200]}"
    if what in FIRST_ONLY:
        target.unlink(missing_ok=True)
    old = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    process = subprocess.Popen(
        [*command, *added], env=environment, cwd=place, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        start_new_session=True, preexec_fn=_heard,
    )  # fmt: skip
    moment, number = rng.uniform(0.05, _LAST * took[what]), rng.choice(_SIGNALS)
    try:
        process.wait(moment)
    except subprocess.TimeoutExpired:
        process.send_signal(number)
    try:
        _, error = process.communicate(timeout=60)
    except subprocess.TimeoutExpired:
        process.kill()
        return f"{what} does not end on {number.name}"
    ended[f"{what} {number.name} exit {process.returncode}"] += 1
    if number != signal.SIGKILL and _others(process.pid):
        return f"{what} {number.name}: left a process"
    if b"Traceback" in error:
        return f"{what} {number.name}: a traceback"
    if fault := _left(out, old, None if last is None else out / last, number):
        return f"{what} {number.name} {fault}"
    if what in FIRST_ONLY:
        target.unlink(missing_ok=True)
    again = subprocess.run([*command, *added], env=environment, cwd=place, check=False, capture_output=True)
    return None if again.returncode == 0 else f"{what} after {number.name}: {again.stderr.decode()[:200]}"


def _heard() -> None:
    """Have signals heard: a job in a shell's background ignores Ctrl-C, one under nohup SIGHUP."""
    for number in _SIGNALS:
        if number != signal.SIGKILL:
            signal.signal(number, signal.SIG_DFL)


def _others(session: int) -> bool:
    """Whether processes of the session, compilers in a group of their own too, run a second after its first one ended."""
    for _ in range(20):
        if not _running(session):
            return False
        time.sleep(0.05)
    return True


def _running(session: int) -> bool:
    """Whether a process of it has not ended; one that ended and that nobody asked for its status does not count. Looks at
    /proc; where there is none, for any process of its first group."""
    if not Path("/proc/self/stat").exists():
        with suppress(OSError):
            os.killpg(session, 0)
            return True
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            state, _, _, of, *_ = stat.read_text(errors="replace").rpartition(")")[2].split()
            if int(of) == session and state != "Z":
                return True
    return False


def _left(out: Path, old: dict[Path, int], last: Path | None, number: signal.Signals) -> str | None:
    """What is wrong with what is left: hidden files; files of two results beside the one that says all is whole."""
    there = [path for path in out.rglob("*") if path.is_file()]
    hidden = [path for path in there if any(part.startswith(".") for part in path.relative_to(out).parts)]
    if hidden and number != signal.SIGKILL:
        return f"left {sorted({path.name for path in hidden})}"
    whole = {path: path.stat().st_mtime_ns for path in there if path not in hidden and path.name not in _JOURNALS}
    if last is not None and last.exists() and whole != old:
        mixed = [path.name for path, time_ in whole.items() if old.get(path) == time_]
        return f"left {mixed} of the older result beside the newer one's {last.name}" if mixed else None
    if last is None and (gone := [path.name for path in old if path not in whole]):
        return f"took {gone} away"
    return None
