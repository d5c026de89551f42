"""The figures of the results, in the style of the project's own; drawn anew from the JSON by `python figures.py`."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from measure import RESULTS, say

from stribeck.files import write_text
from stribeck.report import plots

MARKERS = "osDv^PX"


def line(axis: Any, i: int, x: list[float], y: list[float], label: str) -> None:
    """A line with marks at what was measured."""
    plots.line(axis, i, x, y, label, marker=MARKERS[i % len(MARKERS)], markersize=3.5)


def logarithmic(axis: Any, x: str, y: str) -> None:
    """Logarithmic axes with names."""
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel(x)
    axis.set_ylabel(y)


def precision(results: dict[str, Any]) -> str:
    """Time against error, a panel for each problem."""
    names = [problem["problem"] for problem in results["problems"]]
    made, axes = plots.figure([names], 3.9)
    order = list(dict.fromkeys(s["solver"] for problem in results["problems"] for s in problem["solvers"]))
    for problem in results["problems"]:
        axis = axes[problem["problem"]]
        for solver in problem["solvers"]:
            points = [p for p in solver["points"] if p["error"]]
            x, y = [p["error"] for p in points], [p["milliseconds"] for p in points]
            line(axis, order.index(solver["solver"]), x, y, solver["solver"])
        least = problem["least_error"]
        axis.axvline(least, color=plots.GREY, linewidth=0.8)
        logarithmic(axis, "largest error of y (part of its range)", "processor time (ms)")
        axis.invert_xaxis()
        axis.set_title({"limit_cycle": "limit cycle", "stick_slip": "stick-slip"}[problem["problem"]])
    plots.legend(made, axes[names[0]])
    return plots.svg(made)


def scaling(results: dict[str, Any]) -> str:
    """Time against the length of a run, and against the number of lanes."""
    made, axes = plots.figure([["length", "lanes"]], 3.6)
    for what, size, x, y in (
        ("length", "seconds", "length of the run (s of simulated time)", "processor time (ms)"),
        ("lanes", "lanes", "lanes", "processor time a lane (ms)"),
    ):
        for i, name in enumerate(dict.fromkeys(entry["solver"] for entry in results[what])):
            by_wall = "threads" in name
            if by_wall and busy(results):
                continue
            mine = [entry for entry in results[what] if entry["solver"] == name]
            clock = "wall_milliseconds" if by_wall else "cpu_milliseconds"
            cost = [entry[clock] / (entry[size] if what == "lanes" else 1) for entry in mine]
            line(axes[what], i, [entry[size] for entry in mine], cost, f"{name} (wall)" if by_wall else name)
        logarithmic(axes[what], x, y)
        axes[what].legend(fontsize=8)
    axes["length"].set_title("limit cycle")
    axes["lanes"].set_title("stick-slip, 300 s a lane")
    return plots.svg(made)


def busy(results: dict[str, Any]) -> bool:
    """Whether other processes kept the machine so busy that time on the wall means nothing."""
    machine = results["machine"]
    return bool(machine["load"]) and machine["load"][0] > 1.5 * machine["cores"]


def bars(axis: Any, values: dict[str, float]) -> None:
    """Horizontal bars on a logarithmic axis, each with its figure; this project's are blue."""
    names, lengths = list(values), list(values.values())
    colours = [plots.COLOURS[2] if name.startswith("stribeck") else plots.GREY for name in names]
    axis.barh(range(len(names)), lengths, color=colours, height=0.65)
    axis.set_yticks(range(len(names)), names)
    axis.invert_yaxis()
    axis.set_xscale("log")
    axis.set_xlim(min(lengths) / 2, max(lengths) * 3)
    axis.grid(visible=False, axis="y")
    for i, value in enumerate(lengths):
        axis.text(value * 1.1, i, f"{value:.0f}" if value >= 100 else f"{value:.3g}", va="center")


def ensemble(results: dict[str, Any]) -> str:
    """Trajectories a second of processor time; for several threads, a second on the wall."""
    made, axes = plots.figure([["rate"]], 2.6)
    rates = {}
    for entry in results["solvers"]:
        name = entry["solver"]
        if "threads" not in name:
            rates[name] = 1e3 / entry["cpu_milliseconds"]["median"]
        elif not busy(results):
            rates[f"{name} (wall)"] = entry["trajectories_per_second"]["median"]
    bars(axes["rate"], rates)
    axes["rate"].set_xlabel("trajectories a second of processor time (stick-slip, 300 s each)")
    return plots.svg(made)


def single(results: dict[str, Any]) -> str:
    """Milliseconds of one limit cycle."""
    made, axes = plots.figure([["time"]], 3.6)
    times = {entry["solver"]: entry["milliseconds"]["median"] for entry in results["solvers"]}
    bars(axes["time"], times)
    axes["time"].set_xlabel("time for one limit cycle of 250 s, error 1e-6 of the range (ms)")
    return plots.svg(made)


def mujoco(results: dict[str, Any]) -> str:
    """Time against error of MuJoCo's integrators and of this project."""
    made, axes = plots.figure([["cost"]], 3.2)
    groups: dict[str, list[dict[str, Any]]] = {}
    for run in results["runs"]:
        groups.setdefault(f"MuJoCo, {run['integrator']}" if "integrator" in run else run["solver"], []).append(run)
    for i, (name, runs) in enumerate(groups.items()):
        x, y = [run["max_error"] for run in runs], [run["milliseconds"]["median"] for run in runs]
        line(axes["cost"], i, x, y, name)
        for run in runs:
            if run.get("integrator") == "implicitfast":  # its points lie apart
                at = (run["max_error"], run["milliseconds"]["median"])
                step = f"{1e3 * run['step_s']:g} ms"
                axes["cost"].annotate(step, at, textcoords="offset points", xytext=(-6, -3), ha="right", fontsize=8)
    logarithmic(axes["cost"], "largest error of y (part of its range)", "processor time (ms)")
    axes["cost"].invert_xaxis()
    axes["cost"].set_xlim(left=0.6)
    plots.legend(made, axes["cost"])
    return plots.svg(made)


FIGURES: dict[str, Callable[[dict[str, Any]], str]] = {
    "single": single,
    "ensemble": ensemble,
    "precision": precision,
    "scaling": scaling,
    "mujoco": mujoco,
}


def draw(name: str, results: Path) -> None:
    """The figure of a benchmark's file of results, beside it."""
    with plots.style():
        text = FIGURES[name](json.loads(results.read_text()))
    write_text(results.with_suffix(".svg"), text)


def main() -> None:
    """All figures whose results are there."""
    for name in FIGURES:
        if (file := RESULTS / f"{name}.json").is_file():
            draw(name, file)
            say(file.with_suffix(".svg").name)


if __name__ == "__main__":
    main()
