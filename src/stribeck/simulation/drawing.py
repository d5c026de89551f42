"""The figure of one or several solutions: the choice of panels, and their drawing."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.constants import rotary_words
from stribeck.mouth import plots
from stribeck.mouth.document import Figure as Picture
from stribeck.mouth.quantities import Quantity, Scale, scale
from stribeck.simulation.panels import ENERGY, Panel, choose_panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stribeck.machine.elements.loads import Load
    from stribeck.simulation.solution import Solution

_ROW = 2.15  # inches: height of a row of panels
_FAST = 10.0  # Stribeck velocities: if the motion is faster, its part near rest is invisible on a linear axis
_FAR = 0.05  # of a panel's width: a line between two rows that is longer would be a path that the motion did not take
_MOST = 40  # panels of a figure: each takes 0.1 s, and nobody reads more at once
_CURVE = 400  # points of a load's curve: across half a page, as fine as its line is wide
_APART = 0.13  # of an axis' width, between two of its numbers: room for their digits

Quantities = Mapping[str, Quantity]


_FRICTION = (
    Panel("F", "friction against velocity", x="v", near_rest=True),
    Panel("F", "friction against position", x="y"),
)
_CASCADE = (
    Panel("y", "position", also=", and its desired course", axis="position", beside=("y_d",)),
    Panel("e", "position error after the transient", settled=True),
    Panel("p_1", "pressure in chamber 1"),
    Panel("p_2", "pressure in chamber 2"),
    Panel("u", "valve voltage"),
    Panel("V", "Lyapunov function", log=True),
    Panel("F", "friction force", also=", and what the controller assumes", axis="force", beside=("F_hat",), alone=True),
    Panel("F", "friction against velocity", x="v", near_rest=True),
)


def panels(solution: Solution) -> tuple[Panel, ...]:
    """The panels of a solution, in reading order."""
    known = {"t", *(column.name for column in solution.columns)}
    if not solution.scenario.elements.unnamed:
        return choose_panels(solution.scenario.system)
    if "V" in known:
        return _CASCADE
    if "I" in known:
        error = Panel("e", "control error after the transient", settled=True)
        first = [Panel("y", "position", also=", and its setpoint", axis="position", beside=("r",)), error]
    else:
        first = [Panel("y", "position", also=", and the spring's far end", axis="position", beside=("x",))]
    force = Panel("F", "friction force", also=", and the force of the drive", axis="force", beside=("u",), alone=True)
    rest = [Panel("v", "velocity"), force]
    if solution.scenario.law.has_z:
        rest.append(Panel("z", "mean bristle deflection"))
    energy = [ENERGY] if "E_in" in known else []
    return (*first, *rest, *_FRICTION, *energy)


def figure_of(solutions: Mapping[str, Solution]) -> Figure:
    """All panels of one or several solutions, by label, as a matplotlib figure, one line each."""
    first, shown = next(iter(solutions.values())), _by_label(solutions)
    with plots.style():
        return drawn(shown, panels(first), "" if len(shown) > 1 else next(iter(shown)), _slow_speed(first))


def overview(solutions: Mapping[str, Solution]) -> Picture:
    """The same for a document."""
    return Picture("plot", "", lambda: figure_of(solutions))


def comparison(solutions: Mapping[str, Solution]) -> Picture:
    """The overview of several solutions, with the deviation of each compared column from the first solution."""

    def draw() -> Figure:
        first, shown = next(iter(solutions.values())), _by_label(solutions)
        names = first.scenario.system.compared
        reference, *others = shown.items()
        for label, solution in others:
            deviation = _deviations(reference[1], solution, names)
            shown[label] = {**solution, **deviation}
        wanted = []
        for panel in panels(first):
            wanted.append(panel)
            if panel.x == "t" and panel.y in names and others:
                wanted.append(Panel(f"Δ{panel.y}", f"deviation of {panel.y} from {plots.plain(reference[0], 40)}"))
        return drawn(shown, [p for p in wanted if p.y not in ("z", "E_in")], "", _slow_speed(first))

    return Picture("compare", "", draw)


def _by_label(solutions: Mapping[str, Solution]) -> dict[str, Quantities]:
    """The quantities of each solution by label; the label states if the run failed."""
    early = {label: "" if s.status == "done" else " (failed early)" for label, s in solutions.items()}
    return {f"{label}{early[label]}": quantities(solution) for label, solution in solutions.items()}


def quantities(solution: Solution) -> dict[str, Quantity]:
    """The columns of a solution by name, and derived quantities: y_d of a servo, e of a control loop."""
    derived = {"t": Quantity("t", "s", "time", solution.t)}
    derived |= {c.name: Quantity(c.name, c.unit, c.meaning, solution[c.name]) for c in solution.columns}
    if "r" in derived and "I" in derived:
        derived["e"] = Quantity("e", derived["y"].unit, "control error y - r", solution["y"] - solution["r"])
    elif "e" in derived:
        derived["y_d"] = Quantity("y_d", derived["y"].unit, "desired position", solution["y"] - solution["e"])
    for each in solution.scenario.system.controllers:
        if each.name and (read := f"{each.measures}.y") in derived:  # as the cascade of a piston has e of its own
            error = solution[read] - solution[f"{each.name}.r"]
            derived.setdefault(
                f"{each.name}.e", Quantity(f"{each.name}.e", derived[read].unit, "tracking error y - r", error)
            )
    for load in solution.scenario.elements.loads.values():
        if load.by_position_alone and f"{load.on}.y" in derived:
            derived |= _curve(load, derived[f"{load.on}.y"], derived[f"{load.name}.f"].unit)
    return derived


def _curve(load: Load, position: Quantity, unit: str) -> dict[str, Quantity]:
    """The force of a load that depends on the position alone, finer than the rows that were reached."""
    y = np.linspace(*load.shown(np.nanmin(position.values), np.nanmax(position.values)), _CURVE)
    named = {
        "position": Quantity(f"{load.on}.y", position.unit, position.meaning, y),
        "curve": Quantity(f"{load.name}.f", unit, "force of the load", np.asarray(load.force(0.0, y, 0.0), float)),
    }
    return {f"{load.name}.{name}": quantity for name, quantity in named.items()}


def _deviations(reference: Quantities, other: Quantities, names: Iterable[str]) -> Quantities:
    """Deviations of columns from the reference's, over the rows that both reached."""
    deviations = {}
    for name in names:
        a, b = reference[name], other[name]
        rows = min(len(a.values), len(b.values))
        deviations[f"Δ{name}"] = Quantity(f"Δ{name}", a.unit, f"deviation of {name}", b.values[:rows] - a.values[:rows])
    return deviations


