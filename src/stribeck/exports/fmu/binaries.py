"""Shared libraries from the sources of an FMU: for this platform, and for others if they are wanted."""

from __future__ import annotations

import platform
import sys
import tempfile
from pathlib import Path

from stribeck.errors import BuildError, note
from stribeck.exports.optional import package
from stribeck.simulation import compiler

_FLAGS = ("-std=c99", "-O2", "-shared", "-fvisibility=hidden", "-s")
_TIME_LIMIT = 600  # s; the first cross-compilation builds the platform's own libraries

# platform in FMI 3.0, in FMI 2.0, target of zig
_PLATFORMS = {
    "x86_64-linux": ("linux64", "x86_64-linux-gnu.2.17"),
    "x86_64-windows": ("win64", "x86_64-windows-gnu"),
    "x86_64-darwin": ("darwin64", "x86_64-macos"),
    "aarch64-linux": ("aarch64-linux", "aarch64-linux-gnu.2.17"),
    "aarch64-darwin": ("aarch64-darwin", "aarch64-macos"),
}
_ACROSS = ("x86_64-windows", "x86_64-darwin", "aarch64-darwin")


def host_platform() -> str:
    """This platform's name in FMI 3.0."""
    machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    return f"{machine}-{platform.system().lower()}"


def binaries(sources: dict[str, str], fmi: int, everywhere: bool = False) -> dict[str, bytes]:
    """The libraries by the folder that FMI wants them in; ``everywhere``: those of other platforms too.

    Raises:
        MissingExtra: those of other platforms are wanted, and ziglang is not installed.
        BuildError: this platform's compiler is there and does not compile the sources.
    """
    libraries: dict[str, bytes] = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        native = compiler.find()
        if native is not None:
            libraries[host_platform()] = _compiled(
                [*native.command, "-fPIC"], Path(native.command[0]).name, Path(folder)
            )
        others = [name for name in _ACROSS if everywhere and name not in libraries]
        if others:
            package("ziglang")
            note(f"compiling for {', '.join(others)} as well; the first time takes minutes")
        for name in others:
            zig = [sys.executable, "-m", "ziglang", "cc", "-target", _PLATFORMS[name][1]]
            try:
                libraries[name] = _compiled(zig, "zig cc", Path(folder))
            except BuildError as error:
                note(f"no binary for {name}: {error}")
    if not libraries:
        note("no C compiler found: the FMU holds its sources only (pip install 'stribeck[fmu]')")
    return {name if fmi == 3 else _PLATFORMS.get(name, (name,))[0]: data for name, data in libraries.items()}


def _compiled(command: list[str], name: str, folder: Path) -> bytes:
    """The library; stripped, and named without folders: those of this machine would stand in it."""
    library = folder / "library"
    libm = [] if "windows" in " ".join(command) else ["-lm"]
    words = [*command, *_FLAGS, "-o", library.name, "fmu.c", *libm]
    done = compiler.called(words, name, _TIME_LIMIT, folder, inside=True)
    if done.returncode or not library.is_file():
        raise BuildError(f"{name} failed: {compiler.first_complaint(done.stderr)}")
    data = library.read_bytes()
    library.unlink()
    return data
