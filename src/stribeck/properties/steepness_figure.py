"""The figure of the errors that a steepness leaves."""

from __future__ import annotations

from collections.abc import Mapping

from stribeck.mouth import plots
from stribeck.mouth.document import FigureSvg
from stribeck.properties.steepness import Steepness


def steepness_figure(found: Mapping[str, Steepness], name: str, caption: str) -> FigureSvg:
    """What is tolerated against k_v, a panel for each tolerance, the chosen k_v marked."""
    first = next(iter(found.values()))
    shown = [i for i in range(len(first.requirements)) if any(each.requirements[i].points for each in found.values())]
    panels = [str(i) for i in shown] or ["none"]
    rows = [panels[i : i + 2] for i in range(0, len(panels), 2)]
    if len(rows[-1]) < len(rows[0]):
        rows[-1] = rows[-1] * 2
    with plots.style():
        made, axes = plots.figure(rows, 0.6 + 2.5 * len(rows))
        for i in shown:
            axis, wanted = axes[str(i)], first.requirements[i]
            for n, (law, each) in enumerate(found.items(), start=1):
                one = each.requirements[i]
                points = [(k, x) for k, x in one.points if x > 0]
                if points:
                    k_v, measure = zip(*points, strict=True)
                    plots.line(axis, n, k_v, measure, law)
                if one.k_v and one.achieved:
                    axis.plot([one.k_v], [one.achieved], "o", color=plots.COLOURS[n], markersize=5)
            axis.axhline(wanted.tolerance, color=plots.GREY, linewidth=0.8)
            plots.logarithmic(axis)
            axis.set(xlabel=f"k_v ({'s/rad' if first.rotary else 's/m'})", title=wanted.name)
            axis.set_ylabel((wanted.unit and f"({wanted.unit})") or "share")
        if shown:
            plots.legend(made, axes[str(shown[0])])
        return plots.finish(made, name, caption)
