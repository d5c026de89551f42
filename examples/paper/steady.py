"""The steady friction curve: the paper's Fig. 1."""

from __future__ import annotations

import numpy as np

from examples.paper.common import PAPER, PROPOSED, REFERENCE, Chapter, Done, finish
from stribeck.laws import law
from stribeck.mouth import plots
from stribeck.mouth.cells import prefixed
from stribeck.mouth.document import Table


def chapter(done: Done) -> Chapter:
    """Friction force at constant velocity, and how far the proposed law is below it near rest."""
    laws = {label: law(name, parameters="canudas1995", **constants) for label, (name, constants) in PAPER.items()}
    v_s = laws[REFERENCE].machine["v_s"]
    half = np.concatenate([np.geomspace(1e-9, 1e-5, 100), np.linspace(1e-5, 5 * v_s, 300)])
    v = np.concatenate([-half[::-1], half])
    factor, unit = prefixed("m/s", float(v.max()))
    with plots.style():
        built, axes = plots.figure([["F", "near"]], 3.1)
        for i, (label, each) in enumerate(laws.items()):
            plots.line(axes["F"], i, v / factor, each.steady_force(v), label)
            plots.line(axes["near"], i, half, each.steady_force(half), label)
        axes["F"].set(xlabel=f"v ({unit})", ylabel="F (N)", title="(a) static relationship")
        axes["near"].set(xlabel="v (m/s)", ylabel="F (N)", xscale="log", title="(b) near rest")
        plots.legend(built, axes["F"])
        figure = finish(
            built, "fig01_steady_friction",
            "Friction force at constant velocity: static friction F_s at rest, falling to F_c above the Stribeck velocity, "
            "then viscous. On a logarithmic axis (b) the proposed law leaves this curve where v is below some 1/k_v: at "
            "constant velocity its deflection is S_0(v) g(v), so the steady force falls to 0 at rest.",
        )  # fmt: skip
    ratio = {
        label: [float(laws[label].steady_force(x) / laws[REFERENCE].steady_force(x)) for x in (1e-6, 1e-4)]
        for label in PROPOSED
    }
    rows = [[label, *(f"{x:.5f}" for x in values)] for label, values in ratio.items()]
    table = Table(["steady force / that of lugre", "at 1 µm/s", "at 0.1 mm/s"], rows)
    text = ("At constant velocity every LuGre law tends to a static relation between velocity and friction force.",)
    return Chapter("steady", "The static relationship", text, [table], [figure], {"share_of_lugre": ratio})
