"""Where a command writes, and what it prints: its folder, checked before anything runs, and one JSON object."""

from __future__ import annotations

import json
import shlex
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from stribeck.constants import show as shown
from stribeck.errors import InputError, one_line, printable
from stribeck.files import misplaced, trouble

if TYPE_CHECKING:
    from stribeck.mouth.document import Document


@contextmanager
def output_folder(out: Path | None, reads: Sequence[Path] = (), writes: Sequence[str] = ()) -> Iterator[None]:
    """The folder of a command, created if missing, and removed again if the block leaves it empty.

    It must be writable. No file that is read may be replaced, and no folder may stand in a file's place.

    Args:
        out: the folder; None where nothing is to be written.
        reads: files that the command reads; ``writes``: names of what it will write.
    """
    made: list[Path] = []  # the innermost first
    try:
        if out is not None:
            if text := trouble(out, folder=True) or misplaced(out, writes):
                raise InputError(f"--out: {shown(str(out))}: {text}")
            for path in (path for name in writes for path in reads if _same_file(out / name, path)):
                text = f"{path.name}, which is read, would be replaced: must be another folder"
                raise InputError(f"--out: {shown(str(out))}: {text}")
            made = [folder for folder in (out, *out.parents) if not folder.exists()]
            try:
                out.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise InputError(f"--out: {shown(str(out))}: cannot be made: {error.strerror}") from None
        yield
    finally:
        for folder in made:
            with suppress(OSError):  # not empty
                folder.rmdir()


def check_file(option: str, path: Path, *reads: Path, parents: bool = False, new: bool = False) -> None:
    """Check, before anything runs, that a file can be written and is not read. With ``new``, it must not exist.

    Raises:
        InputError: with the reason.
    """
    text = trouble(path, parents=parents)
    if text is None and any(_same_file(path, each) for each in reads):
        text = "is read by this command: must be another file"
    if text is None and new and path.exists():
        text = "exists already; must be a new file"
    if text:
        raise InputError(f"{option}: {shown(str(path))}: {text}")


def _same_file(path: Path, other: Path) -> bool:
    """Whether both are one file, which exists."""
    try:
        return path.samefile(other)
    except (OSError, ValueError):
        return False


def print_json(data: object) -> None:
    """One JSON object; what is not finite becomes null, which JSON knows."""
    from stribeck.files import finite

    print(json.dumps(finite(data), allow_nan=False))


def tell(
    document: Callable[[], Document],
    data: Mapping[str, object] | None,
    files: Sequence[str] = (),
    verbose: bool = False,
) -> None:
    """Print ``data`` and the files that were written as JSON if ``data`` is given, else the document and the files."""
    if data is not None:
        print_json({**data, "files": files})
        return
    from stribeck.mouth import terminal

    terminal.tell(document(), files, verbose)


def command_line() -> str:
    """The command as it was given, for pages."""
    return printable("stribeck " + shlex.join(sys.argv[1:]))


def failed(what: str, reason: str | None) -> None:
    """Say on standard error that a computation failed, and why."""
    print(one_line(f"stribeck: {what} failed: {reason}; the part that was reached is kept"), file=sys.stderr)


def wrote(files: Iterable[object], more: str = "", *, error: bool = False) -> None:
    """Print a line for each file that was written, and more about it; on standard error if wanted."""
    for file in files:
        print(printable(f"wrote {file}{more}"), file=sys.stderr if error else sys.stdout)
