"""The commands and the C of docs/reference/exports.md, docs/howto/simulink.md and docs/tutorials/firmware.md."""

import re
import shlex
import subprocess
from pathlib import Path

import pytest

from stribeck.cli import _status
from stribeck.exports import TARGETS
from tests.exports.harness import STRICT, need

DOCS = Path(__file__).parent.parent.parent / "docs"


def blocks(page, language):
    return re.findall(rf"```{language}\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.S)


@pytest.mark.parametrize("page", ["reference/exports.md"])
def test_commands(page, tmp_path, monkeypatch):
    need("cc")
    monkeypatch.chdir(tmp_path)
    for line in "\n".join(blocks(page, "sh")).splitlines():
        words = shlex.split(line, comments=True)
        if words and words[0] == "stribeck":
            assert _status(words[1:]) == 0, line
        elif words:
            subprocess.run(words, check=True)


def test_c_of_the_pages_compiles_and_runs(tmp_path):
    need("gcc")
    export = ["export", "lugre_majorant", "--parameters", "canudas1995", "--set", "k_v=1e6"]
    assert _status([*export, "--target", "c", "--out", str(tmp_path)]) == 0
    (first,) = blocks("reference/exports.md", "c")
    start, output = (re.sub(r"\s+", " ", each) for each in blocks("howto/simulink.md", "c"))
    (tmp_path / "main.c").write_text(f"""{first}
#include <stdio.h>
int main(void)
{{
    lugre_majorant_parameters p;
    lugre_majorant_state s;
    double F = 0, G = 0;
    const double v = 2e-4;
    {start}
    for (int i = 0; i < 20; ++i) {{
        {output}
        G = friction_of_axis(v);
    }}
    printf("%.17g %.17g\\n", F, G);
    return 0;
}}
""")
    files = ["main.c", "lugre_majorant.c"]
    strict = [flag for flag in STRICT if flag != "-Werror"]
    command = ["gcc", *strict, "-Wno-missing-prototypes", *files, "-o", "main", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    done = subprocess.run(["./main"], cwd=tmp_path, capture_output=True, text=True, check=True)
    F, G = map(float, done.stdout.split())
    assert F == G
    assert 0.3 < F < 0.5  # 4 um on 1e5 N/m, with damping


def test_c_of_the_tutorial_compiles(tmp_path):
    need("gcc")
    assert _status(["new", "machine", "--out", str(tmp_path / "machine.toml")]) == 0
    export = ["export", str(tmp_path / "machine.toml"), "--part", "compensator", "--step", "2.5e-4", "--target", "c"]
    assert _status([*export, "--out", str(tmp_path)]) == 0
    (code,) = blocks("tutorials/firmware.md", "c")
    (tmp_path / "call.c").write_text(code)
    strict = [flag for flag in STRICT if flag != "-Wmissing-prototypes"]
    subprocess.run(
        ["gcc", *strict, "-Wno-missing-prototypes", "-c", "call.c", "-o", "call.o"], cwd=tmp_path, check=True
    )


def test_the_table_of_targets_names_the_parts_of_each():
    rows = re.findall(
        r"^\| (`[^|]*`) \| [^|]* \| ([a-z, ]*) \| ", (DOCS / "reference/exports.md").read_text(encoding="utf-8"), re.M
    )
    stated = {name: set(parts.split(", ")) for names, parts in rows for name in re.findall(r"`(\w+)`", names)}
    assert stated == {name: set(target.parts) for name, target in TARGETS.items()}
