"""Every case whose output is kept."""

import itertools
from pathlib import Path

from tests.kept.calls import CALLS
from tests.kept.runner import EXACT, Case, commands


def read(text):
    """The cases of ``commands.txt``, whose first lines say how it is written."""
    given = [line for line in text.splitlines() if line and not line.startswith("#")]
    for i, line in enumerate(given):
        if line.startswith("== "):
            group, tolerance, backend, *_ = *line.split()[1:], *("", "")
        elif not line.startswith(" "):
            name, *star = line.split()
            words = [x.strip() for x in itertools.takewhile(lambda x: x.startswith(" "), given[i + 1 :])]
            yield commands(f"{group}/{name}", words, float(tolerance or EXACT), backend, bool(star))


CASES: list[Case] = [*read(Path(__file__).with_name("commands.txt").read_text(encoding="utf-8")), *CALLS]
