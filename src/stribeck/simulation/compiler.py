"""The machine's C compiler: its search, options and call."""

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

# Results may differ by rounding; nan, inf and the order of calls do not change.
# One trajectory has no vectors: numbers that the compiler joins into vectors are stored and reloaded late (5 % slower).
_FLAGS = (
    "-O3", "-fno-math-errno", "-fno-trapping-math", "-fno-signed-zeros", "-fassociative-math", "-freciprocal-math",
    "-fno-tree-vectorize", *POSITION_INDEPENDENT, "-shared", "-fvisibility=hidden",
)  # fmt: skip
# Slow passes of the compiler; one trajectory's code is as fast without them, and its numbers differ by rounding at most.
# Lanes are a little faster with them.
_FOR_ONE = ("-fno-schedule-insns2", "-fno-gcse", "-fno-ipa-cp")
# Lanes are vectors from the start, and their exp rounds by adding a number and taking it away again.
_FOR_LANES = ("-ftree-vectorize", "-fno-associative-math")
# Independent operations of lanes are interleaved (5 % faster with AVX-512).
_BESIDE = ("-fschedule-insns", "-fsched-pressure")
# Structs are copied by at most 16 bytes at a time: wider copies leave the upper halves of registers in use, and each call
# of libm's exp, whose wrapper uses older instructions, then waits for them.
_NARROW = ("-mmove-max=128", "-mstore-max=128")
_TIME_LIMIT = 120  # s: a compilation takes 0.3 s to some seconds
_FIRST_OF_ZIG = 600  # s: it builds its C library once for each user


@dataclass(frozen=True)
class Compiler:
    """A C compiler: the words of its command, and an identity that changes with its version."""

    command: tuple[str, ...]
    identity: str
    options: tuple[str, ...] = _FOR_ONE
    extra: tuple[str, ...] = _NARROW  # left out if the compiler rejects them

    @property
    def key(self) -> str:
        """All that determines the library of a source: the compiler, its flags and this machine's processor."""
        return "|".join((self.identity, *_FLAGS, *self.options, *self.extra, platform.system(), processor()))

    def for_lanes(self) -> Compiler:
        """The same compiler with the options for several trajectories at once."""
        return replace(self, options=_FOR_LANES, extra=_BESIDE)

    def build(self, source: Path, library: Path) -> None:
        """Compile a C file into a shared library.

        Raises:
            BuildError: if no command succeeds; with the first error of the plainest command.
        """
        complaint, name = "", self.command[0]
        native = "-march=native"
        for target in dict.fromkeys([(native, *self.extra), (native,), ()]):  # some compilers reject -march=native
            command = [*self.command, *_FLAGS, *self.options, *target, "-o", str(library), str(source), "-lm"]
            limit = _FIRST_OF_ZIG if "ziglang" in self.command else _TIME_LIMIT
            result = called(command, name, limit, library.parent)
            complaint = first_complaint(result.stderr) or f"exit status {result.returncode}, no message"
            if result.returncode == 0:  # nothing was rejected: other options would give the same
                if library.is_file():
                    return
                complaint = "it wrote no library"
                break
        raise BuildError(f"{Path(self.command[0]).name} failed: {complaint}")


def called(
    command: list[str], name: str, limit: float, folder: Path, inside: bool = False
) -> subprocess.CompletedProcess[str]:
    """Run a compiler's command.

    Args:
        command: the words of the command.
        name: the compiler's name in messages.
        limit: the time limit, s.
        folder: the folder of the result, and of temporary files, since $TMPDIR may be full.
        inside: run the command in the folder.

    Raises:
        BuildError: if it did not finish in time, or cannot be run.
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
    """The compiler to use: $STRIBECK_CC or $CC, then cc, gcc, clang, then ziglang; None if there is none.

    ``STRIBECK_CC=none`` turns compilation off.
    """
    environment = tuple(map(os.environ.get, ("STRIBECK_CC", "CC", "PATH")))
    if environment in _found:
        chosen, state = _found[environment]
        if _state(chosen.command[0]) == state:
            return chosen
    compiler = _search()
    if compiler is not None and (state_now := _state(compiler.command[0])) is not None:
        _found[environment] = compiler, state_now
    return compiler


# Compilers by the environment variables, valid while their file is unchanged: a search takes longer than many simulations.
_found: dict[tuple[str | None, ...], tuple[Compiler, tuple[int, int]]] = {}


def _state(path: str) -> tuple[int, int] | None:
    try:
        state = os.stat(path)  # noqa: PTH116 (a third of the time of a Path)
    except OSError:
        return None
    return state.st_size, state.st_mtime_ns


def _search() -> Compiler | None:
    for variable in ("STRIBECK_CC", "CC"):
        if wanted := os.environ.get(variable, "").strip():
            if wanted == "none":
                return None
            if path := shutil.which(wanted):  # a path may contain blanks: C:\\Program Files\\...
                return _from_path(path, [])
            words = wanted.split()
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
    """The first line of a compiler's messages that is an error."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    wrong = [line for line in lines if "error: " in line.lower()] or [line for line in lines if "error" in line.lower()]
    return (wrong or lines or [""])[0]
