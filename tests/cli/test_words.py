"""What the command says: options for arguments, forms of laws told apart, nothing needless."""

import json
import re
from pathlib import Path

import pytest

import stribeck as library
from stribeck import examples


def test_no_library_module_speaks_of_options():
    package = Path(library.__file__).parent
    reported = re.compile(r"""(InputError|problems|found|note|append)\b.*["'({ ]--[a-z{]|["'].*\bwithout --[a-z]""")
    wrong = [
        f"{path.relative_to(package)}:{number}"
        for path in package.rglob("*.py")
        if path.relative_to(package).parts[0] != "cli"
        for number, line in enumerate(path.read_text().splitlines(), start=1)
        if reported.search(line)
    ]
    assert wrong == []


FORMS = ("law.name=lugre_majorant", "drive.observer.name=lugre_majorant", "drive.observer.smooth_abs=sqrt")


@pytest.mark.thorough
def test_design_tells_forms_of_a_law_apart(stribeck):
    changes = [word for change in FORMS for word in ("--set", change)]
    short = ("--set", "solve.t_end=0.2", "--v-max", "0.01")
    document = json.loads(stribeck("design", examples.path("servo"), *changes, *short, "--json").out)
    assert any(text.startswith("plant and observer differ") for text in document["not_covered"])
    assert "the controller is sampled" not in document["not_covered"]
    alike = json.loads(stribeck("design", examples.path("servo"), *changes[:-2], *short, "--json").out)
    assert not any(text.startswith("plant and observer differ") for text in alike["not_covered"])


def test_a_law_with_z_that_claims_nothing_is_not_said_to_have_no_state(stribeck, tmp_path):
    source = "from stribeck.laws import Claims\nfrom stribeck.laws.lugre import LuGre\n"
    source += "class Own(LuGre):\n    claims = Claims()\n"
    (tmp_path / "own.py").write_text(source)
    process = stribeck("library", f"{tmp_path}/own.py:Own")
    assert "claims: none stated" in process.out
    assert "no internal state" in stribeck("library", "stribeck").out
