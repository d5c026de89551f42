"""The break-away force against the rate of the applied force: the paper's Fig. 10."""

from __future__ import annotations

from stribeck.analysis.oscillation import first_maximum
from stribeck.paper.common import LAWS, REFERENCE, scenario
from stribeck.report import plots
from stribeck.report.page import Chapter, FigureSvg, Table
from stribeck.simulation import simulate

_RATES = (1.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0)  # N/s


def break_away_force(law: str, constants: dict[str, float], rate: float) -> float:
    """The first local maximum of F in N while the applied force grows at ``rate``, N/s."""
    end = 2 / rate + 0.1
    changes = {"drive__signal__rate": rate, "solve__t_end": end, "output__step": end / 20000}
    F = simulate(scenario("break_away", law, constants, **changes))["F"]
    return float(F[first_maximum(F)])


def chapter() -> Chapter:
    """The break-away force over the rates 1 to 50 N/s."""
    forces = {label: [break_away_force(law, c, rate) for rate in _RATES] for label, law, c in LAWS}
    with plots.style():
        made, axes = plots.figure([["F", "off"]], 3.2)
        for i, (label, found) in enumerate(forces.items()):
            off = [1e3 * (a - b) for a, b in zip(found, forces[REFERENCE], strict=True)]
            for panel, values in (("F", found), ("off", off)):
                axes[panel].plot(
                    _RATES,
                    values,
                    color=plots.COLOURS[i],
                    linestyle=plots.DASHES[i],
                    marker="os^"[i],
                    ms=4,
                    label=label,
                )
        axes["F"].set(xlabel="rate of the applied force (N/s)", ylabel="break-away force (N)")
        axes["off"].set(xlabel="rate of the applied force (N/s)", ylabel="deviation from lugre (mN)")
        plots.legend(made, axes["F"])
        svg = plots.svg(made)
    rows = [[label, *(f"{force:.5f}" for force in found)] for label, found in forces.items()]
    table = Table(["break-away force (N) at", *(f"{rate:g} N/s" for rate in _RATES)], rows)
    caption = "The faster the force grows, the lower the friction force at which the body breaks away."
    text = ("The break-away force is the first local maximum of the friction force under a force that grows steadily.",)
    figures = [FigureSvg("fig10_break_away", svg, caption)]
    return Chapter("break_away", "Break-away force", text, [table], figures, {"rates": _RATES, "forces": forces})
