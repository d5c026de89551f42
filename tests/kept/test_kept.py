"""What commands and calls say and write is what is kept; ``python -m tests.kept`` renews it, and git shows what changed."""

import os
import re

import pytest

from tests.kept.cases import CASES
from tests.kept.runner import OUTPUTS

pytestmark = pytest.mark.skipif(os.name != "posix", reason="paths are kept as POSIX writes them")


@pytest.mark.parametrize("case", [pytest.param(c, id=c.name, marks=[pytest.mark.thorough] * c.thorough) for c in CASES])
def test_what_comes_out_is_what_is_kept(case, tmp_path):
    _, changed = case.differences(tmp_path)
    how = f"python -m tests.kept {case.name} renews it; with --whole it prints the code, to be compared with another checkout's"
    assert not changed, "\n".join([f"{case.name} ({how}):", *changed[:60]])


def test_nothing_is_kept_that_no_case_makes():
    assert set(OUTPUTS.rglob("*.txt")) == {case.path for case in CASES}


JARGON = re.compile(
    r"\b(dict|float|int|str|bool|None|NoneType|True|False|pydantic|[Ii]nput should|Traceback|\w+Error)\b"
)
REFUSED = [case for case in CASES if "refused" in case.name]


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: case.name)
def test_a_refusal_is_plain_lines_and_nothing_else(case):
    """A command that is refused prints its problems alone, each in a line without words of Python, and writes nothing."""
    refused = False
    for line in case.path.read_text(encoding="utf-8").splitlines():
        refused = line == "status 2" or (refused and line[:2] not in ("$ ", "--"))
        assert not refused or line == "status 2" or line.startswith("! "), line
        assert not (line.startswith("-- ") and case.name.startswith("refused/")), line
        assert len(line) <= 400
        message = line[2:] if line.startswith("! ") else line.partition(": ")[2]
        assert " --help)" in message or line[:2] in ("$ ", "==") or not JARGON.search(message), line
