"""What more than one room of tests asks of the machine: shared inputs, links in folders."""

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
