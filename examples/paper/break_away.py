"""The break-away force against the rate of the applied force: the paper's Fig. 10."""

from __future__ import annotations

import numpy as np

from examples.paper.common import PAPER, PROPOSED, REFERENCE, Chapter, Done, Variant, finish, scenario, solve
from stribeck.mouth import plots
from stribeck.mouth.document import Table

RATES = (1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0)  # N/s
_TABLE = (1.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0)


def break_away_force(variant: Variant, rate: float) -> float:
    """The first local maximum of F in N while the applied force grows at ``rate``, N/s."""
    end = 2 / rate + 0.1
    F = solve(
        scenario(
            "break_away", variant, drive__signal__rate=rate, solve__t_end=end, output__step=end / 20000
        )
    )["F"]  # fmt: skip
    return float(F[np.flatnonzero(np.diff(F) < 0)[0]])


def chapter(done: Done) -> Chapter:
    """The break-away force over the rates 1 to 50 N/s."""
    forces = {label: [break_away_force(variant, rate) for rate in RATES] for label, variant in PAPER.items()}
    lowest = min(forces[REFERENCE])
    with plots.style():
        built, axes = plots.figure([["F", "near"]], 3.3)
        for i, (label, result) in enumerate(forces.items()):
            for panel in ("F", "near"):
                plots.line(axes[panel], i, RATES, result, label, marker="os^D"[i], markersize=3.5)
        axes["F"].set(xlabel="rate of the applied force (N/s)", ylabel="break-away force (N)")
        axes["F"].set_title("(a) complete simulation")
        axes["near"].set(xlabel="rate of the applied force (N/s)", ylabel="break-away force (N)")
        axes["near"].set_title("(b) detailed view")
        axes["near"].set_xlim(0.5, 5.5)
        axes["near"].set_ylim(1.29, 1.45)
        plots.legend(built, axes["F"])
        figure = finish(
            built, "fig10_break_away",
            "The faster the applied force grows, the lower the friction force at which the body breaks away, down to "
            f"{lowest:.3f} N at {RATES[forces[REFERENCE].index(lowest)]:g} N/s for lugre"
            + (f"; at {RATES[-1]:g} N/s it is a little higher again." if lowest < forces[REFERENCE][-1] else "."),
        )  # fmt: skip
    columns = [RATES.index(rate) for rate in _TABLE]
    rows = [[label, *(f"{result[i]:.5f}" for i in columns)] for label, result in forces.items()]
    table = Table(["break-away force (N) at", *(f"{rate:g} N/s" for rate in _TABLE)], rows)
    below = {label: max(b - a for a, b in zip(forces[label], forces[REFERENCE], strict=True)) for label in PROPOSED}
    text = ("The break-away force is the first local maximum of the friction force under a force that grows steadily.",)
    numbers = {"rates": RATES, "forces": forces, "largest_shortfall": below}
    return Chapter("break_away", "Varying break-away force", text, [table], [figure], numbers)
