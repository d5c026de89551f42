"""Functions that differ between operating systems: locks, signals, processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

# The argument process_group of a process that end_with_children() ends.
OWN_GROUP = 0 if os.name == "posix" else -1
# The option for code of a shared library; on Windows all code is position-independent, and compilers reject the option.
POSITION_INDEPENDENT = ("-fPIC",) if os.name == "posix" else ()


class Occupied(Exception):
    """Another process has the lock of a folder."""


@contextmanager
def locked(folder: Path, wait: bool = True) -> Iterator[None]:
    """A context in which this process has the lock of a folder; without effect on a file system without locks.

    Raises:
        Occupied: if another process has the lock, and ``wait`` is False.
    """
    handle = None
    try:
        try:
            handle = _open_lock(folder)
            _lock(handle, wait)
        except BlockingIOError:
            raise Occupied(str(folder)) from None
        except OSError:
            pass
        yield
    finally:
        if handle is not None:
            os.close(handle)  # releases the lock


if sys.platform == "win32":
    import msvcrt
    import tempfile
    import time
    from hashlib import sha256

    def _open_lock(folder: Path) -> int:
        """A file of the temporary folder, since Windows cannot open folders."""
        name = sha256(os.path.normcase(folder.resolve()).encode("utf-8", "surrogatepass")).hexdigest()[:16]
        return os.open(Path(tempfile.gettempdir()) / f"stribeck-{name}.lock", os.O_RDWR | os.O_CREAT)

    def refuse_open(path: Path) -> None:
        """Raise PermissionError if another program has the file open, since it cannot be replaced then."""
        os.rename(path, path)  # noqa: PTH104 (Path.rename reports less)

    def end_with_children(process: subprocess.Popen[str]) -> None:
        """End a process that was started in a group of its own, and what it has started."""
        with suppress(OSError):
            subprocess.run(["taskkill", "/F", "/T", "/PID", str(process.pid)], capture_output=True, check=False)
        process.kill()

    def user_name() -> str:
        """A name that is different for each user of this machine."""
        return os.environ.get("USERNAME", "user")

    def _lock(handle: int, wait: bool) -> None:
        while True:
            try:
                msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
                return
            except OSError:
                if not wait:
                    raise BlockingIOError from None
                time.sleep(0.05)

else:
    import fcntl

    def refuse_open(path: Path) -> None:
        """Does nothing: a file that another program has open can be replaced."""

    def end_with_children(process: subprocess.Popen[str]) -> None:
        """End a process that was started in a group of its own, and what it has started."""
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)

    def user_name() -> str:
        """A name that is different for each user of this machine."""
        return str(os.geteuid())

    def _open_lock(folder: Path) -> int:
        return os.open(folder, os.O_RDONLY)

    def _lock(handle: int, wait: bool) -> None:
        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))


def free_memory() -> float:
    """Bytes of memory that a process may still use; infinite where the system does not say."""
    limits = []
    with suppress(OSError):
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        limits += [float(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:")]
    with suppress(OSError, ValueError):
        limits.append(float(Path("/sys/fs/cgroup/memory.max").read_text(encoding="ascii")))
    if not limits and hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        limits.append(float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")))
    return min(limits, default=float("inf"))


def size_of(count: float) -> str:
    """A number of bytes for people: '3.2 GB'."""
    for unit in ("bytes", "kB", "MB", "GB", "TB", "PB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} EB"
