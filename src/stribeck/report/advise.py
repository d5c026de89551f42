"""The files of ``stribeck advise --out``, and the figure that the report shows too."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from stribeck.files import together, write_json, write_text
from stribeck.report import plots
from stribeck.report.page import FigureSvg
from stribeck.steepness import Advice


def write_advice(advices: Mapping[str, Advice], folder: Path, summary: dict[str, object]) -> list[str]:
    """Write advise.svg and, last, summary.json; the paths."""
    names = ("advise.svg", "summary.json")
    files = [str(folder / name) for name in names]
    with together(folder) as place:
        write_text(place / names[0], advice_figure(advices, "advise", "").svg)
        write_json(place / names[1], {**summary, "files": files})
    return files


def advice_figure(advices: Mapping[str, Advice], name: str, caption: str) -> FigureSvg:
    """What is tolerated against k_v, a panel for each tolerance, the chosen k_v marked."""
    first = next(iter(advices.values()))
    shown = [i for i in range(len(first.requirements)) if any(a.requirements[i].points for a in advices.values())]
    panels = [str(i) for i in shown] or ["none"]
    rows = [panels[i : i + 2] for i in range(0, len(panels), 2)]
    if len(rows[-1]) < len(rows[0]):
        rows[-1] = rows[-1] * 2
    with plots.style():
        made, axes = plots.figure(rows, 0.6 + 2.5 * len(rows))
        for i in shown:
            axis, wanted = axes[str(i)], first.requirements[i]
            for n, (law, advice) in enumerate(advices.items(), start=1):
                found = advice.requirements[i]
                points = [(k, x) for k, x in found.points if x > 0]
                if points:
                    k_v, measure = zip(*points, strict=True)
                    plots.line(axis, n, k_v, measure, law)
                if found.k_v and found.achieved:
                    axis.plot([found.k_v], [found.achieved], "o", color=plots.COLOURS[n], markersize=5)
            axis.axhline(wanted.tolerance, color=plots.GREY, linewidth=0.8)
            plots.logarithmic(axis)
            axis.set(xlabel=f"k_v ({'s/rad' if first.rotary else 's/m'})", title=wanted.name)
            axis.set_ylabel((wanted.unit and f"({wanted.unit})") or "share")
        if shown:
            plots.legend(made, axes[str(shown[0])])
        return plots.finish(made, name, caption)
