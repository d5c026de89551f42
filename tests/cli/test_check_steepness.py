"""``stribeck check --creep`` and the other tolerances."""

from __future__ import annotations

import json

import pytest

from stribeck.mouth.cells import rounded_up


def test_verdicts_are_on_the_k_v_that_is_needed_unless_one_is_given(stribeck):
    words = ("check", "lugre_sobczyk", "--parameters", "canudas1995", "--creep", "1e-6", "--json")
    result = json.loads(stribeck(*words).out)
    assert result["constants"]["k_v"] == result["steepness"]["lugre_sobczyk"]["k_v"]
    given = json.loads(stribeck(*words, "--set", "k_v=2e7").out)
    assert given["constants"]["k_v"] == 2e7


@pytest.mark.parametrize(
    ("x", "text"), [(0.0, "0"), (1.0, "1"), (1.0001, "1.001"), (12706204.7, "1.271e+07"), (3e-5, "3e-05")]
)
def test_numbers_are_rounded_up(x, text):
    assert rounded_up(x) == text
