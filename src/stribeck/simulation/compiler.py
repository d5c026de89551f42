"""The machine's C compiler: which it is, and how it is called."""

from __future__ import annotations

import importlib.util
import os
import platform
import shutil
import subprocess
import sys
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from stribeck.errors import BuildError
from stribeck.platforms import OWN_GROUP, POSITION_INDEPENDENT, end_with_children

# Rounding may differ in the last bit from what is written; nan, inf and the order of evaluation of calls do not change.
# One trajectory has no vectors: what the compiler makes into some is written as numbers and read back late (5 %).
_FLAGS = (
    "-O3", "-fno-math-errno", "-fno-trapping-math", "-fno-signed-zeros", "-fassociative-math", "-freciprocal-math",
    "-fno-tree-vectorize", *POSITION_INDEPENDENT, "-shared", "-fvisibility=hidden",
)  # fmt: skip
# Passes that take much of the compiler's time; one trajectory's code is as fast without, and its numbers differ by
# rounding at most. Lanes are a little faster with them.
_FOR_ONE = ("-fno-schedule-insns2", "-fno-gcse", "-fno-ipa-cp")
# Lanes are vectors from the start, and their exp rounds by adding a number and taking it away again.
_FOR_LANES = ("-ftree-vectorize", "-fno-associative-math")
# Operations of lanes that do not wait for each other are put beside each other (5 % with AVX-512).
_BESIDE = ("-fschedule-insns", "-fsched-pressure")
# Copies of structs no wider than 16 bytes: wider ones leave the upper halves of registers in use, and then each call of
# libm's exp, whose wrapper is of older instructions, waits for them.
_NARROW = ("-mmove-max=128", "-mstore-max=128")
_TIME_LIMIT = 120  # s
_FIRST_OF_ZIG = 600  # s: it builds its C library once for each user


@dataclass(frozen=True)
class Compiler:
    """A C compiler: the words of its command, and what tells it from another one or another version."""

    command: tuple[str, ...]
    identity: str
    options: tuple[str, ...] = _FOR_ONE
    extra: tuple[str, ...] = _NARROW  # left out where the compiler does not know them

    @property
    def key(self) -> str:
        """All that decides which library a source becomes: the compiler, its flags and this machine's processor."""
        return "|".join((self.identity, *_FLAGS, *self.options, *self.extra, platform.system(), processor()))

    def for_lanes(self) -> Compiler:
        """The same compiler with the options that several trajectories at once need."""
        return replace(self, options=_FOR_LANES, extra=_BESIDE)

    def build(self, source: Path, library: Path) -> None:
        """Compile a C file into a shared library.

        Raises:
            BuildError: with the compiler's first complaint about the plainest command.
        """
        complaint = ""
        own = "-march=native"
        for target in dict.fromkeys([(own, *self.extra), (own,), ()]):  # not every compiler knows its own machine
            command = [*self.command, *_FLAGS, *self.options, *target, "-o", str(library), str(source), "-lm"]
            limit = _FIRST_OF_ZIG if "ziglang" in self.command else _TIME_LIMIT
            result = called(command, self.command[0], limit, library.parent)
            if result.returncode == 0 and library.is_file():
                return
            silent = f"exit status {result.returncode}, no message" if result.returncode else "it wrote no library"
            complaint = first_complaint(result.stderr) or silent
        raise BuildError(f"{Path(self.command[0]).name} failed: {complaint}")


def called(
    command: list[str], name: str, limit: float, folder: Path, inside: bool = False
) -> subprocess.CompletedProcess[str]:
    """What a compiler's command ended with; ``name`` is what messages call it, ``limit`` how long it may take, s.

    Its temporary files go where its result will be: $TMPDIR may be full, and Python then took another folder. ``inside``:
    it runs there too.

    Raises:
        BuildError: it did not end in time, or cannot be run.
    """
    try:
        with subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace",
            env=os.environ | dict.fromkeys(("TMPDIR", "TMP", "TEMP"), str(folder)), cwd=folder if inside else None,
            process_group=OWN_GROUP,
        ) as process:  # fmt: skip
            try:
                printed, complaint = process.communicate(timeout=limit)
            except BaseException:
                end_with_children(process)
                raise
        return subprocess.CompletedProcess(command, process.returncode, printed, complaint)
    except subprocess.TimeoutExpired:
        raise BuildError(f"{name} did not finish within {limit:g} s") from None
    except OSError as error:
        raise BuildError(f"{name} cannot be run: {error.strerror}") from None


def find() -> Compiler | None:
    """The compiler to use: $STRIBECK_CC or $CC, then cc, gcc, clang, then ziglang; None where there is none.

    ``STRIBECK_CC=none`` turns compilation off.
    """
    asked = tuple(map(os.environ.get, ("STRIBECK_CC", "CC", "PATH")))
    if asked in _found:
        chosen, state = _found[asked]
        if _state(chosen.command[0]) == state:
            return chosen
    found = _search()
    if found is not None and (now := _state(found.command[0])) is not None:
        _found[asked] = found, now
    return found


# What was found where, while its file stays as it was: the search takes longer than many a simulation.
_found: dict[tuple[str | None, ...], tuple[Compiler, tuple[int, int]]] = {}


def _state(path: str) -> tuple[int, int] | None:
    try:
        state = os.stat(path)  # noqa: PTH116 (a third of the time of a Path)
    except OSError:
        return None
    return state.st_size, state.st_mtime_ns


def _search() -> Compiler | None:
    for variable in ("STRIBECK_CC", "CC"):
        if asked := os.environ.get(variable, "").strip():
            if asked == "none":
                return None
            if path := shutil.which(asked):  # blanks may be a part of it: C:\\Program Files\\...
                return _from_path(path, [])
            words = asked.split()
            path = shutil.which(words[0])
            if path or variable == "STRIBECK_CC":
                return _from_path(path or words[0], words[1:])
    for name in ("cc", "gcc", "clang"):
        if path := shutil.which(name):
            return _from_path(path, [])
    if importlib.util.find_spec("ziglang"):
        from importlib.metadata import version

        return Compiler((sys.executable, "-m", "ziglang", "cc"), f"ziglang {version('ziglang')}")
    return None


def _from_path(path: str, options: list[str]) -> Compiler:
    try:
        real = Path(path).resolve()
    except OSError:
        real = Path(path)
    state = _state(path)
    identity = path if state is None else f"{real} {state[0]} {state[1]}"  # cheaper than asking for its version
    return Compiler((path, *options), " ".join((identity, *options)))


@cache
def processor() -> str:
    """The processor's model and features: a library for one may be an illegal instruction for another."""
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
        wanted = ("model name", "flags", "Features", "CPU part")
        first = {line.split(":")[0].strip(): line for line in reversed(lines) if line.startswith(wanted)}
        return "".join(first[key] for key in sorted(first)) or platform.machine()
    except OSError:
        return f"{platform.machine()} {platform.processor()}"


def first_complaint(text: str) -> str:
    """The line of a compiler's messages that says why it failed."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    wrong = [line for line in lines if "error: " in line.lower()] or [line for line in lines if "error" in line.lower()]
    return (wrong or lines or [""])[0]
