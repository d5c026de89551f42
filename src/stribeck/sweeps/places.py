"""Where a sweep's files go: a folder, or a place by its URL (s3://, gs://, or whatever fsspec knows)."""

from __future__ import annotations

import json
import os
import secrets
import shutil
import socket
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from hashlib import file_digest, sha256
from pathlib import Path
from typing import IO, TYPE_CHECKING, Protocol

from stribeck.errors import InputError, arg, needed
from stribeck.files import open_file, sha256_of, write_with

if TYPE_CHECKING:
    from pyarrow import fs

Write = Callable[[Path], object]

_CHUNK = 1 << 22  # bytes sent at a time
_BEAT = 5.0  # s between signs of life of who works on an object store
_BUSY = "_busy.json"
_LEFT = (".[0-9]*-????????.tmp", ".part-*.tmp", "._manifest*.tmp")


class Place(Protocol):
    """A folder of files, each of which is there whole or not at all."""

    def put(self, name: str, write: Write) -> str:
        """Have ``write`` make the file, then put it in place under ``name``; its SHA-256."""

    def open(self, name: str) -> IO[bytes]:
        """A file to read.

        Raises:
            OSError: it is not there.
        """

    def state(self, name: str) -> tuple[int, int]:
        """Size and time of the last change, ns: what stays the same while nobody writes.

        Raises:
            OSError: it is not there.
        """

    def names(self) -> list[str]:
        """The files there."""

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Keep other processes out for a while.

        Raises:
            InputError: one is at work there.
        """
        yield

    def tidy(self) -> None:
        """Take away what a killed process left half-written; nobody else is at work."""

    def __str__(self) -> str:
        """As the user wrote it."""


def place_of(where: Path | str) -> Folder | Store:
    """The place of a path or of a URL.

    Raises:
        InputError: no library here knows such a URL.
    """
    return Store(where) if isinstance(where, str) and "://" in where else Folder(Path(where))


def digest(place: Place, name: str) -> str:
    """The SHA-256 of a file there.

    Raises:
        OSError: it is not there.
    """
    with place.open(name) as file:
        return file_digest(file, "sha256").hexdigest()  # type: ignore[arg-type]  # any readable file will do


def put_json(place: Place, name: str, data: object) -> None:
    """Write data as JSON."""
    text = json.dumps(data, indent=2, allow_nan=False) + "\n"
    place.put(name, lambda beside: beside.write_text(text, encoding="utf-8"))


def read_json(place: Place, name: str) -> dict[str, object]:
    """The tables of a JSON file; empty where there is none that can be read."""
    try:
        with place.open(name) as file:
            found = json.load(file)
    except (OSError, ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


@contextmanager
def fetched(place: Place, name: str) -> Iterator[Path]:
    """A file of a place as one of this machine."""
    if isinstance(place, Folder):
        yield place.folder / name
        return
    with tempfile.TemporaryDirectory() as folder, place.open(name) as source:
        path = Path(folder) / name
        with path.open("wb") as file:
            while some := source.read(_CHUNK):
                file.write(some)
        yield path


class Folder:
    """A folder of this machine, or one that it shares."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __str__(self) -> str:
        return str(self.folder)

    def put(self, name: str, write: Write) -> str:
        """See :class:`Place`. A pipe, a device or a link makes room for the file: what it leads to is not this sweep's."""
        path = self.folder / name
        if path.is_symlink() or (path.exists() and not path.is_file()):
            path.unlink()
        write_with(path, write)
        return sha256_of(path)

    def open(self, name: str) -> IO[bytes]:
        """See :class:`Place`."""
        return open_file(self.folder / name)

    def state(self, name: str) -> tuple[int, int]:
        """See :class:`Place`."""
        found = (self.folder / name).stat()
        return found.st_size, found.st_mtime_ns

    def names(self) -> list[str]:
        """See :class:`Place`."""
        return [path.name for path in self.folder.iterdir()]

    def tidy(self) -> None:
        """See :class:`Place`."""
        for pattern in _LEFT:
            for left in self.folder.glob(pattern):
                shutil.rmtree(left) if left.is_dir() and not left.is_symlink() else left.unlink()

    @contextmanager
    def alone(self) -> Iterator[None]:
        """See :class:`Place`; where the system knows how."""
        try:
            import fcntl
        except ImportError:
            yield
            return
        handle = os.open(self.folder, os.O_RDONLY)
        try:
            with suppress(OSError):
                try:
                    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    raise _occupied(self) from None
            yield
        finally:
            os.close(handle)


