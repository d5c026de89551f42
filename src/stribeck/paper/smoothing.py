"""The smooth functions that replace |v| and sgn v: the paper's Figs. 2 and 3."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from stribeck.laws.terms import S_0, m
from stribeck.paper.common import STEEPNESSES, Done
from stribeck.report import plots
from stribeck.report.page import Chapter, Table


def chapter(done: Done) -> Chapter:
    """m(v) = v S_0(v), S_0(v) and S_1(v) for the three k_v, beside what they replace."""
    v = np.concatenate([-np.geomspace(5e-6, 1e-9, 200), np.geomspace(1e-9, 5e-6, 200)])
    steep = {k_v: SimpleNamespace(k_v=k_v) for k_v in STEEPNESSES}
    labels = {k_v: f"k_v = {k_v:.0e} s/m".replace("e+0", "e") for k_v in STEEPNESSES}
    with plots.style():
        made, axes = plots.figure([["m", "S_0"]], 3.1)
        plots.line(axes["m"], 0, v, abs(v), "exact: |v|, sgn v")
        plots.line(axes["S_0"], 0, v, np.sign(v), "exact: |v|, sgn v")
        for i, (k_v, p) in enumerate(steep.items(), start=1):
            plots.line(axes["m"], i, v, v * S_0(p, v), labels[k_v])
            plots.line(axes["S_0"], i, v, S_0(p, v), labels[k_v])
        axes["m"].set(xlabel="v (m/s)", ylabel="v S_0(v) (m/s)", title="(a) m(v) = v S_0(v)")
        axes["S_0"].set(xlabel="v (m/s)", ylabel="S_0(v)", title="(b) S_0(v)")
        plots.legend(made, axes["m"])
        two = plots.finish(
            made, "fig02_smooth_sign",
            "The paper's smooth versions of |v| (a) and of sgn v (b). Good approximations need a large k_v; v S_0(v) lies "
            "below |v| everywhere, which is what leaves z without a bound in the first smooth law.",
        )  # fmt: skip
        made, axes = plots.figure([["S_1", "m"]], 3.1)
        plots.line(axes["S_1"], 0, v, np.ones_like(v), "exact: 1, |v|")
        plots.line(axes["m"], 0, v, abs(v), "exact: 1, |v|")
        for i, (k_v, p) in enumerate(steep.items(), start=1):
            plots.line(axes["S_1"], i, v, S_0(p, v) ** 2, labels[k_v])
            plots.line(axes["m"], i, v, m(p, v), labels[k_v])
        axes["S_1"].set(xlabel="v (m/s)", ylabel="S_1(v)", title="S_1(v) = S_0(v)^2")
        axes["m"].set(xlabel="v (m/s)", ylabel="m(v) (m/s)", title="for comparison: this project's majorant of |v|")
        plots.legend(made, axes["S_1"])
        three = plots.finish(
            made, "fig03_drive_factor",
            "The factor S_1 of the proposed law (left) takes the drive of z away near rest: z stays bounded, and the contact "
            "loses its stiffness there. The majorant law keeps the factor 1 and lifts |v| instead (right).",
        )  # fmt: skip
    off = {labels[k]: [float(1 - S_0(p, x) ** 2) for x in (1e-6, 1e-4)] for k, p in steep.items()}
    rows = [[label, *(f"{x:.2e}" for x in values)] for label, values in off.items()]
    table = Table(["1 - S_1(v)", "at 1 um/s", "at 0.1 mm/s"], rows)
    text = (
        "The proposed law replaces sgn v by S_0(v) = (2/pi) arctan(k_v v), |v| by v S_0(v), and multiplies v by S_1.",
    )
    return Chapter("smoothing", "The smooth functions", text, [table], [two, three], {"one_minus_S_1": off})
