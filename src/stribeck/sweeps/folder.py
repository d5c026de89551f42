"""The folder of a sweep's files: written atomically, by one process at a time."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from stribeck.errors import InputError, arg
from stribeck.files import read_file, write_with
from stribeck.platforms import Occupied, locked

_LEFT = ".[0-9]*-????????.tmp"  # temporary files of files.write_with and files.together that kill -9 leaves


class Folder:
    """A local or shared folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __str__(self) -> str:
        return str(self.folder)

    def path(self, name: str) -> str:
        """The path of a file."""
        return str(self.folder / name)

    def put(self, name: str, content: bytes) -> None:
        """Write a file atomically. A link, a pipe or a device in its place is removed, not followed."""
        path = self.folder / name
        if path.is_symlink() or (path.exists() and not path.is_file()):
            path.unlink()
        write_with(path, lambda beside: beside.write_bytes(content))

    def get(self, name: str) -> bytes:
        """The content of a file.

        Raises:
            OSError: if it is missing, cannot be read, or is a pipe.
        """
        return read_file(self.folder / name)

    def names(self) -> list[str]:
        """The names of the folder's entries."""
        return [path.name for path in self.folder.iterdir()]

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Lock the folder against other sweeps, and remove the temporary files of killed processes.

        Raises:
            InputError: if another process works in the folder.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        try:
            with locked(self.folder, wait=False):
                for left in self.folder.glob(_LEFT):
                    shutil.rmtree(left) if left.is_dir() and not left.is_symlink() else left.unlink()
                yield
        except Occupied:
            text = "another process is at work there: must be another folder, or wait"
            raise InputError(f"{arg('out')}: {str(self)!r}: {text}") from None
