"""``stribeck explore`` as a user calls it."""

import base64
import html
import json
from pathlib import Path

from stribeck import examples
from stribeck.laws import builtin
from tests.cli.conftest import stribeck  # noqa: F401


def test_the_page_stands_alone_and_is_small(built, data):
    text = built.read_text()
    assert "http://" not in text.replace("http://www.w3.org", "")
    assert "src=" not in text.split("<script type")[0]
    modules = [len(base64.b64decode(law["wasm"])) for law in data["laws"].values()]
    rest = (len(builtin()) - len(modules)) * (4 / 3 * max(modules) + 6000)
    assert built.stat().st_size + rest < 1.5e6
    figures = json.dumps(data["figures"])  # the charts over time have one toolbar
    counts = {'"logo": null': 8, '"toolbar_location": null': 3, '"name": "Span"': 16, '"name": "LegendItem"': 13}
    assert {text: figures.count(text) for text in counts} == counts
    paths = {n["path"] for n in (*data["numbers"], *data["laws"]["lugre_majorant"]["numbers"])}
    assert {"law.k_v", "law.parameters.F_s", "plant.mass", "plant.initial.z", "drive.stiffness", "drive.signal.rate",
            "solve.t_end", "solve.rtol", "output.step"} <= paths  # fmt: skip


def test_the_command_writes_a_page(stribeck, tmp_path):  # noqa: F811
    out = tmp_path / "mine.html"
    name = "{{ script }} {{ version }} </script>"  # what fills the page is data, and not a part of its text
    process = stribeck(
        "explore", examples.path("stick_slip"), "--set", "law.name=lugre_majorant", "--law", "lugre", "--out", out,
        "--set", f"name={name}",
    )  # fmt: skip
    assert (process.status, process.err, "open" in process.out) == (0, "", True)
    text = out.read_text()
    assert f"<h1>{html.escape(name)}</h1>" in text
    data = json.loads(text.partition('<script type="application/json" id="data">')[2].partition("</script>")[0])
    assert data["name"] == name


def test_a_law_in_a_file_is_seen_from_the_working_directory(stribeck, tmp_path, monkeypatch):  # noqa: F811
    law = (Path(__file__).parents[2] / "docs/howto/own-law.md").read_text(encoding="utf-8")
    (tmp_path / "mylaw.py").write_text(law.partition("```python\n")[2].partition("```")[0], encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    process = stribeck("explore", "mylaw.py:RootLuGre", "--law", "lugre", "--out", "page.html")
    assert (process.status, process.err) == (0, "")
