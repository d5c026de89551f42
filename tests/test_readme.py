"""Every command and every Python line of the README works as it stands."""

import json
import re
import shlex
from pathlib import Path

import pytest

from stribeck.cli import _status

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.S)


def test_commands(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    commands = [line for line in blocks("sh")[1].splitlines() if line]
    assert len(commands) == 17
    for command in commands:
        words = shlex.split(command, comments=True)
        assert words[0] == "stribeck"
        assert _status(words[1:]) == 0, command
    assert sorted(p.name for p in (tmp_path / "first").iterdir()) == [
        "plot.pdf", "plot.png", "plot.svg", "report.html", "summary.json", "trajectory.csv", "trajectory.parquet",
    ]  # fmt: skip
    assert (tmp_path / "laws" / "compare.svg").exists()
    for file in ("found/passive.toml", "servo/trajectory.csv", "fit/parameters.toml", "firmware/lugre_majorant_test.c"):
        assert (tmp_path / file).exists(), file
    assert (tmp_path / "grid" / "part-000000.parquet").exists()
    assert "self-test  passed" in capsys.readouterr().out


def test_python(capsys):
    pytest.importorskip("pandas")
    code = blocks("python")[0]
    scope = {}
    exec(compile(code, "README.md", "exec"), scope)
    assert scope["solution"].status == "done"
    assert len(scope["solution"].to_pandas()) == 4001
    assert scope["lanes"]["y"].shape == (16, 4001)
    assert "done" in capsys.readouterr().out


def test_machine(tmp_path, monkeypatch, capsys):
    """The commands of the section on machines, and the numbers that it gives."""
    from stribeck.export.fmu import binaries

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(binaries, "_ACROSS", ())
    monkeypatch.setattr(binaries, "_FLAGS", ("-std=c99", "-O0", "-shared", "-fvisibility=hidden"))
    for command in blocks("sh")[2].splitlines():
        words = shlex.split(command, comments=True)[1:]
        if words[0] in ("compare", "sweep", "export") or "--set" in words:  # the numbers are those of the first run
            words += ["--set", "solve.t_end=0.05"]
        assert _status(words) == 0, command
    for file in (
        "arm.svg",
        "arm/report.html",
        "seals/compare.svg",
        "seal_sweep/part-000000.parquet",
        "arm.fmu",
        "axis/arm_axis.c",
    ):
        assert (tmp_path / file).exists(), file
    found = json.loads((tmp_path / "arm/summary.json").read_text())
    end, seal = found["final"], found["events"]["seal"]
    text = " ".join(README.split())
    assert abs(end["rotor.y"] - 50) < 2 * 1.5339807878856412e-3
    for words in (
        f"The motor's encoder comes to {end['rotor.y']:.3f} rad",
        f"stands at {end['arm.y']:.5f} rad",
        f"wind the gear up by {1e3 * end['gear.f'] / 4e3:.2f} mrad",
        f"begins to slip at {seal['slip'][0]:.3f} s and sticks at {seal['stick'][0]:.3f} s",
    ):
        assert words in text, words
    capsys.readouterr()
    scope = {}
    exec(compile(blocks("python")[1].replace("t_end=1.5", "t_end=0.15"), "README.md", "exec"), scope)
    assert scope["lanes"].status == ["done"] * 3
    assert scope["tight"].to_dict()["contacts"]["seal"]["law"]["parameters"]["F_c"] == 0.4
    assert "flank_up" in capsys.readouterr().out


def test_commands_of_the_page_on_sweeps(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = (Path(__file__).parent.parent / "docs" / "sweeps.md").read_text(encoding="utf-8")
    assert _status(["new", "my_rig"]) == 0
    exec(re.findall(r"```python\n(.*?)```", text, re.S)[0], {})
    for command in re.findall(r"^stribeck .*$", text, re.M):
        if "--cluster" not in command:  # a cluster's address
            assert _status(shlex.split(command, comments=True)[1:]) == 0, command
    assert "(9, 4001)" in capsys.readouterr().out


def test_make_targets_exist():
    makefile = (Path(__file__).parent.parent / "Makefile").read_text()
    for line in blocks("sh")[0].splitlines():
        target = line.split()[1]
        assert re.search(rf"^{target}:", makefile, re.M)


def test_links_lead_somewhere():
    root = Path(__file__).parent.parent
    for link in re.findall(r"\]\((?!http)([^)#]+)\)", README):
        assert (root / link).exists(), link


# LuGre's condition, sigma_1 (F_s - F_c) <= sigma_2 F_c, fails and holds; and without bristle damping
MACHINE = {"sigma_0": 4e4, "sigma_1": 90.0, "sigma_2": 3.0, "F_c": 2.0, "F_s": 3.2, "v_s": 2e-3}
PASSIVE = {  # by what the table says: the verdicts with these three
    "yes": [True, True, True], "no": [False] * 3, "only for sigma_1 = 0": [False, False, True],
    "sigma_1 (F_s - F_c) <= sigma_2 F_c": [False, True, True], "as `lugre`": [False, True, True],
    "as `lugre`, with k_v >= 2 sigma_1/(pi F_s)": [False, True, True], "as `lugre_majorant`": [False, True, True],
}  # fmt: skip


def test_table_of_laws_is_what_check_finds():
    from stribeck.properties import WORK, check
    from stribeck.properties.checked import Checked
    from tests.properties.test_properties import KNOWN, law_with

    rows = re.findall(r"^\| `(\w+)`[^|]*\| (\w+) \| (\w+) \| ([^|]+) \| ([^|]+) \|$", README, re.M)
    fails = {name: check(law_with(name, MACHINE)) for name in KNOWN}
    holds, undamped = (
        {name: Checked(law_with(name, MACHINE, **changes), None, WORK).passive().holds for name in KNOWN}
        for changes in ({"sigma_2": 55.0}, {"sigma_1": 0.0})
    )
    assert {row[0] for row in rows} == set(fails)
    for name, smooth, bounded, is_passive, drift_free in rows:
        found = fails[name]
        assert found["unique"].holds, name
        assert found["smooth"].holds is (smooth == "yes"), name
        assert found["bounded"].holds is (bounded == "yes"), name
        assert found["drift_free"].holds is (drift_free == "below sigma_0 z_ba"), name
        assert [found["passive"].holds, holds[name], undamped[name]] == PASSIVE[is_passive], name
        if drift_free != "no":
            law = found.law
            assert found["drift_free"].evidence["F_0"] == pytest.approx(law.p.sigma_0 * law.p.z_ba)


NAMES = {
    "Stribeck, compiled": "stribeck",
    "Stribeck with the peers' kind of atol": "stribeck, peers' atol",
    "a hand-written C solver of the same method, `-ffast-math`": "C prototype",
    "numbalsoda (LSODA, compiled equations)": "numbalsoda",
    "CasADi (SUNDIALS CVODES)": "CasADi CVODES",
    "SciPy odeint, Python equations tuned": "SciPy odeint, tuned",
    "SciPy odeint, Python equations": "SciPy odeint",
    "SciPy solve_ivp LSODA": "solve_ivp LSODA",
    "SUNDIALS CVODE through scikit-sundae": "scikit-sundae CVODE",
    "diffrax Kvaerno3 (compiled)": "diffrax Kvaerno3",
    "diffrax Kvaerno5 (compiled)": "diffrax Kvaerno5",
    "SciPy solve_ivp Radau": "solve_ivp Radau",
}


def test_speed_is_what_the_benchmark_measured():
    folder = Path(__file__).parent.parent / "benchmarks" / "results"
    single, startup = (json.loads((folder / f"{name}.json").read_text()) for name in ("single", "startup"))
    measured = {row["solver"]: row for row in single["solvers"] if row.get("milliseconds")}
    rows = re.findall(r"^\| ([^|]+) \| ([\d.e+]+) \| ([\d.e+]+) \|$", README, re.M)
    assert [row[0] for row in rows] == list(NAMES)
    for name, milliseconds, ratio in rows:
        row = measured[NAMES[name]]
        assert (milliseconds, ratio) == (f"{row['milliseconds']['median']:.3g}", f"{row['ratio']['median']:.3g}")
    assert single["machine"]["date"][:10] in README
    lanes = json.loads((folder / "ensemble.json").read_text())
    cost = {row["solver"]: row["cpu_milliseconds"] for row in lanes["solvers"]}
    cost = {name: x["median"] if isinstance(x, dict) else x for name, x in cost.items()}
    own = cost["stribeck, 1 thread"]
    assert f"takes {own:.3g} ms of processor time a lane" in README
    for other, words in (("stribeck, scalar loop", "{:.0f} times the same lanes"), ("numbalsoda", "{:.0f} times numbalsoda"),
                         ("diffrax vmap", "{:.0f} times diffrax vmap")):  # fmt: skip
        assert words.format(cost[other] / own) in README
    assert f"same method {cost['C++ prototype, 1 thread']:.3g})" in README
    seconds = {case["case"]: case["seconds"]["median"] for case in startup["cases"]}
    for case in ("stribeck --help", "run --json, cached", "run --json, new"):
        assert f"{seconds[case]:.3g} s" in README
    extra = seconds["run --json --out, cached"] - seconds["run --json, cached"]
    assert f"{extra:.3g} s more" in README
    assert all(case["peak_megabytes"] < 200 for case in startup["cases"])
