"""What commands and calls say and write is what is kept; ``python -m tests.kept`` renews it, and git shows what changed."""

import os

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
