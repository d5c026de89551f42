"""Prints the tables of the project's README from the results, in the form that its test compares with them."""

from __future__ import annotations

import json
from typing import Any

from measure import RESULTS

SINGLE = {
    "stribeck": "Stribeck, compiled",
    "stribeck, peers' atol": "Stribeck with the peers' kind of atol",
    "C prototype": "a hand-written C solver of the same method, `-ffast-math`",
    "numbalsoda": "numbalsoda (LSODA, compiled equations)",
    "CasADi CVODES": "CasADi (SUNDIALS CVODES)",
    "SciPy odeint, tuned": "SciPy odeint, Python equations tuned",
    "SciPy odeint": "SciPy odeint, Python equations",
    "solve_ivp LSODA": "SciPy solve_ivp LSODA",
    "scikit-sundae CVODE": "SUNDIALS CVODE through scikit-sundae",
    "diffrax Kvaerno3": "diffrax Kvaerno3 (compiled)",
    "diffrax Kvaerno5": "diffrax Kvaerno5 (compiled)",
    "solve_ivp Radau": "SciPy solve_ivp Radau",
}


def results(name: str) -> dict[str, Any]:
    """A file of results."""
    return json.loads((RESULTS / f"{name}.json").read_text())


def rows(lines: list[list[str]]) -> str:
    """A table in Markdown; the first line is its head."""
    head, *body = lines
    return "\n".join(f"| {' | '.join(line)} |" for line in [head, ["---"] * len(head), *body])


def main() -> None:
    """Print them."""
    single = results("single")
    measured = {line["solver"]: line for line in single["solvers"]}
    lines = [["solver", "ms", "/ Stribeck"]]
    for name, text in SINGLE.items():
        if name in measured:
            line = measured[name]
            lines.append([text, f"{line['milliseconds']['median']:.3g}", f"{line['ratio']['median']:.3g}"])
    print(f"limit cycle, {single['machine']['date'][:10]}, load {single['machine']['load']}\n\n{rows(lines)}\n")

    ensemble = results("ensemble")
    lines = [["1000 x 300 s of stick-slip", "ms of processor time a lane", "lanes/s", "scalar loop / this"]]
    for line in ensemble["solvers"]:
        keys = ("cpu_milliseconds", "trajectories_per_second", "cpu_ratio_to_scalar_loop")
        lines.append([line["solver"], *(f"{line[key]['median']:.3g}" for key in keys)])
    print(f"ensemble, {ensemble['machine']['date'][:10]}, load {ensemble['machine']['load']}\n\n{rows(lines)}\n")

    lines = [["MuJoCo's LuGre, stick-slip of 40 s", "ms", "error / range"]]
    for run in results("mujoco")["runs"]:
        how = (
            f"{run['integrator']}, step {1e3 * run['step_s']:g} ms" if "integrator" in run else f"rtol {run['rtol']:g}"
        )
        lines.append([f"{run['solver']}, {how}", f"{run['milliseconds']['median']:.3g}", f"{run['max_error']:.1e}"])
    print(rows(lines) + "\n")

    seconds = {case["case"]: case["seconds"]["median"] for case in results("startup")["cases"]}
    for case in ("stribeck --help", "run --json, cached", "run --json, new"):
        print(f"{case}: {seconds[case]:.3g} s")
    print(f"--out: {seconds['run --json --out, cached'] - seconds['run --json, cached']:.3g} s more")


if __name__ == "__main__":
    main()
