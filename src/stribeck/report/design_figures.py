"""The figures of ``stribeck design``: the verdict along one number and over two, and what each compensation leaves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stribeck.loops.boundary import PathVerdicts
from stribeck.loops.compensation import CompensationResult
from stribeck.loops.plane import Plane
from stribeck.report import plots
from stribeck.report.page import FigureSvg

VERDICTS = ("quiet", "creeping", "hunting", "unstable", "failed")


def line(along: PathVerdicts, i: int) -> FigureSvg:
    """The verdict along one number."""
    with plots.style():
        made, axes = plots.figure([["verdict"]], 2.2)
        axis = axes["verdict"]
        level = np.array([VERDICTS.index(j.verdict) for j in along.found])
        axis.plot(along.values, level, ".", color=plots.COLOURS[2])
        for b in along.boundaries:
            axis.axvline(b.value, color=plots.COLOURS[1], linestyle="--")
        for m in along.mixed:
            axis.axvspan(m.low, m.high, color=plots.COLOURS[1], alpha=0.2, linewidth=0)
        shown = VERDICTS if level.max() == len(VERDICTS) - 1 else VERDICTS[:-1]  # a run that failed is seldom
        axis.set_yticks(range(len(shown)), shown)
        axis.set(xlabel=along.turned.path, title="verdict", ylim=(-0.4, len(shown) - 0.6))
        if along.turned.low > 0 and along.turned.high / along.turned.low >= 10:
            plots.logarithmic(axis, y=False)
        return plots.finish(
            made,
            f"boundaries_{i}",
            f"Each point is a simulated loop; dashed: boundaries of {along.turned.path}; shaded: mixed.",
            pdf=True,
        )


def plane(p: Plane) -> FigureSvg:
    """The verdict over two numbers: the grid, the boundary and the file's point."""
    with plots.style():
        made, axes = plots.figure([["map"]], 4.2)
        axis = axes["map"]
        points = [(x, y, j.verdict) for x, col in zip(p.x, p.found, strict=True) for y, j in zip(p.y, col, strict=True)]
        for i, verdict in enumerate(VERDICTS):
            at = np.array([(x, y) for x, y, v in points if v == verdict])
            if len(at):
                axis.plot(*at.T, "osvXP"[i], color=plots.COLOURS[(3, 5, 1, 4, 6)[i]], label=verdict, markersize=6)
        if p.edges:
            axis.plot([e.x for e in p.edges], [e.y for e in p.edges], "k.", markersize=4, label="boundary")
        axis.plot(*([x] for x in p.point), "k*", markersize=14, label="the file")
        axis.set(xlabel=p.across.path, ylabel=p.up.path, title="verdict")
        for turned, which in ((p.across, "x"), (p.up, "y")):
            if turned.low > 0 and turned.high / turned.low >= 10:
                plots.logarithmic(axis, x=which == "x", y=which == "y")
        axis.legend(fontsize=8, ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.16))
        return plots.finish(
            made,
            "map",
            "Each mark is a simulated loop; dots: where the verdict changes, within a sixteenth of a cell.",
            pdf=True,
        )


def shares(found: Sequence[CompensationResult], unit: str) -> FigureSvg:
    """Error against margin: what each compensation leaves, how far it may be turned up, and which none beats in both."""
    with plots.style():
        made, axes = plots.figure([["error"]], 2.6)
        axis = axes["error"]
        for i, c in enumerate(found):
            quiet = c.largest_quiet_share is not None
            margin = c.largest_quiet_share if c.largest_quiet_share is not None else 0.0
            mark = axis.plot([margin], [c.worst_error], "os^Dv"[i % 5], color=plots.COLOURS[i])[0]
            mark.set(fillstyle="full" if quiet else "none", label=c.kind if quiet else f"{c.kind}, not quiet")
        front = unbeaten(found)
        axis.plot(*zip(*front, strict=True), "-", color="0.6", zorder=0) if front else None
        axis.set(xlabel="quiet up to this share of the friction", ylabel=f"worst error ({unit})", ylim=(0, None))
        axis.set_xlim(-0.1, max(1.6, *axis.get_xlim()))
        axis.legend(fontsize=8, ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.25))
        caption = "Error after a reversal against margin; grey: those that none beats in both (dither aside)."
        return plots.finish(made, "compensations", caption, pdf=True)


def unbeaten(found: Sequence[CompensationResult]) -> list[tuple[float, float]]:
    """Margin and worst error of those that are quiet and that no other one beats in both, by margin; a dither aside."""
    quiet = [
        (c.largest_quiet_share, c.worst_error)
        for c in found if c.largest_quiet_share is not None and c.kind != "dither"
    ]  # fmt: skip
    kept = [p for p in quiet if not any(q[0] >= p[0] and q[1] <= p[1] and q != p for q in quiet)]
    return sorted(set(kept))
