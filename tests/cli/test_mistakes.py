"""What a user does wrong by hand: each ends in one clear line with status 2, or in a right result."""

import numpy as np

COLUMNS = ("--time", "t", "--position", "y", "--force", "F")


def written(path, t, y, force):
    rows = zip(t.tolist(), y.tolist(), force.tolist(), strict=True)
    path.write_text("t,y,F\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in rows))
    return path


def test_a_body_that_rests_throughout_has_no_friction_to_fit(stribeck, tmp_path):
    """The filter of a constant position leaves its rounding, 1e-15 m/s, of which F_c < 0.06 N was told beside 2 N that moved
    nothing."""
    t = 0.01 * np.arange(600)
    rest = written(tmp_path / "rest.csv", t, np.full(600, 0.1), 2 * np.sin(1.3 * t))
    for words in (
        (),
        ("--law", "coulomb_viscous"),
        ("--law", "lugre", "--method", "dynamic"),
        ("--law", "lugre", "--method", "presliding"),
    ):
        found = stribeck("fit", rest, *COLUMNS, *words, "--out", tmp_path / "out")
        assert (found.status, found.out) == (2, ""), found.err
        assert found.err == "--velocity: 0 throughout: nothing moves, so there is no friction to fit\n"
    assert not (tmp_path / "out").exists()


def test_reasons_of_several_laws_name_options(stribeck, tmp_path):
    """They named the arguments of Python: force_gain, terms."""
    t = 0.01 * np.arange(600)
    one_way = written(
        tmp_path / "one_way.csv", t, 0.1 * t - 0.02 * np.cos(3 * t), -1 - 3 * (0.1 + 0.06 * np.sin(3 * t))
    )
    found = stribeck("fit", one_way, *COLUMNS, "--law", "coulomb_viscous", "--law", "stribeck")
    assert found.status == 2, found.out
    assert "force_gain" not in found.err
    assert "--force-gain" in found.err
