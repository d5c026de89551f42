"""stribeck check: what it finds holds when it is replayed; claims are answered."""

import json
from pathlib import Path

import pytest

from stribeck.properties import NAMES

ROOT = Path(__file__).parents[2]

SOBCZYK = ("check", "lugre_sobczyk", "--parameters", "canudas1995", "--set", "k_v=1e7")


def test_a_counterexample_is_replayed_by_run(stribeck, tmp_path):
    result = stribeck(*SOBCZYK, "--v-max", "1e-5", "--out", tmp_path, "--verify", "--json")
    assert result.status == 0
    data = json.loads(result.out)
    verdicts = data["properties"]
    assert list(verdicts) == list(NAMES)
    assert [v["holds"] for v in verdicts.values()] == [True, True, True, False, False]
    assert all(v["verified"] for v in verdicts.values())
    assert [Path(f).name for f in data["files"] if f.endswith(".toml")] == ["passive.toml", "drift_free.toml"]
    passive, drift = (
        json.loads(stribeck("run", tmp_path / f"{n}.toml", "--json").out) for n in ("passive", "drift_free")
    )
    evidence = verdicts["passive"]["evidence"]
    assert -passive["final"]["E_in"] == pytest.approx(evidence["energy_drawn"], rel=1e-6)
    assert passive["final"]["z"] == pytest.approx(evidence["z_start"], rel=1e-6)
    assert passive["peaks"]["v"] <= 1e-5
    assert evidence["energy_drawn"] > 0
    assert drift["final"]["y"] == pytest.approx(verdicts["drift_free"]["evidence"]["distance"], rel=1e-6)
    assert drift["peaks"]["u"] < 1.5


@pytest.mark.thorough
def test_a_law_of_the_users_own_is_replayed_from_anywhere(stribeck, tmp_path):
    name = f"{ROOT / 'tests' / 'properties' / 'broken_laws.py'}:NegativeDamping"
    data = json.loads(stribeck("check", name, "--parameters", "canudas1995", "--out", tmp_path, "--json").out)
    assert data["properties"]["passive"]["holds"] is False
    replayed = json.loads(stribeck("run", tmp_path / "passive.toml", "--trust", "--json").out)
    assert -replayed["final"]["E_in"] == pytest.approx(
        data["properties"]["passive"]["evidence"]["energy_drawn"], rel=1e-6
    )


def static_law(folder, claims, force):
    (folder / "mine.py").write_text(
        "from stribeck.laws import Claims, StaticLaw\n\n\nclass Mine(StaticLaw):\n    name = 'mine'\n"
        f"    uses = ('F_c', 'sigma_2')\n    claims = Claims({claims})\n\n    @staticmethod\n"
        f"    def friction(p, v, z, dz_dt):\n        return {force}\n"
    )
    return "check", f"{folder / 'mine.py'}:Mine", "--set", "F_c=1", "--set", "sigma_2=0.1"


def test_passivity_of_a_law_without_z_is_decided(stribeck, tmp_path):
    """A law that drives between 1 and 2 m/s: F v = v^2 (v^2 - 3 |v| + 2) is -0.25 v^2 at 1.5 m/s."""
    law = static_law(tmp_path, "passive=True, unique=True", "p.sigma_2 * v * (v * v - 3 * (v * v)**0.5 + 2)")
    process = stribeck(*law, "--verify", "--json")
    verdicts = json.loads(process.out)["properties"]
    assert {name for name, each in verdicts.items() if each["holds"] is None} == set(verdicts) - {"passive"}
    assert "no internal state z" in verdicts["unique"]["evidence"]["reason"]
    assert verdicts["passive"]["holds"] is False
    v, force = (verdicts["passive"]["evidence"][name] for name in "vF")
    assert 1 < abs(v) < 2
    assert force == pytest.approx(0.1 * v * (v * v - 3 * abs(v) + 2))
    assert "claims: passive: True: is refuted" in process.err
    slow = stribeck(*law, "--v-max", "0.5", "--verify").out
    assert "NOT CONFIRMED" not in slow
    assert "proved for |v| up to 0.5 m/s: passive" in " ".join(slow.split())


def test_verify_notes_what_has_no_certificate(stribeck, tmp_path):
    law = static_law(tmp_path, "passive=True", "p.sigma_2 * v")
    assert "--verify: passive: not verified" in stribeck(*law, "--verify").err
    assert "--verify" not in stribeck(*law).err
    assert "--verify" not in stribeck("check", "lugre", "--parameters", "canudas1995", "--verify").err
