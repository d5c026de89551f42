"""Machines through the command line: run, compare, sweep, new, show, and what is no machine's."""

import json

import pyarrow.parquet as parquet
import pytest

from stribeck import examples

NAMES = ("machine", "gear", "belt", "arm")


@pytest.mark.parametrize("name", NAMES)
def test_templates_run_as_they_are(stribeck, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    assert stribeck("new", name).status == 0
    done = stribeck("run", f"{name}.toml", "--set", "solve.t_end=0.3", "--out", "out", "--json")
    summary = json.loads(done.out)
    assert summary["status"] == "done"
    assert {"E_in", "E_stored", "E_dissipated"} < set(summary["peaks"])
    assert set(summary["contacts"]) <= set(summary["events"])
    assert "<svg" in (tmp_path / "out/plot.svg").read_text()
    assert json.loads((tmp_path / "out/summary.json").read_text())["events"] == summary["events"]


def test_what_run_prints(stribeck):
    done = stribeck("run", str(examples.path("belt")), "--set", "solve.t_end=1")
    assert "done: 2 bodies, contacts: sole lugre; 101 rows of 101" in done.out
    assert "sole: slip" in done.out
    assert "slider.y" in done.out


def test_the_generated_code_names_bodies_and_contacts(stribeck, tmp_path):
    stribeck("run", str(examples.path("gear")), "--set", "solve.t_end=0.01", "--keep-c", str(tmp_path / "x.c"))
    text = (tmp_path / "x.c").read_text()
    for words in ("rotor_y", "arm_v", "const real mesh_F =", "mesh_g", "mesh_load", "p->gear_stiffness", "p->mesh_F_c",
                  "Contact mesh: arm to ground, law elastoplastic_majorant."):  # fmt: skip
        assert words in text, words


def test_compare_at_a_contact(stribeck, tmp_path):
    words = ("run", str(examples.path("gear")), "--law", "lugre_majorant:k_v=1e5", "--law", "lugre")
    done = stribeck(*words, "--contact", "mesh", "--set", "solve.t_end=0.3", "--json", "--out", str(tmp_path))
    found = json.loads(done.out)
    assert found["laws"]["lugre"]["contacts"]["mesh"]["law"]["name"] == "lugre"
    assert set(found["laws"]["lugre"]["deviations"]) == {
        "rotor.y", "rotor.v", "arm.y", "arm.v", "bearing.F", "mesh.F", "gear.f",
    }  # fmt: skip
    refused = stribeck(*words)
    assert (refused.status, refused.out) == (2, "")
    assert "--contact: missing: must be given (one of bearing, mesh)" in refused.err
    assert "no such contact (did you mean 'mesh'?)" in stribeck(*words, "--contact", "mehs").err


def test_sweep(stribeck, tmp_path):
    words = (
        "sweep",
        str(examples.path("belt")),
        "--vary",
        "links.spring.stiffness=300:500:3",
        "--set",
        "solve.t_end=0.5",
    )
    assert stribeck(*words, "--summary", "--out", str(tmp_path / "s")).status == 0
    table = parquet.read_table(tmp_path / "s/part-000000.parquet")
    assert table["links.spring.stiffness"].to_pylist() == [300.0, 400.0, 500.0]
    assert "peak_sole.F" in table.column_names
    several = ("sweep", str(examples.path("arm")), "--vary", "contacts.seal.law.parameters.F_c=0.2:0.3:2", "--set",
               "solve.t_end=0.02", "--out", str(tmp_path / "u"))  # fmt: skip
    assert stribeck(*several).status == 0  # with two contacts, of which neither is the law
    assert stribeck(*words, "--out", str(tmp_path / "t")).status == 0
    assert len(parquet.read_table(tmp_path / "t/part-000000.parquet")) == 3 * 51


def test_show(stribeck, tmp_path):
    done = stribeck("run", str(examples.path("gear")), "--show", "--out", str(tmp_path / "gear"))
    assert (
        "gear  rotor --/\\/\\/-- arm  stiffness 9000 N m/rad, damping 3 N m s/rad, gap 0.0004 rad, ratio 0.01"
        in done.out
    )
    text = (tmp_path / "gear" / "machine.svg").read_text()
    for words in ("<svg", ">rotor<", ">mesh<", ">gear<", "gap 0.0004 rad"):
        assert words in text, words
    found = json.loads(stribeck("run", str(examples.path("arm")), "--show", "--json").out)
    assert [e["name"] for e in found["elements"] if e["kind"] == "controller"] == ["axis"]
    assert "~~~~~-- ground" in stribeck("run", str(examples.path("stick_slip")), "--show").out  # a single body too
    refused = stribeck("run", str(examples.path("arm")), "--show", "--keep-c", str(tmp_path / "arm.c"))
    assert (refused.status, refused.out) == (2, "")
    assert "--keep-c: must be left out with --show" in refused.err


@pytest.mark.parametrize(
    "words",
    [
        ("design", "{}", "--v-max", "1"),
        ("export", "--part", "body", "--scenario", "{}", "--target", "c", "--out", "x"),
        ("check", "lugre_majorant", "--parameters", "canudas1995", "--scenario", "{}", "--position-error", "1e-6"),
    ],
    ids=lambda words: words[0],
)
def test_what_takes_no_machine_says_so(stribeck, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    done = stribeck(*(word.format(examples.path("arm")) for word in words))
    assert (done.status, done.out) == (2, "")
    assert len(done.err.splitlines()) == 1, done.err