class Store:
    """An object store: a file appears there when all of it was sent. Credentials and endpoints are those of the
    environment (AWS_ENDPOINT_URL, ...)."""

    def __init__(self, url: str) -> None:
        if not url.partition("://")[2].strip("/"):
            raise InputError(f"{arg('folder')}: {url!r}: must name a place behind ://")
        self.url = url = url.rstrip("/")
        with needed(f"{arg('folder')} {url}", "parquet"):
            from pyarrow import ArrowInvalid, fs
        try:
            self._files, self._path = fs.FileSystem.from_uri(url)
        except ArrowInvalid as error:
            self._files, self._path = self._by_fsspec(str(error))
        except OSError as error:
            raise InputError(f"{arg('folder')} {url}: cannot be reached: {error}") from None

    def _by_fsspec(self, why: str) -> tuple[fs.FileSystem, str]:
        from pyarrow import fs

        try:
            import fsspec

            files, path = fsspec.core.url_to_fs(self.url)
        except (ImportError, ValueError) as error:
            text = f"must be a path, or a URL that pyarrow or fsspec knows ({why}; fsspec: {error})"
            raise InputError(f"{arg('folder')} {self.url}: {text}") from None
        except Exception as error:  # each kind of store raises what its libraries do
            text = f"cannot be reached: {type(error).__name__}: {' '.join(str(error).split())}"
            raise InputError(f"{arg('folder')} {self.url}: {text[:200]}") from None
        return fs.PyFileSystem(fs.FSSpecHandler(files)), path

    def __str__(self) -> str:
        return self.url

    def _at(self, name: str) -> str:
        return f"{self._path.rstrip('/')}/{name}"

    def put(self, name: str, write: Write) -> str:
        """See :class:`Place`."""
        with tempfile.TemporaryDirectory() as folder:
            beside = Path(folder) / Path(name).name
            write(beside)
            content = beside.read_bytes()
        # in one piece: what interrupts it comes before or after, for leaving the block puts in place what was sent
        with self._files.open_output_stream(self._at(name)) as stream:
            stream.write(content)
        return sha256(content).hexdigest()

    def open(self, name: str) -> IO[bytes]:
        """See :class:`Place`."""
        return self._files.open_input_file(self._at(name))  # type: ignore[no-any-return]

    def state(self, name: str) -> tuple[int, int]:
        """See :class:`Place`."""
        found = self._files.get_file_info(self._at(name))
        if found.size is None:
            raise FileNotFoundError(f"{self.url}/{name}")
        return int(found.size), int(found.mtime_ns or 0)

    def names(self) -> list[str]:
        """See :class:`Place`."""
        from pyarrow import fs

        found = self._files.get_file_info(fs.FileSelector(self._path, allow_not_found=True))
        return [each.base_name for each in found if each.type == fs.FileType.File]

    def tidy(self) -> None:
        """See :class:`Place`: nothing is ever half-written."""

    def trouble(self) -> str | None:
        """Why nothing can be written there, or None."""
        name = f"_try-{secrets.token_hex(4)}"
        try:
            self.put(name, lambda beside: beside.write_bytes(b""))
            self._files.delete_file(self._at(name))
        except (OSError, ValueError) as error:  # Arrow's are ValueErrors where no store has such a path
            return f"cannot be written: {' '.join(str(error).split())}"
        return None

    @contextmanager
    def alone(self) -> Iterator[None]:
        """See :class:`Place`. Stores have no locks: who works there renews a small file, and who finds one looks whether
        that still happens. Two that begin in the same second may both go on: they write the same bytes."""
        mine = secrets.token_hex(8)
        if there := read_json(self, _BUSY):
            time.sleep(3 * _BEAT)
            now = read_json(self, _BUSY)
            if now and now != there:
                raise _occupied(self, f"{now.get('who')}: ")
        who, stop = f"{socket.gethostname()}, process {os.getpid()}", threading.Event()

        def beat() -> None:
            count = 0
            while True:
                with suppress(OSError):
                    put_json(self, _BUSY, {"who": who, "token": mine, "beat": count})
                count += 1
                if stop.wait(_BEAT):
                    return

        thread = threading.Thread(target=beat, daemon=True)
        thread.start()
        try:
            yield
        finally:
            stop.set()
            thread.join()
            if read_json(self, _BUSY).get("token") == mine:
                with suppress(OSError):
                    self._files.delete_file(self._at(_BUSY))


def _occupied(place: Place, who: str = "") -> InputError:
    return InputError(
        f"{arg('folder')}: {str(place)!r}: {who}another process is at work there: must be another folder, or wait"
    )
