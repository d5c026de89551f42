"""Beyond the paper: the other smooth laws in the same figures."""

from __future__ import annotations

from examples.paper.break_away import break_away_force
from examples.paper.common import REFERENCE, Chapter, Done, Printed, Variant, finish, solve_all
from stribeck.mouth import plots
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Table
from stribeck.simulation import Solution
from stribeck.simulation.comparison import deviations
from stribeck.simulation.drawing import curves

_OTHERS: dict[str, Variant] = {
    REFERENCE: ("lugre", {}),
    "lugre_sobczyk, k_v = 1e7": ("lugre_sobczyk", {"k_v": 1e7}),
    "lugre_arctan, k_v = 1e7": ("lugre_arctan", {"k_v": 1e7}),
    "lugre_majorant, k_v = 1e6": ("lugre_majorant", {"k_v": 1e6}),
}


def chapter(done: Done) -> Chapter:
    """The same four scenarios under the other laws."""
    runs = {name: solve_all(name, _OTHERS) for name in ("presliding", "stick_slip", "sine_force", "limit_cycle")}
    forces = {label: break_away_force(variant, 1.0) for label, variant in _OTHERS.items()}
    off = {
        label: {
            name: deviations(result[REFERENCE], result[label])["y"]["max_relative"] for name, result in runs.items()
        }
        | {"break_away": abs(forces[label] / forces[REFERENCE] - 1)}
        for label in _OTHERS
        if label != REFERENCE
    }
    rows = [[label, *(percent(share) for share in shares.values())] for label, shares in off.items()]
    head = ["largest deviation of y / peak", *(name.replace("_", " ") for name in runs), "break-away force at 1 N/s"]
    sobczyk, _, majorant = off.values()
    sliding = [name for name in sobczyk if name != "presliding"]
    closer = min(float(sobczyk[name] or 0.0) / float(majorant[name] or 1.0) for name in sliding)
    text = (
        f"Where the body slides, the majorant law at a tenth of the steepness follows LuGre at least {closer:.0f} times more "
        "closely than the paper's law, because its error falls with the cube of k_v |v|. In presliding both creep and are "
        "alike; the first smooth law, which does not creep, is closest there, but its z has no bound.",
    )
    numbers: dict[str, object] = {"deviation_of_peak": off, "break_away_at_1_N_per_s": forces}
    return Chapter("beyond", "Beyond the paper: other smooth laws", text, [Table(head, rows)], [_figure(runs)], numbers)


def _figure(runs: dict[str, dict[str, Solution]]) -> Printed:
    with plots.style():
        built, axes = plots.figure([["presliding", "stick_slip"], ["sine_force", "limit_cycle"]], 5.4)
        curves(axes["presliding"], runs["presliding"], "y", "F")
        curves(axes["stick_slip"], runs["stick_slip"], "t", "y")
        curves(axes["sine_force"], runs["sine_force"], "t", "v")
        curves(axes["limit_cycle"], runs["limit_cycle"], "t", "y")
        last = float(runs["stick_slip"][REFERENCE].events["slip"][-2])
        axes["stick_slip"].set_xlim(last - 0.15, last + 0.35)
        axes["stick_slip"].set_ylim(2.54, 2.57)
        axes["limit_cycle"].set_xlim(150, 250)
        axes["limit_cycle"].set_ylim(0.9, 1.1)
        for panel, axis in axes.items():
            axis.set_title({"stick_slip": "stick-slip, the fifth slip"}.get(panel, panel.replace("_", " ")))
        plots.legend(built, axes["stick_slip"])
        return finish(
            built, "beyond_laws",
            "The phenomena of Figs. 4, 6, 7 and 9 under the first smooth law (arctan), the paper's, and the majorant law, the "
            "last at a tenth of the steepness.",
        )  # fmt: skip