def curves(axis: Axes, solutions: Mapping[str, Solution], x: str, y: str) -> tuple[Scale, Scale]:
    """Draw column ``y`` over column ``x``, one line for each solution; the scales of the two axes, for further lines."""
    shown = {label: quantities(solution) for label, solution in solutions.items()}
    x_scale, y_scale = (scale([q[name] for q in shown.values()]) for name in (x, y))
    for i, (label, q) in enumerate(shown.items()):
        plots.line(axis, i, *plots.thin(x_scale.of(q[x].values), y_scale.of(q[y].values)), label)
    axis.set(xlabel=x_scale.label, ylabel=y_scale.label)
    return x_scale, y_scale


def _slow_speed(solution: Solution) -> float:
    """The speed below which a body counts as near rest, the least of all contacts."""
    laws = solution.scenario.elements.laws.values()
    return min((float(law.machine.get("v_s") or law.scales(law.p).speed) for law in laws), default=0.0)


def drawn(shown: Mapping[str, Quantities], wanted: Sequence[Panel], title: str, slow: float) -> Figure:
    """Draw panels in two columns, a line for each label. Call within :func:`stribeck.mouth.plots.style`.

    Args:
        shown: by label, the quantities by name; a missing quantity is not drawn.
        wanted: the panels in reading order.
        title: a title above all panels; empty for none.
        slow: a speed in SI units; ``near_rest`` stretches the axis below it.

    Of many panels the first 40 are drawn, and the title says so.
    """
    if len(wanted) > _MOST:
        title = f"{f'{title}: ' if title else ''}the first {_MOST} of {len(wanted)} panels"
        wanted = wanted[:_MOST]
    keys = [str(i) for i in range(len(wanted))]
    layout = [keys[i : i + 2] for i in range(0, len(keys), 2)]
    if len(layout[-1]) < 2:
        layout[-1] = layout[-1] * 2
    figure, axes = plots.figure(layout, _ROW * len(layout) + (0.5 if title or len(shown) > 1 else 0.2))
    for key, panel in zip(keys, wanted, strict=True):
        _panel(axes[key], shown, panel, slow)
    if title:
        figure.suptitle(plots.plain(title), fontsize=10, x=0.01, ha="left")
    if len(shown) > 1:
        plots.legend(figure, axes["0"], list(shown))
    return figure


