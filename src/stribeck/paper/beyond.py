"""Beyond the paper: the other smooth laws in the same figures, and what drifts under a dithered load."""

from __future__ import annotations

from typing import Any

import numpy as np

from stribeck.analysis.comparison import deviations
from stribeck.paper.break_away import break_away_force
from stribeck.paper.common import REFERENCE, Done, Variant, percent, solve, solve_all
from stribeck.report import plots
from stribeck.report.page import Chapter, FigureSvg, Table
from stribeck.scenario import Scenario
from stribeck.simulation import Solution

_OTHERS: dict[str, Variant] = {
    REFERENCE: ("lugre", {}),
    "lugre_sobczyk, k_v = 1e7": ("lugre_sobczyk", {"k_v": 1e7}),
    "lugre_arctan, k_v = 1e7": ("lugre_arctan", {"k_v": 1e7}),
    "lugre_majorant, k_v = 1e6": ("lugre_majorant", {"k_v": 1e6}),
}
_DITHERED: dict[str, Variant] = {
    "lugre": ("lugre", {}),
    "lugre_majorant": ("lugre_majorant", {"k_v": 1e6}),
    "elastoplastic": ("elastoplastic", {"z_ba": 7e-6}),
    "elastoplastic_sobczyk": ("elastoplastic_sobczyk", {"z_ba": 7e-6, "k_v": 1e6}),
    "elastoplastic_majorant": ("elastoplastic_majorant", {"z_ba": 7e-6, "k_v": 1e6}),
}


def chapter(done: Done) -> Chapter:
    """The same four scenarios under the other laws, and a dithered load."""
    runs = {name: solve_all(name, _OTHERS) for name in ("presliding", "stick_slip", "sine_force", "limit_cycle")}
    forces = {label: break_away_force(variant, 1.0) for label, variant in _OTHERS.items()}
    off = {
        label: {name: deviations(found[REFERENCE], found[label])["y"]["max_relative"] for name, found in runs.items()}
        | {"break_away": abs(forces[label] / forces[REFERENCE] - 1)}
        for label in _OTHERS
        if label != REFERENCE
    }
    rows = [[label, *(percent(share) for share in shares.values())] for label, shares in off.items()]
    head = ["largest deviation of y / peak", *(name.replace("_", " ") for name in runs), "break-away force at 1 N/s"]
    moved, dithered = _dither()
    drift = Table(
        ["moved in 16 s (m)", "0.4 +- 0.25 N at 5 Hz", "0 to 0.55 N, 1 Hz sawtooth"],
        [[label, f"{m['sine']:.2e}", f"{m['sawtooth']:.2e}"] for label, m in moved.items()],
    )
    sobczyk, _, majorant = off.values()
    sliding = [name for name in sobczyk if name != "presliding"]
    closer = min(float(sobczyk[name] or 0.0) / float(majorant[name] or 1.0) for name in sliding)
    text = (
        f"Where the body slides, the majorant law at a tenth of the steepness follows LuGre at least {closer:.0f} times more "
        "closely than the paper's law, because its error falls with the cube of k_v |v|. In presliding both creep and are "
        "alike; the first smooth law, which does not creep, is closest there, but its z has no bound.",
        "All laws whose bristles relax at any load drift when the load is dithered below F_s; the elasto-plastic law and its "
        "majorant version do not.",
    )
    figures = [_figure(runs), dithered]
    numbers: dict[str, Any] = {"deviation_of_peak": off, "break_away_at_1_N_per_s": forces, "drift": moved}
    return Chapter("beyond", "Beyond the paper: other smooth laws", text, [Table(head, rows), drift], figures, numbers)


def _figure(runs: dict[str, dict[str, Solution]]) -> FigureSvg:
    with plots.style():
        made, axes = plots.figure([["presliding", "stick_slip"], ["sine_force", "limit_cycle"]], 5.4)
        plots.draw(axes["presliding"], runs["presliding"], "y", "F")
        plots.draw(axes["stick_slip"], runs["stick_slip"], "t", "y")
        plots.draw(axes["sine_force"], runs["sine_force"], "t", "v")
        plots.draw(axes["limit_cycle"], runs["limit_cycle"], "t", "y")
        last = float(runs["stick_slip"][REFERENCE].events["slip"][-2])
        axes["stick_slip"].set_xlim(last - 0.15, last + 0.35)
        axes["stick_slip"].set_ylim(2.54, 2.57)
        axes["limit_cycle"].set_xlim(150, 250)
        axes["limit_cycle"].set_ylim(0.9, 1.1)
        for panel, axis in axes.items():
            axis.set_title({"stick_slip": "stick-slip, the fifth slip"}.get(panel, panel.replace("_", " ")))
        plots.legend(made, axes["stick_slip"])
        return plots.finish(
            made, "beyond_laws",
            "The phenomena of Figs. 4, 6, 7 and 9 under the first smooth law (arctan), the paper's, and the majorant law, the "
            "last at a tenth of the steepness.",
        )  # fmt: skip


def _load(signal: dict[str, Any]) -> dict[str, Solution]:
    return {
        label: solve(
            Scenario(
                name="dithered_load", law={"name": law, "parameters": "canudas1995", **constants}, plant={"mass": 1.0},
                drive={"kind": "force", "signal": signal}, solve={"t_end": 17.0}, output={"step": 0.01},
            )
        )
        for label, (law, constants) in _DITHERED.items()
    }  # fmt: skip


def _dither() -> tuple[dict[str, dict[str, float]], FigureSvg]:
    """How far each law lets the body move from t = 1 s to 17 s under two loads that stay below F_s, and the picture."""
    sine = _load({"kind": "sine", "offset": 0.4, "amplitude": 0.25, "frequency": 5.0})
    teeth = [(second + part, force) for second in range(18) for part, force in ((0.0, 0.0), (0.95, 0.55))]
    saw = _load({"kind": "points", "t": [t for t, _ in teeth], "value": [force for _, force in teeth]})
    moved = {
        label: {"sine": float(sine[label]["y"][-1] - sine[label]["y"][100]),
                "sawtooth": float(saw[label]["y"][-1] - saw[label]["y"][100])}
        for label in _DITHERED
    }  # fmt: skip
    with plots.style():
        made, axes = plots.figure([["sine", "sawtooth"]], 3.4)
        for panel, solutions in (("sine", sine), ("sawtooth", saw)):
            for i, (label, s) in enumerate(solutions.items()):
                means = s["y"][: len(s.t) // 100 * 100].reshape(-1, 100).mean(1)  # one second a point
                plots.line(axes[panel], i, np.arange(len(means)) + 0.5, 1e6 * means, label)
            axes[panel].set(xlabel="t (s)", ylabel="y, mean over a second (um)")
        axes["sine"].set_title("0.4 +- 0.25 N at 5 Hz")
        axes["sawtooth"].set_title("0 to 0.55 N, 1 Hz sawtooth")
        plots.legend(made, axes["sine"])
        figure = plots.finish(
            made, "beyond_dither",
            "Loads below sigma_0 z_ba = 0.7 N and far below F_s = 1.5 N. LuGre and its smooth versions walk away under both; "
            "the smooth elasto-plastic law that the paper's Remark 1 names walks under the sawtooth; the elasto-plastic law "
            "and its majorant version stay where they are.",
        )  # fmt: skip
    return moved, figure
