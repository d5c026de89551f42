"""The smooth functions that replace |v| and sgn v: the paper's Figs. 2 and 3."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from examples.paper.common import STEEPNESSES, Chapter, Done, Printed, finish
from stribeck.expressions.ops import Value
from stribeck.laws.terms import S_0, S_1, S_2, m
from stribeck.mouth import plots
from stribeck.mouth.cells import prefixed
from stribeck.mouth.document import Table


def chapter(done: Done) -> Chapter:
    """m(v) = v S_0(v), S_0(v) and S_1(v) for the three k_v, beside what they replace."""
    v = np.concatenate([-np.geomspace(5e-6, 1e-9, 200), np.geomspace(1e-9, 5e-6, 200)])
    steep = {k_v: SimpleNamespace(k_v=k_v, smooth_abs="atan") for k_v in STEEPNESSES}
    labels = {k_v: f"k_v = {k_v:.0e} s/m".replace("e+0", "e") for k_v in STEEPNESSES}
    two = _beside(
        "fig02_smooth_sign",
        "The paper's smooth versions of |v| (a) and of sgn v (b). Good approximations need a large k_v; v S_0(v) lies "
        "below |v| everywhere, which is what leaves z without a bound in the first smooth law.",
        v, steep, labels, "exact: |v|, sgn v",
        SmoothedFunction("v S_0(v)", "(a) m(v) = v S_0(v)", abs, S_2, is_speed=True),
        SmoothedFunction("S_0(v)", "(b) S_0(v)", np.sign, S_0),
    )  # fmt: skip
    three = _beside(
        "fig03_drive_factor",
        "The factor S_1 of the proposed law (left) takes the drive of z away near rest: z stays bounded, and the contact "
        "loses its stiffness there. The majorant law keeps the factor 1 and lifts |v| instead (right).",
        v, steep, labels, "exact: 1, |v|",
        SmoothedFunction("S_1(v)", "S_1(v) = S_0(v)^2", np.ones_like, S_1),
        SmoothedFunction("m(v)", "for comparison: this project's majorant of |v|", abs, m, is_speed=True),
    )  # fmt: skip
    off = {labels[k]: [float(1 - S_1(p, x)) for x in (1e-6, 1e-4)] for k, p in steep.items()}
    rows = [[label, *(f"{x:.2e}" for x in values)] for label, values in off.items()]
    table = Table(["1 - S_1(v)", "at 1 µm/s", "at 0.1 mm/s"], rows)
    text = (
        "The proposed law replaces sgn v by S_0(v) = (2/pi) arctan(k_v v), |v| by v S_0(v), and multiplies v by S_1.",
    )
    return Chapter("smoothing", "The smooth functions", text, [table], [two, three], {"one_minus_S_1": off})


class SmoothedFunction(NamedTuple):
    """A smooth function beside what it replaces."""

    name: str
    title: str
    exact: Callable[[Value], Value]
    smooth: Callable[[Value, Value], Value]
    is_speed: bool = False


def _beside(
    name: str,
    caption: str,
    v: Value,
    steep: dict[float, Value],
    labels: dict[float, str],
    exact: str,
    *panels: SmoothedFunction,
) -> Printed:
    """Two panels, each with the exact function and the smooth one for every steepness."""
    factor, unit = prefixed("m/s", float(v.max()))
    with plots.style():
        built, axes = plots.figure([["left", "right"]], 3.1)
        for axis, panel in zip((axes["left"], axes["right"]), panels, strict=True):
            tall = factor if panel.is_speed else 1.0
            plots.line(axis, 0, v / factor, panel.exact(v) / tall, exact)
            for i, (k_v, p) in enumerate(steep.items(), start=1):
                plots.line(axis, i, v / factor, panel.smooth(p, v) / tall, labels[k_v])
            label = f"{panel.name} ({unit})" if panel.is_speed else panel.name
            axis.set(xlabel=f"v ({unit})", ylabel=label, title=panel.title)
        plots.legend(built, axes["left"])
        return finish(built, name, caption)