def _panel(axis: Axes, shown: Mapping[str, Quantities], panel: Panel, slow: float) -> None:
    lines = {label: q for label, q in shown.items() if panel.y in q}
    if not lines:
        return
    first = next(iter(lines.values()))
    beside = [first[n] for n in panel.beside if n in first and not (panel.alone and len(shown) > 1)]
    words = _rotary if any(unit in first[panel.y].unit for unit in ("rad", "N m")) else str
    y_scale = scale(
        [*(q[panel.y] for q in lines.values()), *beside], plain=panel.log, name=words(panel.axis) if beside else ""
    )
    x_scale = scale([q[panel.x] for q in lines.values()])
    numbers = {label: i for i, label in enumerate(shown)}
    for i, other in enumerate(beside):
        x = first[panel.x].values
        color, dashes = (plots.COLORS[1 + i], plots.DASHES[1 + i]) if panel.alone else (plots.GRAY, plots.DASHES[0])
        axis.plot(
            *plots.thin(x_scale.of(x), y_scale.of(other.values[: len(x)])), color=color, linestyle=dashes, label=other.name,
            linewidth=1.0, zorder=2.5 if panel.alone else 1.5,
        )  # fmt: skip
    for label, q in lines.items():
        x, y = q[panel.x].values, q[panel.y].values
        rows = min(len(x), len(y))
        given = x_scale.of(x[:rows]), y_scale.of(y[:rows])
        if panel.x == "t":
            plots.line(axis, numbers[label], *plots.thin(*given), label)
            continue
        slowest = slow / x_scale.factor if panel.near_rest and _reaches_far(lines, panel.x, slow) else 0.0
        far = _gaps(np.arcsinh(given[0] / slowest) if slowest else given[0], given[1])
        plots.line(axis, numbers[label], *plots.broken(*given, far), label)
        beside_gaps = np.append(far, False) | np.insert(far, 0, False)
        if beside_gaps.any():
            dots = (plots.drawable(values[beside_gaps]) for values in given)
            axis.plot(*dots, ".", markersize=2.0, color=plots.COLORS[numbers[label] % len(plots.COLORS)])
    axis.set(xlabel=x_scale.label, ylabel=y_scale.label, title=words(panel.title + (panel.also if beside else "")))
    if beside:
        names = [first[panel.y].name, *(q.name for q in beside)]
        plots.key(axis, names if len(lines) == 1 else names[1:], len(beside))
    if panel.log:
        plots.logarithmic(axis, x=False)
    if panel.settled:
        _zoom_late_half(axis, lines, panel, y_scale)
    if panel.near_rest and slow > 0:
        _stretch_near_rest(axis, lines, panel.x, x_scale, slow)


def _rotary(title: str) -> str:
    """A title in the words of a machine that turns; the name before its colon is the user's."""
    name, colon, rest = title.rpartition(": ")
    return f"{name}{colon}{rotary_words(rest)}"


def _gaps(x: Array, y: Array) -> NDArray[np.bool_]:
    """After which rows the next one is so far away that the line to it is left out."""
    if len(x) < 2:
        return np.zeros(max(len(x) - 1, 0), bool)
    spans = [max(float(np.nanmax(values) - np.nanmin(values)), 1e-300) for values in (x, y)]
    return np.asarray(np.hypot(np.diff(x) / spans[0], np.diff(y) / spans[1]) > _FAR)


def _reaches_far(lines: Mapping[str, Quantities], name: str, slow: float) -> bool:
    """Whether the speed reaches far beyond ``slow``."""
    fastest = max(float(np.max(np.abs(q[name].values), initial=0.0)) for q in lines.values())
    return slow > 0 and fastest > _FAST * slow


def _zoom_late_half(axis: Axes, lines: Mapping[str, Quantities], panel: Panel, y_scale: Scale) -> None:
    """Show the range of the second half of the time, in its own unit."""
    late = []
    for q in lines.values():
        t, y = q["t"].values, q[panel.y].values
        late.append(Quantity(panel.y, q[panel.y].unit, "", y[t >= 0.5 * t[-1]] if len(t) else y))
    late_scale = scale(late)
    for drawn in axis.get_lines():
        drawn.set_ydata(late_scale.of(np.asarray(drawn.get_ydata(), float) * y_scale.factor + y_scale.base))
    low, high = (
        f([f(late_scale.of(q.values), initial=s) for q in late]) for f, s in ((np.min, np.inf), (np.max, -np.inf))
    )
    if np.isfinite([low, high]).all() and high > low:
        axis.set_ylim(low - 0.15 * (high - low), high + 0.15 * (high - low))
    axis.set_ylabel(late_scale.label)


def _stretch_near_rest(axis: Axes, lines: Mapping[str, Quantities], name: str, x_scale: Scale, slow: float) -> None:
    """If the speed reaches far beyond ``slow``, make the axis linear below it and logarithmic beyond."""
    fastest = max(float(np.max(np.abs(q[name].values), initial=0.0)) for q in lines.values())
    if not _reaches_far(lines, name, slow):
        return
    width, top = slow / x_scale.factor, fastest / x_scale.factor
    axis.set_xscale("asinh", linear_width=width)
    low, high = math.floor(math.log10(width)), math.floor(math.log10(top))
    ends = axis.get_xlim()
    spacing = _APART * (math.asinh(ends[1] / width) - math.asinh(ends[0] / width))
    decades: list[float] = []
    for k in range(high, low - 1, -1):  # from the outside in, as far as the numbers have room
        place = math.asinh(10.0**k / width)
        if place > spacing and (not decades or math.asinh(decades[-1] / width) - place > spacing):
            decades.append(10.0**k)
    ticks = [t for t in (*(-d for d in decades), 0.0, *reversed(decades)) if ends[0] <= t <= ends[1]]
    axis.set_xticks(ticks, [plots.number(t) for t in ticks])
    axis.set_xticks([], minor=True)
    axis.set_xlabel(f"{x_scale.label}, logarithmic beyond v_s")
