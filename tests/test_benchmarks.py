"""The benchmarks' peers solve the same equations, and what is kept of the results is complete."""

import ast
import importlib.util
import json
import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

import stribeck

FOLDER = Path(__file__).parent.parent / "benchmarks"


@pytest.fixture(scope="module")
def problems():
    spec = importlib.util.spec_from_file_location("benchmark_problems", FOLDER / "problems.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


@pytest.mark.parametrize("v", [-0.3, -1e-3, -2e-8, 3e-7, 4e-4, 0.05])
def test_friction_of_the_peers_is_the_law(problems, v):
    p = problems
    law = stribeck.law("lugre_sobczyk", parameters="canudas1995", k_v=p.K_V)
    z = 0.7e-5
    dw_dt, force = p.friction_by(math)(v, p.SIGMA_0 * z, p.K_V, p.F_S)
    assert dw_dt == pytest.approx(p.SIGMA_0 * law.rate(v, z), rel=1e-12)
    assert force == pytest.approx(law.force(v, z), rel=1e-12)


@pytest.mark.parametrize("name", ["limit_cycle", "stick_slip"])
def test_peers_arrive_where_the_simulation_does(problems, name):
    from scipy.integrate import odeint

    problem = getattr(problems, name)(20.0, 0.5)
    y = stribeck.simulate(problem.scenario)["y"][problem.first_row :]
    ((_, _, constants),), rest = problem.pieces, 0.0 * problem.scales
    how = {"rtol": 1e-9, "atol": 1e-12, "tfirst": True, "mxstep": 10**5, "args": (constants,)}
    rows = odeint(problem.equations(math), rest, problem.times, **how)
    assert abs(rows[:, 0] - y).max() < 1e-5 * abs(y).max()
    assert abs(y).max() > 0.5


@pytest.mark.parametrize("name", ["single", "ensemble", "machines", "startup"])
def test_results_say_when_and_where(name):
    results = json.loads((FOLDER / "results" / f"{name}.json").read_text())
    assert {"date", "processor", "cores", "load", "compiler", "versions"} <= results["machine"].keys()


def test_a_benchmark_s_own_imports_exist():
    """One imported a neighbor by a name that it no longer had; three looked for tests/, which measure.py puts in reach."""
    here, missing = {path.stem for path in FOLDER.glob("*.py")}, set()
    for path in FOLDER.glob("*.py"):
        imports = [n for n in ast.parse(path.read_text()).body if isinstance(n, ast.Import | ast.ImportFrom)]
        names = [n.module if isinstance(n, ast.ImportFrom) else n.names[0].name for n in imports]
        of_tests = [i for i, name in enumerate(names) if name.startswith("tests.")]
        missing |= {path.name} if of_tests and "measure" not in names[: of_tests[0]] else set()
        bare = {n.module for n in imports if isinstance(n, ast.ImportFrom) and "." not in n.module} - here
        missing |= {(path.name, name) for name in bare if importlib.util.find_spec(name) is None}
    assert missing == set()


def test_every_script_is_of_a_family_or_imported():
    """What no family runs and no script imports is read by nobody."""
    process = subprocess.run(
        [sys.executable, FOLDER / "run.py", "--help"], capture_output=True, text=True, check=True, cwd=FOLDER
    ).stdout
    scripts = {path.stem: path.read_text() for path in FOLDER.glob("*.py")}
    named = set(re.findall(r"\w+", process)) & scripts.keys()
    imported = {
        name for name in scripts if any(re.search(rf"^(from|import) {name}\b", x, re.M) for x in scripts.values())
    }
    assert {"single", "verdicts", "estimates"} <= named
    assert scripts.keys() == named | imported | {"run"}


def test_every_result_is_of_a_script():
    text = " ".join(path.read_text() for path in FOLDER.glob("*.py"))
    assert [f.stem for f in (FOLDER / "results").glob("*.json") if f'"{f.stem}"' not in text] == []
