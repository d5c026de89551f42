"""What is proved is what is simulated, what the documents name exists, and what is assumed is noticed."""

from __future__ import annotations

import re

import pytest

from stribeck.laws import builtin, lugre, terms
from stribeck.laws.base import BristleLaw
from tests.proofs.coq import FOLDER, compiles, needs_coq, script

DOCS = FOLDER.parent / "docs" / "explanation"


def test_the_equations_in_coq_are_those_of_the_laws():
    assert (FOLDER / "Laws.v").read_text() == script("generate").laws_text()


def test_a_changed_law_is_noticed(monkeypatch):
    law = builtin()["lugre"]
    monkeypatch.setattr(law, "dz_dt", staticmethod(lambda p, v, z: v - abs(v) / terms.g(p, v) * z * 2))
    assert (FOLDER / "Laws.v").read_text() != script("generate").laws_text()


def test_every_law_is_there():
    text = (FOLDER / "Laws.v").read_text()
    for name, law in builtin().items():
        assert (f"Module {name}." in text) == issubclass(law, BristleLaw), name


def test_generating_leaves_the_laws_as_they_were():
    before = type(lugre.e)
    script("generate").laws_text()
    assert type(lugre.e) is before


@pytest.mark.parametrize("document", ["theory.md", "proofs.md"])
def test_every_lemma_that_a_document_names_exists(document):
    stated = {name for _, name in script("check").theorems()}
    named = {
        name
        for group in re.findall(r"Coq: ([^)\]|]*)", (DOCS / document).read_text())
        for name in re.findall(r"`(\w+)`", group)
    }
    assert named
    assert named <= stated, sorted(named - stated)


def test_no_proof_is_left_open():
    for file in FOLDER.glob("*.v"):
        assert not re.search(r"\b(Admitted|admit|Axiom|Parameter|Conjecture|give_up)\b", file.read_text()), file.name


def test_every_claim_of_passivity_has_its_theorem():
    """A law that claims to be passive, and a new form of one, is proved or the test fails."""
    stated = {name for _, name in script("check").theorems()}
    text = (FOLDER / "Laws.v").read_text()
    modules = re.findall(r"^Module (\w+)\.(.*?)^End", text, re.MULTILINE | re.DOTALL)
    claiming = {name for name, body in modules if "claims_passive " in body}
    assert {f"{name}_passive" for name in claiming} <= stated
    assert {f"{name}_not_passive" for name in ("lugre_sobczyk", "elastoplastic_sobczyk")} <= stated


@needs_coq
def test_an_axiom_is_noticed(tmp_path):
    check = script("check")
    text = (
        "From Coq Require Import Reals.\nAxiom hidden : (0 > 1)%R.\nLemma all : (0 > 1)%R.\nProof. exact hidden. Qed.\n"
    )
    answer = compiles(f"{text}Print Assumptions all.\n", tmp_path)
    assert answer.returncode == 0, answer.stderr
    assert "hidden" in check.axioms(answer.stdout)
    assert check.axioms(answer.stdout) - check.ALLOWED == {"hidden"}
