"""``stribeck check --creep`` and the other tolerances."""

from __future__ import annotations

import json


def test_verdicts_are_on_the_k_v_that_is_needed_unless_one_is_given(stribeck):
    words = ("check", "lugre_sobczyk", "--parameters", "canudas1995", "--creep", "1e-6", "--json")
    result = json.loads(stribeck(*words).out)
    assert result["constants"]["k_v"] == result["steepness"]["lugre_sobczyk"]["k_v"]
    given = json.loads(stribeck(*words, "--set", "k_v=2e7").out)
    assert given["constants"]["k_v"] == 2e7
