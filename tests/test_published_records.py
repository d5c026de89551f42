"""The table of docs/evidence/records.md: each row's command run as it stands, and its numbers compared."""

import json
import re
import shlex
from pathlib import Path

import pytest

from stribeck.cli import _status
from tests.shared import SHARED

DATA = SHARED / "data"
PAGE = (Path(__file__).parent.parent / "docs" / "evidence" / "records.md").read_text(encoding="utf-8")
TABLE = PAGE[PAGE.index("    E='") : PAGE.index("EMPS: Janot")]
ROWS = re.findall(r"^\| `([^`]*)` \| (.*) \|$", TABLE, re.M)
SHORT = dict(re.findall(r"^    ([A-Z]+)='(.*)'$", TABLE, re.M))


def test_the_table_has_every_record():
    assert len(ROWS) == 8
    text = " ".join(command for command, _ in ROWS)
    for name in ("DATA_EMPS.mat", "sysid", "direct_collocation", "energy_shaping", "257_3bar", "257_?bar"):
        assert name in text


@pytest.mark.share(15)
@pytest.mark.skipif(not DATA.is_dir(), reason="needs shared/data, which is not part of the project")
@pytest.mark.parametrize(("command", "numbers"), ROWS, ids=[command[:40] for command, _ in ROWS])
def test_a_row_is_what_its_command_prints(command, numbers, monkeypatch, capsys):
    monkeypatch.chdir(DATA)
    for short, words in SHORT.items():
        command = command.replace(f"${short}", words)
    words = [str(p) for word in shlex.split(command) for p in (sorted(Path().glob(word)) if "?" in word else [word])]
    assert _status(["fit", *words, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    values = [document["relative_force_error"], document["friction_error"], document["cross_validated_error"]]
    law, *cells = (cell.strip() for cell in numbers.split("|"))
    assert law == document["law"]
    seen = [min(100 * x, 100.0) for x in values]  # beyond it nothing is predicted, and rounding may choose the model
    assert [float(cell.split()[0]) for cell in cells] == pytest.approx(seen, abs=0.011, rel=2e-3)
