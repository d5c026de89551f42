"""``stribeck check --creep`` and the other tolerances."""

from __future__ import annotations

import json


def test_verdicts_are_on_the_k_v_that_is_needed_unless_one_is_given(stribeck):
    words = ("check", "lugre_sobczyk", "--parameters", "canudas1995", "--creep", "1e-6", "--json")
    result = json.loads(stribeck(*words).out)
    assert result["constants"]["k_v"] == result["steepness"]["lugre_sobczyk"]["k_v"]
    given = json.loads(stribeck(*words, "--set", "k_v=2e7").out)
    assert given["constants"]["k_v"] == 2e7


def test_two_tolerances_have_a_panel_each(stribeck, tmp_path):
    words = ("--creep", "1e-6", "--steady-error", "0.01", "--speed", "1e-4", "--out", tmp_path / "out")
    assert stribeck("check", "lugre_sobczyk", "--parameters", "canudas1995", *words).status == 0
