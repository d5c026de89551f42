"""The page's charts, declared with Bokeh; the page fills their sources as results arrive."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import cycle
from typing import Any

from stribeck.constants import rotary_unit
from stribeck.errors import needed
from stribeck.scenario import Scenario

# After the colors of Okabe and Ito, which color-blind readers can distinguish; legible on white and on black.
_COLORS = ("#1b87c9", "#e06a10", "#0a9f78", "#c06aa5", "#b09a00", "#7a68d8", "#8c5a2b")
_GHOST = "#8c8c8c"
_NAMES = {
    "y": "position",
    "v": "velocity",
    "F": "friction",
    "z": "deflection",
    "u": "drive",
    "x": "spring's end",
    "r": "setpoint",
}


@dataclass(frozen=True)
class Series:
    """A line of a panel: its column and its name in the legend."""

    column: str
    name: str


@dataclass(frozen=True)
class Chart:
    """A chart: the quantity along x, and its lines; the page chooses prefixes of the units."""

    x: str
    x_label: str
    x_unit: str
    y: tuple[Series, ...]
    y_label: str
    y_unit: str
    log: bool = False
    height: int = 190
    marks: tuple[str, ...] = ()  # columns on which slip and stick are marked

    def as_data(self) -> dict[str, object]:
        """The chart's data for the page."""
        lines = [{"column": s.column, "name": s.name} for s in self.y]
        return {
            "x": self.x, "xLabel": self.x_label, "xName": self.x_label.split()[0], "xUnit": self.x_unit, "y": lines,
            "yLabel": self.y_label, "yUnit": self.y_unit, "log": self.log, "marks": self.marks,
        }  # fmt: skip


def panels(scenario: Scenario) -> dict[str, Chart]:
    """The charts of a single body's page, by name."""
    system = scenario.system
    names = {column.name for column in system.columns}

    def unit(linear: str) -> str:
        return rotary_unit(linear) if scenario.rotary else linear

    def lines(*columns: str) -> tuple[Series, ...]:
        return tuple(Series(c, f"{c} {_NAMES.get(c, '')}".strip()) for c in columns if c in names)

    position, force = ("angle", "torque") if scenario.rotary else ("position", "force")
    energies = (Series("E_in", "put in"), Series("E_dissipated", "dissipated"), Series("E_stored", "stored"))
    m, speed, newton = unit("m"), unit("m/s"), unit("N")
    return {
        "position": Chart("t", "t", "s", lines("y", "x", "r"), position, m, height=210, marks=("y",)),
        "velocity": Chart("t", "t", "s", lines("v"), "velocity", speed, marks=("v",)),
        "force": Chart("t", "t", "s", lines("F", "u"), force, newton),
        "deflection": Chart("t", "t", "s", lines("z"), "bristles", m, height=150),
        "loop-v": Chart("v", "v, velocity", speed, lines("F"), "friction F", newton, height=280),
        "loop-y": Chart("y", f"y, {position}", m, lines("F"), "friction F", newton, height=280),
        "curve": Chart(
            "speed", "v held", speed, (Series("steady", "F held for long"),), "steady friction F", newton, True, 280
        ),
        "energy": Chart("t", "t", "s", energies, "energy", "J", height=280),
    }


def figures(charts: dict[str, Chart]) -> dict[str, object]:
    """The charts as Bokeh's JSON, by the id of their HTML element."""
    with needed("an explorer"):
        from bokeh.embed import json_item
        from bokeh.layouts import column
        from bokeh.models import DataRange1d

    time = DataRange1d()
    together = [name for name, panel in charts.items() if panel.x == "t" and name != "energy"]  # with one time axis
    figures_of = {
        name: _figure(name, panel, time if name in together else None, name not in together[1:])
        for name, panel in charts.items()
    }
    trajectories = column(*(figures_of[name] for name in together), sizing_mode="stretch_width")
    return {
        "trajectories": json_item(trajectories),
        **{n: json_item(x) for n, x in figures_of.items() if n not in together},
    }


def _figure(name: str, panel: Chart, x_range: Any, toolbar: bool) -> Any:
    from bokeh.models import ColumnDataSource, HoverTool
    from bokeh.models.annotations.geometry import Span
    from bokeh.models.annotations.legends import Legend
    from bokeh.plotting import figure

    over_time = panel.x == "t"
    tools = "xpan,xbox_zoom,xwheel_zoom,reset" if over_time else "pan,box_zoom,wheel_zoom,reset"
    more: dict[str, Any] = {} if x_range is None else {"x_range": x_range}
    drawn: Any = figure(
        name=name, height=panel.height, sizing_mode="stretch_width", tools=tools, min_border_left=70,
        toolbar_location="above" if toolbar else None, x_axis_type="log" if panel.log else "linear", **more,
    )  # fmt: skip
    drawn.toolbar.logo = None
    drawn.add_layout(Legend(**_LEGEND), "above")
    empty = {"along": [0.1, 1.0], **{s.column: [0.1, 1.0] for s in panel.y}}  # until the first run
    ghost, now = (ColumnDataSource(name=f"{name}-{which}", data=dict(empty)) for which in ("ghost", "now"))
    for series in panel.y:
        drawn.line("along", series.column, source=ghost, color=_GHOST, line_width=1.4, line_alpha=0.75)
    shown = []
    for series, color in zip(panel.y, cycle(_COLORS), strict=False):
        named: dict[str, Any] = {"legend_label": series.name} if len(panel.y) > 1 or panel.log else {}
        shown.append(drawn.line("along", series.column, source=now, color=color, line_width=1.7, **named))
    if panel.marks:
        for kind, marker, color in (("slip", "triangle", _COLORS[1]), ("stick", "circle", _COLORS[2])):
            source = ColumnDataSource(name=f"{name}-{kind}", data={"x": [0.1], "y": [0.1]})
            drawn.scatter(
                "x", "y", source=source, marker=marker, size=7, color=color, line_color=None, legend_label=kind
            )
    if panel.log:
        point = ColumnDataSource(name="curve-point", data={"x": [0.1], "y": [0.1]})
        named = {"legend_label": "at the run's mean speed"}
        drawn.scatter("x", "y", source=point, size=11, color=_COLORS[1], line_color="white", **named)
    mode: Any = "vline" if over_time or panel.log else "mouse"
    drawn.add_tools(HoverTool(name=f"{name}-hover", renderers=shown[:1], mode=mode))
    for side in ("height", "width"):  # cross hairs for reading by keyboard
        hair = Span(
            name=f"{name}-{side}", dimension=side, location=0.1, visible=False, line_color=_GHOST, line_dash="dotted"
        )
        drawn.add_layout(hair)
    return drawn


_LEGEND: dict[str, Any] = {
    "orientation": "horizontal", "padding": 0, "margin": 2, "spacing": 12, "label_text_font_size": "11px", "glyph_height": 12,
    "glyph_width": 16, "label_height": 12, "click_policy": "hide", "border_line_color": None,
}  # fmt: skip
