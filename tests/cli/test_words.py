"""What the command says: options for arguments, nothing needless."""

import re
from pathlib import Path

import stribeck as library


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


def test_a_law_with_z_that_claims_nothing_is_not_said_to_have_no_state(stribeck, tmp_path):
    source = "from stribeck.laws import Claims\nfrom stribeck.laws.lugre import LuGre\n"
    source += "class Own(LuGre):\n    claims = Claims()\n"
    (tmp_path / "own.py").write_text(source)
    process = stribeck("library", f"{tmp_path}/own.py:Own")
    assert "claims: none stated" in process.out
    assert "no internal state" in stribeck("library", "stribeck").out
