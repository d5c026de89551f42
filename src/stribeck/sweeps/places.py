"""The place of a sweep's files: a folder of this machine, or a URL that fsspec supports (s3://, gs://, memory://, ...)."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from stribeck.errors import InputError, StribeckError, arg, error_text, needed
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

    def get(self, name: str) -> bytes | None:
        """The content of a file; None if there is none.

        Raises:
            OSError: if it cannot be read, or is a pipe.
        """
        try:
            return read_file(self.folder / name)
        except FileNotFoundError:
            return None

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


class Store:
    """A store that fsspec writes to. Credentials, endpoints, time limits and retries are the library's own settings."""

    def __init__(self, url: str) -> None:
        self.url = url.rstrip("/")
        if not url.partition("://")[2].strip("/"):
            raise InputError(f"{arg('out')}: {url!r}: must name a place behind ://")
        with needed(f"{arg('out')} {url}", "cluster"):
            import fsspec
        try:
            self._files, self._path = fsspec.core.url_to_fs(self.url, use_listings_cache=False)
        except (ImportError, ValueError) as error:  # the library for s3:// is not installed, or foo:// is unknown
            raise InputError(f"{arg('out')}: {url!r}: must be a folder, or a URL that fsspec knows: {error}") from None
        except Exception as error:  # each library has errors of its own
            raise InputError(f"{arg('out')}: {url!r}: cannot be opened: {error_text(error)}") from None

    def __str__(self) -> str:
        return self.url

    def path(self, name: str) -> str:
        """The URL of an object."""
        return f"{self.url}/{name}"

    def put(self, name: str, content: bytes) -> None:
        """Write an object, which appears once it is complete."""
        with self._reported("written"):
            self._files.pipe_file(f"{self._path}/{name}", content)

    def get(self, name: str) -> bytes | None:
        """The content of an object; None if there is none.

        Raises:
            StribeckError: if it cannot be read: no answer, no permission, a server's failure.
        """
        with self._reported(f"read now ({name})"):
            try:
                return bytes(self._files.cat_file(f"{self._path}/{name}"))
            except FileNotFoundError:
                return None

    def names(self) -> list[str]:
        """The names of the objects there."""
        with self._reported("listed"):
            try:
                return [str(path).rpartition("/")[2] for path in self._files.ls(self._path, detail=False)]
            except FileNotFoundError:
                return []

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Does nothing: stores have no locks. Two equal sweeps write the same bytes; the manifest excludes a different one."""
        yield

    @contextmanager
    def _reported(self, what: str) -> Iterator[None]:
        try:
            yield
        except Exception as error:  # each library has errors of its own
            raise StribeckError(f"{arg('out')}: {self.url!r}: cannot be {what}: {error_text(error)}") from None


def place_of(out: Path | str) -> Folder | Store:
    """The place of a path or a URL.

    Raises:
        InputError: if no installed library can write to the URL.
    """
    return Store(out) if isinstance(out, str) and "://" in out else Folder(Path(out))
