"""The figures of the results, in the style of the project's own; drawn anew from the JSON by `python figures.py`."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from measure import RESULTS, say

from stribeck.report import plots
from stribeck.report.files import write_text

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
        axis.set_title(problem["problem"].replace("_", " "))
    plots.legend(made, axes[names[0]])
    return plots.svg(made)


def scaling(results: dict[str, Any]) -> str:
    """Time against the length of a run, and against the number of lanes."""
    made, axes = plots.figure([["length", "lanes"]], 3.6)
    for what, size, x in (
        ("length", "seconds", "length of the run (s of simulated time)"),
        ("lanes", "lanes", "lanes"),
    ):
        lines, axis = results[what], axes[what]
        for i, name in enumerate(dict.fromkeys(entry["solver"] for entry in lines)):
            own = [entry for entry in lines if entry["solver"] == name]
            share = [1 if what == "length" else entry[size] for entry in own]
            clock = "wall_milliseconds" if what == "lanes" else "cpu_milliseconds"
            cost = [entry[clock] / s for entry, s in zip(own, share, strict=True)]
            line(axis, i, [entry[size] for entry in own], cost, name)
        logarithmic(axis, x, "processor time (ms)" if what == "length" else "time a lane (ms)")
        axis.legend(fontsize=8)
    axes["length"].set_title("limit cycle")
    axes["lanes"].set_title("stick-slip, 300 s a lane")
    return plots.svg(made)


def bars(axis: Any, names: list[str], values: list[float], text: list[str]) -> None:
    """Horizontal bars on a logarithmic axis, each with its figure; this project's are dark."""
    colours = [plots.COLOURS[2] if name.startswith("stribeck") else plots.GREY for name in names]
    axis.barh(range(len(names)), values, color=colours, height=0.65)
    axis.set_yticks(range(len(names)), names)
    axis.invert_yaxis()
    axis.set_xscale("log")
    axis.set_xlim(min(values) / 2, max(values) * 6)
    axis.grid(visible=False, axis="y")
    for i, (value, label) in enumerate(zip(values, text, strict=True)):
        axis.text(value * 1.15, i, label, va="center")


def ensemble(results: dict[str, Any]) -> str:
    """Trajectories a second."""
    made, axes = plots.figure([["rate"]], 2.6)
    rates = {entry["solver"]: entry["trajectories_per_second"]["median"] for entry in results["solvers"]}
    bars(axes["rate"], list(rates), list(rates.values()), [f"{rate:.3g}" for rate in rates.values()])
    axes["rate"].set_xlabel("trajectories a second (stick-slip, 300 s each)")
    return plots.svg(made)


def single(results: dict[str, Any]) -> str:
    """Milliseconds of one limit cycle."""
    made, axes = plots.figure([["time"]], 3.6)
    times = {entry["solver"]: entry["milliseconds"]["median"] for entry in results["solvers"]}
    bars(axes["time"], list(times), list(times.values()), [f"{time:.3g}" for time in times.values()])
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
            if i == 1:
                at = (run["max_error"], run["milliseconds"]["median"])
                step = f"{1e3 * run['step_s']:g} ms"
                axes["cost"].annotate(step, at, textcoords="offset points", xytext=(5, -9), fontsize=8)
    logarithmic(axes["cost"], "largest error of y (part of its range)", "processor time (ms)")
    axes["cost"].invert_xaxis()
    plots.legend(made, axes["cost"])
    return plots.svg(made)


FIGURES: dict[str, Callable[[dict[str, Any]], str]] = {
    "single": single,
    "ensemble": ensemble,
    "precision": precision,
    "scaling": scaling,
    "mujoco": mujoco,
}


def draw(results: Path) -> None:
    """The figure of a file of results, beside it under the same name."""
    with plots.style():
        text = FIGURES[results.stem.partition("-")[0]](json.loads(results.read_text()))
    write_text(results.with_suffix(".svg"), text)


def main() -> None:
    """All figures whose results are there."""
    for name in FIGURES:
        if (file := RESULTS / f"{name}.json").is_file():
            draw(file)
            say(f"{file.with_suffix('.svg').name}")


if __name__ == "__main__":
    main()
