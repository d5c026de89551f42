"""Commands killed at random instants over an older result: what is there afterwards is whole, and the next one works."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import stribeck
from stribeck import examples

# Each command: its words for the older result, what is added for the newer one, and the file that says the result is whole.
_SUMMARY, _RIG = "summary.json", ("--stroke", "0.05", "--speed", "0.1", "--force", "50", "--simulate")
_LOG = ("--time", "t", "--position", "y", "--force", "F")
COMMANDS: dict[str, tuple[tuple[str, ...], tuple[str, ...], str | None]] = {
    "run": (("stick_slip.toml",), ("--set", "solve.t_end=40.0"), _SUMMARY),
    "compare": (("stick_slip.toml", "--law", "lugre", "--law", "dahl"), ("--law", "lugre_majorant:k_v=1e6"), _SUMMARY),
    "sweep": (("stick_slip.toml", "--vary", "law.k_v=1e6:1e8:40:log"), (), None),
    "check": (("lugre", "--parameters", "canudas1995"), ("--set", "sigma_1=100"), "report.html"),
    "advise": (("lugre_sobczyk", "--parameters", "canudas1995", "--creep", "1e-6"), ("--share", "0.5"), _SUMMARY),
    "fit": (("log.csv", *_LOG, "--law", "coulomb_viscous"), ("--trim", "3"), "parameters.toml"),
    "predict": (("log.csv", *_LOG, "--fit", "model"), (), None),
    "rig": (_RIG, ("--seed", "3"), "programme.csv"),
    "design": (("machine.toml", "--no-compensations"), ("--set", "controllers.axis.K_p=600"), _SUMMARY),
    "export": (("lugre", "--target", "fmu", "--parameters", "canudas1995"), ("--fmi", "2"), None),
    "explore": (("stick_slip.toml",), ("--set", "solve.t_end=3.0"), None),
    "new": (("servo",), (), None),
    "parameters": (("mx106",), (), None),
}  # fmt: skip
_FILES = {"export": "law.fmu", "explore": "page.html", "new": "new.toml", "parameters": "machine_set.toml"}  # in out
_FIRST_ONLY = ("new",)  # refuses what is there
_LAST = 1.2  # of the time that the command takes; some kills come after its end


def campaign(seed: int, count: int, names: tuple[str, ...] = tuple(COMMANDS)) -> tuple[Counter[str], list[str]]:
    """How the processes ended, and what is wrong."""
    ended: Counter[str] = Counter()
    faults, tried = [], dict[str, float]()
    for i in range(count):
        rng = random.Random(f"{seed}/{i}")
        with tempfile.TemporaryDirectory() as folder:
            fault = _one(Path(folder), names[i % len(names)], rng, ended, tried)
            if fault:
                faults.append(f"kill {seed}/{i}: {fault}")
    return ended, faults


def _prepared(place: Path) -> dict[str, str]:
    """The input of every command; the environment."""
    for name in ("stick_slip", "machine"):
        (place / f"{name}.toml").write_bytes(examples.path(name).read_bytes())
    solution = stribeck.simulate(stribeck.Scenario.load(place / "stick_slip.toml", {"solve.t_end": 5.0}))
    rows = zip(*(x.tolist() for x in (solution.t, solution["y"], solution["F"])), strict=True)
    (place / "log.csv").write_text("t,y,F\n" + "".join(f"{t!r},{y!r},{f!r}\n" for t, y, f in rows))
    (place / "model").mkdir()
    model = {"format": 1, "law": "coulomb_viscous", "method": "static", "values": {"F_c": 1.0, "sigma_2": 0.4},
             "columns": {"time": "t", "position": "y", "force": "F"}}  # fmt: skip
    (place / "model" / "fit.json").write_text(json.dumps(model))
    return os.environ | {"STRIBECK_CACHE": os.environ.get("STRIBECK_CACHE", str(place / "cache"))}


def _one(place: Path, what: str, rng: random.Random, ended: Counter[str], took: dict[str, float]) -> str | None:
    environment, out = _prepared(place), place / "out"
    older, added, last = COMMANDS[what]
    target = out / _FILES[what] if what in _FILES else out
    command = [sys.executable, "-m", "stribeck", what, *older, "--out", str(target)]
    out.mkdir()
    if what not in _FIRST_ONLY or what not in took:
        began = time.monotonic()
        done = subprocess.run(command, env=environment, cwd=place, check=False, capture_output=True)
        took.setdefault(what, time.monotonic() - began)
        if done.returncode:
            return f"{what}: {done.stderr.decode()[:200]}"
    if what in _FIRST_ONLY:
        target.unlink(missing_ok=True)
    old = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    process = subprocess.Popen(
        [*command, *added], env=environment, cwd=place, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a shell's background job ignores it
    )  # fmt: skip
    time.sleep(rng.uniform(0.05, _LAST * took[what]))
    number = rng.choice((signal.SIGKILL, signal.SIGTERM, signal.SIGINT))
    process.send_signal(number)
    try:
        _, error = process.communicate(timeout=60)
    except subprocess.TimeoutExpired:
        process.kill()
        return f"{what} does not end on {number.name}"
    ended[f"{what} {number.name} exit {process.returncode}"] += 1
    if b"Traceback" in error:
        return f"{what} {number.name}: a traceback"
    if fault := _left(out, old, None if last is None else out / last, number):
        return f"{what} {number.name} {fault}"
    if what in _FIRST_ONLY:
        target.unlink(missing_ok=True)
    again = subprocess.run([*command, *added], env=environment, cwd=place, check=False, capture_output=True)
    return None if again.returncode == 0 else f"{what} after {number.name}: {again.stderr.decode()[:200]}"


def _left(out: Path, old: dict[Path, int], last: Path | None, number: signal.Signals) -> str | None:
    """What is wrong with what is left: hidden files; files of two results beside the one that says all is whole."""
    there = [path for path in out.rglob("*") if path.is_file()]
    hidden = [path for path in there if any(part.startswith(".") for part in path.relative_to(out).parts)]
    if hidden and number != signal.SIGKILL:
        return f"left {sorted({path.name for path in hidden})}"
    whole = {path: path.stat().st_mtime_ns for path in there if path not in hidden}
    if last is not None and last.exists() and whole != old:
        mixed = [path.name for path, time_ in whole.items() if old.get(path) == time_]
        return f"left {mixed} of the older result beside the newer one's {last.name}" if mixed else None
    if last is None and (gone := [path.name for path in old if path not in whole]):
        return f"took {gone} away"
    return None
