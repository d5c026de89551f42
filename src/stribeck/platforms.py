"""What differs between operating systems, and is used in more than one place."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class Occupied(Exception):
    """Another process holds the lock of a folder."""


@contextmanager
def locked(folder: Path, wait: bool = True) -> Iterator[None]:
    """Within, no other process that asks has the lock of this folder. A file system without locks gives none.

    Raises:
        Occupied: another process has the lock, and ``wait`` is False.
    """
    handle = None
    try:
        try:
            handle = _opened(folder)
            _lock(handle, wait)
        except BlockingIOError:
            raise Occupied(str(folder)) from None
        except OSError:
            pass
        yield
    finally:
        if handle is not None:
            os.close(handle)  # and with it the lock


if sys.platform == "win32":
    import msvcrt
    import tempfile
    import time
    from hashlib import sha256

    def _opened(folder: Path) -> int:
        """A file of the temporary folder: Windows opens no folders."""
        name = sha256(os.path.normcase(folder.resolve()).encode("utf-8", "surrogatepass")).hexdigest()[:16]
        return os.open(Path(tempfile.gettempdir()) / f"stribeck-{name}.lock", os.O_RDWR | os.O_CREAT)

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

    def _opened(folder: Path) -> int:
        return os.open(folder, os.O_RDONLY)

    def _lock(handle: int, wait: bool) -> None:
        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
