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
