"""The figures of ``stribeck design``: the verdict along one number, tracking, and the error with each remedy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from stribeck.loops.boundary import PathVerdicts
from stribeck.loops.compensation import CompensationResult
from stribeck.loops.moves import Tracked
from stribeck.mouth import plots
from stribeck.mouth.cells import prefixed
from stribeck.mouth.document import Figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawn

VERDICTS = ("quiet", "creeping", "hunting", "unstable", "failed")


def line(along: PathVerdicts, i: int) -> Figure:
    """The verdict along one number."""

    def draw() -> Drawn:
        figure, axes = plots.figure([["verdict"]], 2.2)
        axis = axes["verdict"]
        level = np.array([VERDICTS.index(j.verdict) for j in along.judgments])
        axis.plot(along.values, level, ".", color=plots.COLORS[2])
        for b in along.boundaries:
            axis.axvline(b.value, color=plots.COLORS[1], linestyle="--")
        for m in along.mixed:
            axis.axvspan(m.low, m.high, color=plots.COLORS[1], alpha=0.2, linewidth=0)
        shown = VERDICTS if level.max() == len(VERDICTS) - 1 else VERDICTS[:-1]  # a run that failed is seldom
        axis.set_yticks(range(len(shown)), shown)
        axis.set(xlabel=along.turned.path, title="verdict", ylim=(-0.4, len(shown) - 0.6))
        if along.turned.low > 0 and along.turned.high / along.turned.low >= 10:
            plots.logarithmic(axis, y=False)
        return figure

    caption = f"Each point is a simulated loop; dashed: boundaries of {along.turned.path}; shaded: mixed."
    return Figure(f"boundaries_{i}", caption, draw)


def tracking(tracked: Mapping[str, Tracked], unit: str) -> Figure:
    """Signal, position and error of the file's own signal and of the standard sine; ``unit`` is the position's."""

    def draw() -> Drawn:
        names = [name for name in ("file", "sine") if len(tracked[name].t)]
        figure, axes = plots.figure([names, [f"{name} error" for name in names]], 3.6)
        for name in names:
            move, error = tracked[name], tracked[name].r - tracked[name].y
            factor, of_position = prefixed(unit, float(np.abs(move.r).max()))
            for i, (x, label) in enumerate(((move.r, "signal"), (move.y, "position"))):
                plots.line(axes[name], i, *plots.thin(move.t, x / factor), label)
            axes[name].set(
                ylabel=f"position ({of_position})", title="the file's signal" if name == "file" else "the sine"
            )
            factor, of_error = prefixed(unit, float(np.abs(error).max()))
            plots.line(axes[f"{name} error"], 1, *plots.thin(move.t, error / factor), "")
            axes[f"{name} error"].set(xlabel="time (s)", ylabel=f"error ({of_error})")
        plots.legend(figure, axes[names[0]])
        return figure

    return Figure("tracking", "Signal, position and error with the file's own controller.", draw)


def motions(results: Sequence[CompensationResult], period: float, unit: str) -> Figure:
    """The error with each remedy over the last wave of the sine, and after its reversal; ``period`` of the sine, s."""

    def draw() -> Drawn:
        largest = max(float(np.abs(c.sine.r - c.sine.y)[c.sine.t >= period].max(initial=0.0)) for c in results)
        factor, shown = prefixed(unit, largest)
        figure, axes = plots.figure([["wave", "wave", "after"]], 3.0)
        for i, c in enumerate(results):
            t, e = c.sine.t, (c.sine.r - c.sine.y) / factor
            last = t >= t[-1] - period
            plots.line(axes["wave"], i, *plots.thin(t[last], e[last]), c.kind)
            since = t - (t[-1] - 0.75 * period)  # the sine's last turn but one
            near = (since >= -0.02 * period) & (since <= 0.125 * period)
            plots.line(axes["after"], i, since[near], e[near], "")
        axes["wave"].set(xlabel="time (s)", ylabel=f"error ({shown})", title="the last wave of the sine")
        plots.legend(figure, axes["wave"])
        axes["after"].set(xlabel="time after the reversal (s)", title="after a reversal")
        return figure

    return Figure("motions", "Tracking error with the file's friction, without and with each compensation.", draw)


def shares(results: Sequence[CompensationResult], unit: str) -> Figure:
    """The worst error of each remedy over its largest quiet share, with the Pareto front."""

    def draw() -> Drawn:
        figure, axes = plots.figure([["error"]], 2.6)
        axis = axes["error"]
        factor, shown = prefixed(unit, max((c.worst_error for c in results if np.isfinite(c.worst_error)), default=0.0))
        for i, c in enumerate(results):
            quiet = c.largest_quiet_share is not None
            margin = c.largest_quiet_share if c.largest_quiet_share is not None else 0.0
            mark = axis.plot([margin], [c.worst_error / factor], "os^Dv"[i % 5], color=plots.COLORS[i])[0]
            mark.set(fillstyle="full" if quiet else "none", label=c.kind if quiet else f"{c.kind}, not quiet")
        front = [(margin, error / factor) for margin, error in unbeaten(results)]
        axis.plot(*zip(*front, strict=True), "-", color="0.6", zorder=0) if front else None
        axis.set(xlabel="quiet up to this share of the friction", ylabel=f"worst error ({shown})", ylim=(0, None))
        axis.set_xlim(-0.1, max(1.6, *axis.get_xlim()))
        axis.legend(fontsize=8, ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.25))
        return figure

    return Figure(
        "compensations",
        "Error after a reversal against the largest quiet share. A gray line joins the best remedies, without dither.",
        draw,
    )


def unbeaten(results: Sequence[CompensationResult]) -> list[tuple[float, float]]:
    """The Pareto front of largest quiet share and worst error, sorted by share; dithers are left out."""
    quiet = [
        (c.largest_quiet_share, c.worst_error)
        for c in results if c.largest_quiet_share is not None and c.kind != "dither"
    ]  # fmt: skip
    front = [p for p in quiet if not any(q[0] >= p[0] and q[1] <= p[1] and q != p for q in quiet)]
    return sorted(set(front))
