"""What more than one room of tests asks of the machine: shared inputs, links in folders, every place of a file's data."""

from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

SHARED = Path(__file__).parent.parent.parent / "shared"


def _follows_links():
    with TemporaryDirectory() as folder:
        link, target = Path(folder) / "link", Path(folder) / "target"
        target.touch()
        try:
            link.symlink_to(target)
        except OSError:
            return False
        return link.is_file()


LINKS = _follows_links()  # Windows lets not every user make them, and wine none
needs_links = pytest.mark.skipif(not LINKS, reason="needs links in folders")


def places(data, path=()):
    """The paths of all fields and items."""
    inner = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, x in inner:
        yield (*path, key)
        yield from places(x, (*path, key))
