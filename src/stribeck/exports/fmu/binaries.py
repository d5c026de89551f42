"""The shared library from the sources of an FMU, for this platform."""

from __future__ import annotations

import platform
import tempfile
from pathlib import Path

from stribeck.errors import BuildError, note
from stribeck.simulation import compiler

_FLAGS = ("-std=c99", "-O2", "-shared", "-fvisibility=hidden", "-s")
_TIME_LIMIT = 600  # s; with zig, the first compilation builds the platform's own libraries

# platform in FMI 3.0, and in FMI 2.0 where it is another word
_PLATFORMS = {"x86_64-linux": "linux64", "x86_64-windows": "win64", "x86_64-darwin": "darwin64"}


def host_platform() -> str:
    """This platform's name in FMI 3.0."""
    machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    return f"{machine}-{platform.system().lower()}"


def binaries(sources: dict[str, str], fmi: int) -> dict[str, bytes]:
    """The library by the folder that FMI wants it in; empty without a compiler.

    Raises:
        BuildError: the compiler does not compile the sources.
    """
    native = compiler.find()
    if native is None:
        note("no C compiler found: the FMU holds its sources only (pip install 'stribeck[fmu]')")
        return {}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        library = _compiled([*native.command, "-fPIC"], Path(native.command[0]).name, Path(folder))
    here = host_platform()
    return {here if fmi == 3 else _PLATFORMS.get(here, here): library}


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
