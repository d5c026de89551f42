"""Which k_v? What the paper leaves to trial, answered for its own cases."""

from __future__ import annotations

from examples.paper.common import Chapter, Done, finish
from stribeck import laws
from stribeck.mouth import plots
from stribeck.mouth.document import Table
from stribeck.properties.said import errors_against_k_v
from stribeck.properties.steepness import Steepness, Tolerated, smallest_steepness

_TOLERATED = Tolerated(creep=1e-6, steady_error=0.01, speed=1e-4, v_max=0.1)


def chapter(done: Done) -> Chapter:
    """The smallest k_v for what one might tolerate in the paper's simulations."""
    law = laws.law("lugre_sobczyk", "canudas1995", k_v=1.0)
    advices = smallest_steepness(law, _TOLERATED)
    paper, majorant = advices["lugre_sobczyk"], advices["lugre_majorant"]
    rows = [
        [f"{a.name}: at most {_amount(a.tolerance, a.unit)}", _k_v(a.k_v), _k_v(b.k_v), a.method, b.method]
        for a, b in zip(paper.requirements, majorant.requirements, strict=True)
    ]
    rows.append(["both", _k_v(paper.k_v), _k_v(majorant.k_v), "", ""])
    head = ["tolerated", "lugre_sobczyk: k_v (s/m)", "lugre_majorant: k_v (s/m)", "by", "by"]
    saved = (paper.k_v or 0.0) / (majorant.k_v or 1.0)
    text = (
        "The paper finds by trial that k_v should be 1e7 s/m or more. The smallest k_v follows from the tolerances, by formula "
        f"or from the steady state. For both tolerances below, that of the majorant law is {saved:.3g} times smaller.",
        f"A large k_v does not make the equations stiffer: their rate up to 0.1 m/s is that of sliding, {_cost(paper)} for "
        f"lugre_sobczyk and {_cost(majorant)} for lugre_majorant. It makes the bend of |v| sharper: dF/dv changes there by up to "
        f"{_bend(paper)} and {_bend(majorant)} N s/m for each m/s.",
        "For your own tolerances: stribeck check lugre_sobczyk --parameters canudas1995 --creep 1e-6 --steady-error 0.01 "
        "--speed 1e-4.",
    )
    caption = (
        "Creep under 0.95 F_s (Table 1) and steady error against k_v, of the paper's law and the majorant law. Gray: the "
        "tolerance; dots: the smallest k_v that meets it."
    )
    with plots.style():
        shown = finish(errors_against_k_v(advices), "which_k_v", caption)
    numbers = {name: advice.to_dict() for name, advice in advices.items()}
    return Chapter("which_k_v", "Which k_v?", text, [Table(head, rows)], [shown], numbers)


def _amount(value: float, unit: str) -> str:
    return f"{value:g} {unit}" if unit else f"{100 * value:g} %"


def _k_v(k_v: float | None) -> str:
    return "none" if k_v is None else f"{k_v:.3g}" if k_v else "any"


def _cost(advice: Steepness) -> str:
    return f"{advice.cost.stiffness:.3g} 1/s" if advice.cost else "-"


def _bend(advice: Steepness) -> str:
    return f"{advice.cost.force_bend:.2g}" if advice.cost else "-"
