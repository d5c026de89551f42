"""The documents of a check: the verdicts on a law, and on a machine's contacts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from stribeck.constants import DECIDED, rotary_unit
from stribeck.errors import StribeckError, arg
from stribeck.laws import said as of_law
from stribeck.laws.base import Law
from stribeck.laws.render import ranges_in_words
from stribeck.mouth import plots
from stribeck.mouth.cells import digits, human, rounded_up
from stribeck.mouth.document import PAGE, Amount, Cell, Chapter, Document, Figure, Head, Table
from stribeck.mouth.quantities import Quantity, scale
from stribeck.simulation.drawing import figure_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawn

    from stribeck.properties.ports import MachineVerdicts
    from stribeck.properties.steepness import Cost, Steepness
    from stribeck.properties.verdicts import Verdict, Verdicts

_MEANING = {
    "unique": "one z(t) for every v(t)",
    "bounded": "z stays within a bound for every v(t)",
    "smooth": "dF/dt exists wherever dv/dt does",
    "passive": "no motion draws energy from friction",
    "drift_free": "below some load the contact is elastic: no creep",
}
_AGAIN = {True: ", verified", False: ", NOT CONFIRMED", None: ""}
_STEPS = 40  # most rows of a list
# Evidence in reports: its words and unit. The rest is for programs (--json).
_QUANTITIES = {
    "within": ("proved for", ""), "Z": ("bound of |z|", "m"), "z_within": ("proved for |z| up to", "m"),
    "own_up_to": ("elastic energy for |z| up to", "m"), "storage": ("storage function", ""),
    "coq": ("theorem in Coq", ""), "sampled": ("by sampling", ""), "where": ("cases meet where", ""), "v": ("speed", "m/s"),
    "z": ("deflection z", "m"), "from_below": ("{derivative}, from below", ""), "from_above": ("{derivative}, from above", ""),
    "z_from": ("deflection, from", "m"), "z_to": ("deflection, to", "m"), "z_0": ("elastic for |z| up to", "m"),
    "F_0": ("elastic for forces up to", "N"), "energy_drawn": ("energy drawn", "J"),
    "energy_drawn_per_cycle": ("energy drawn in a cycle", "J"), "time_per_cycle": ("duration of a cycle", "s"),
    "z_start": ("deflection at the start", "m"), "z_end": ("deflection at the end", "m"), "time": ("duration", "s"),
    "escape_time": ("z grows without limit within", "s"), "growth": ("growth", ""), "largest_load": ("largest load", "N"),
    "F_s": ("static friction F_s", "N"), "cycles": ("cycles of the load", ""), "distance": ("distance moved", "m"),
    "elastic_displacement": ("elastic deflection", "m"), "largest_v_d": ("passive with v_d up to", "m/s"),
    "F": ("force", "N"), "sigma_2_needed": ("passive with sigma_2 from", "N s/m"),
    "largest_F_s": ("passive with F_s up to", "N"),
}  # fmt: skip
_IN_STEPS = {
    **_QUANTITIES, "F_c": ("F_c", "N"), "F_s": ("F_s", "N"), "z_end": ("z at the end", "m"), "duration": ("duration", "s"),
    "z_over_Z": ("over the bound", ""), "energy_in": ("energy put in", "J"),
}  # fmt: skip
_AT_THE_END = {"E_in": "J", "y": "m", "z": "m"}  # of a replayed counterexample
_SENSE = "'Yes' is proved, and 'no' has a counterexample. The constants are taken as exact."


def law(verdicts: Verdicts) -> Document:
    """The verdicts on a law: first the smallest k_v if tolerances were given."""
    chapters = [_steepness(verdicts.steepness)] if verdicts.steepness else []
    if verdicts.properties:
        chapters.append(_verdicts(verdicts, "verdicts", "Verdicts"))
    chapters += [
        Chapter("curve", "Friction at constant speeds", figures=[_curve(verdicts.law)], on=PAGE),
        *_replays(verdicts, "", "replays", "The counterexamples"),
        of_law.chapter(verdicts.law),
    ]
    facts = [*verdicts.headings(), *_hints(verdicts)] if verdicts.properties else []
    return Document(verdicts.law.name, _in_short(verdicts), facts, chapters)


def machine(checked: MachineVerdicts) -> Document:
    """The verdicts on the contacts and on the machine."""
    contacts: list[list[Cell]] = [
        [name, v.law.name, ranges_in_words(v.level, v.law) or "nothing", DECIDED[v["passive"].holds]]
        for name, v in checked.contacts.items()
    ]
    tables = [Table(["contact", "law", "what varies", "passive"], contacts, prose=True, on=PAGE)]
    if checked.ports:
        tables.append(Table(["port", "input"], [list(row) for row in checked.ports.items()], prose=True))
    text = [
        "A machine of passive contacts, links and pendulums is passive from its ports to the velocities there: no motion "
        "draws more energy from it than was put in. The file bounds each varying parameter by its signal over the whole run; "
        "positions and speeds are unlimited."
    ]
    chapters = [Chapter("machine", "The machine", text, tables)]
    for name, verdicts in checked.contacts.items():
        chapters.append(_verdicts(verdicts, f"contact-{name}", f"Contact {name}", headed=True))
        chapters += _replays(verdicts, name, f"replays-{name}", f"Counterexamples of {name}")
    laws = [of_law.chapter(v.law, f"law-{i}", f" of {name}") for i, (name, v) in enumerate(checked.contacts.items())]
    facts = [f"{checked.why[:1].upper()}{checked.why[1:]}."] if checked.passive else []
    return Document(checked.name, checked.answer, facts, [*chapters, *laws])


def _in_short(verdicts: Verdicts) -> str:
    """A sentence with the proved, refuted and undecided properties."""
    if not verdicts.properties:
        return "no k_v meets the tolerances"
    needed = verdicts.steepness.get(verdicts.law.name)
    smallest = "" if needed is None else f"smallest k_v {_k_v(needed.k_v, needed.rotary)}; "
    limit = f" for |v| up to {verdicts.v_max:g} {'rad/s' if verdicts.law.rotary else 'm/s'}" if verdicts.v_max else ""
    named = {
        word: ", ".join(name.replace("_", "-") for name, v in verdicts.properties.items() if v.holds is holds)
        for word, holds in ((f"proved{limit}", True), ("refuted", False), ("undecided", None))
    }
    return smallest + "; ".join(f"{word}: {names}" for word, names in named.items() if names)


def _verdicts(verdicts: Verdicts, key: str, title: str, headed: bool = False) -> Chapter:
    """The properties with method, evidence and the histories for which they hold."""
    rows: list[list[Cell]] = [
        [name.replace("_", "-"), _MEANING[name], DECIDED[v.holds], v.reason + _AGAIN[v.verified]]
        for name, v in verdicts.properties.items()
    ]
    tables = [Table(["property", Head("meaning", on=PAGE), "holds", "how it was decided"], rows, prose=True)]
    if evidence := [row for name, v in verdicts.properties.items() for row in _evidence(name, v, verdicts.law.rotary)]:
        tables.append(Table(["property", "evidence", "value"], evidence, prose=True))
    tables += [table for name, v in verdicts.properties.items() for table in _steps(name, v, verdicts.law.rotary)]
    facts = [*verdicts.headings(), *_hints(verdicts)] if headed else []
    return Chapter(key, title, [_SENSE], tables, facts=facts, headed=headed)


def _hints(verdicts: Verdicts) -> list[str]:
    """A hint to a bound of the speed, if samples allow passivity below it."""
    passive = verdicts.properties.get("passive")
    worth_a_try = passive is not None and passive.holds is not True and passive.evidence.get("sampled_v_max")
    return [f"The law may be passive at low speeds: try a bound with {arg('v_max')}."] if worth_a_try else []


def _evidence(name: str, verdict: Verdict, rotary: bool) -> list[list[Cell]]:
    """The evidence of a property, one quantity a row."""
    rows: list[list[Cell]] = []
    for key, value in verdict.evidence.items():
        if key in _QUANTITIES and value is not None:
            words, unit = _QUANTITIES[key]
            shown = value if isinstance(value, str | int) else Amount(value, rotary_unit(unit) if rotary else unit)
            rows.append(["" if rows else name.replace("_", "-"), words.format_map(verdict.evidence), shown])
    return rows


def _steps(name: str, verdict: Verdict, rotary: bool) -> list[Table]:
    """The constant speeds of a cycle, or the levels that z passes, one step a row."""
    tables = []
    for listed in ("program", "levels"):
        steps: Sequence[Mapping[str, float]] = verdict.evidence.get(listed, ())[:_STEPS]
        if steps:
            units = {key: rotary_unit(_IN_STEPS[key][1]) if rotary else _IN_STEPS[key][1] for key in steps[0]}
            rows: list[list[Cell]] = [
                [f"step {i}", *(Amount(step[key], unit) for key, unit in units.items())]
                for i, step in enumerate(steps, 1)
            ]
            tables.append(Table([f"not {name.replace('_', '-')}", *(_IN_STEPS[key][0] for key in units)], rows))
    return tables


def _curve(law: Law) -> Figure:
    """Steady friction over speed, and near rest."""

    def draw() -> Drawn:
        slow = float(law.scales(law.p).speed)
        wide, near = 20 * slow * np.linspace(-1, 1, 801), 10.0 ** np.linspace(-6, 3, 400) * slow
        units = ("rad/s", "N m") if law.rotary else ("m/s", "N")
        figure, axes = plots.figure([["wide", "near"]], 2.8)
        for name, v in (("wide", wide), ("near", near)):
            force = np.asarray(law.steady_force(v))
            of_v = scale([Quantity("v", units[0], "", v)], plain=name == "near")
            of_F = scale([Quantity("F", units[1], "", np.append(force, 0.0))])
            axes[name].plot(of_v.of(v), of_F.of(force), color=plots.COLORS[2])
            axes[name].set(xlabel=of_v.label, ylabel=of_F.label)
        plots.logarithmic(axes["near"], y=False)
        axes["wide"].set_title("constant speeds")
        axes["near"].set_title("near rest, and far")
        return figure

    return Figure("curve", "The steady friction force over speed.", draw)


def _replays(verdicts: Verdicts, contact: str, key: str, title: str) -> list[Chapter]:
    """A chapter of simulated counterexamples, if there are any."""
    figures = [
        _replay(name, v, contact, verdicts.law.rotary)
        for name, v in verdicts.properties.items()
        if v.holds is False and v.scenario is not None
    ]
    text = ["The motion of each counterexample. 'stribeck run' on its file gives the same result."]
    return [Chapter(key, title, text, figures=figures, on=PAGE)] if figures else []


def _replay(name: str, verdict: Verdict, contact: str, rotary: bool) -> Figure:
    """The motion of a counterexample, or nothing if it cannot be simulated."""
    words = name.replace("_", "-")

    def draw() -> Drawn | None:
        from stribeck.scenario import Scenario
        from stribeck.simulation import simulate

        assert verdict.scenario is not None
        try:
            return figure_of({f"not {words}": simulate(Scenario(verdict.scenario))})
        except StribeckError:
            return None

    unit = rotary_unit if rotary else str
    replayed = verdict.evidence.get("replay", {}).items()
    stated = ", ".join(f"{n} = {human(x, unit(_AT_THE_END[n.removeprefix('contact.')]), 4)}" for n, x in replayed)
    caption = f"Not {words}: {verdict.method}. At the end: {stated}."
    return Figure(f"{contact}_not_{name}" if contact else f"not_{name}", caption, draw)


# -- the smallest k_v ------------------------------------------------------------------------------------------------


def _steepness(by_law: Mapping[str, Steepness]) -> Chapter:
    """The smallest k_v, the k_v for each tolerance, and the cost."""
    rows: list[list[Cell]] = [
        [law, f"{r.name}, {_tolerance(r.tolerance, r.unit)}", _k_v(r.k_v, each.rotary), f"{r.method}: {r.detail}"]
        for law, each in by_law.items() for r in each.requirements
    ]  # fmt: skip
    tables = [Table(["law", "tolerance", "smallest k_v", "how it was found"], rows, prose=True)]
    if costs := {law: each.cost for law, each in by_law.items() if each.cost is not None}:
        unit = rotary_unit if any(each.rotary for each in by_law.values()) else str
        amounts: list[tuple[str, str, Callable[[Cost], float]]] = [
            ("largest step of explicit Euler", "s", lambda c: c.largest_step),
            ("stiffness", "1/s", lambda c: c.stiffness),
            ("valid for speeds up to", unit("m/s"), lambda c: c.v_max),
            ("|v| is smoothed below", unit("m/s"), lambda c: c.bend),
            ("largest d²F/dv² there", unit("N s^2/m^2"), lambda c: c.force_bend),
        ]
        price: list[list[Cell]] = [
            [words, *(Amount(quantity(cost), unit_of) for cost in costs.values())]
            for words, unit_of, quantity in amounts
        ]
        tables.append(Table(["cost", *costs], price))
    figure = Figure("steepness", "Each error against k_v; gray: tolerance.", lambda: errors_against_k_v(by_law))
    return Chapter("steepness", "The smallest k_v", tables=tables, figures=[figure])


def _tolerance(x: float, unit: str) -> str:
    return human(x, unit, 4) if unit else f"{digits(100 * x, count=4)} %"


def _k_v(k_v: float | None, rotary: bool) -> str:
    """A required k_v as text: a number (rounded up, to keep the tolerance), any, or none."""
    return "no value" if k_v is None else f"{rounded_up(k_v)} {'s/rad' if rotary else 's/m'}" if k_v else "any value"


def errors_against_k_v(by_law: Mapping[str, Steepness]) -> Drawn:
    """Plot each error against k_v, one panel a tolerance, with the chosen k_v marked. Call within the plots' style."""
    first = next(iter(by_law.values()))
    shown = [i for i in range(len(first.requirements)) if any(each.requirements[i].points for each in by_law.values())]
    panels = [str(i) for i in shown] or ["none"]
    rows = [panels[i : i + 2] for i in range(0, len(panels), 2)]
    if len(rows[-1]) < len(rows[0]):
        rows[-1] = rows[-1] * 2
    figure, axes = plots.figure(rows, 0.6 + 2.5 * len(rows))
    for i in shown:
        axis, wanted = axes[str(i)], first.requirements[i]
        for n, (law, each) in enumerate(by_law.items(), start=1):
            requirement = each.requirements[i]
            points = [(k, x) for k, x in requirement.points if x > 0]
            if points:
                k_v, measure = zip(*points, strict=True)
                plots.line(axis, n, k_v, measure, law)
            if requirement.k_v and requirement.achieved:
                axis.plot([requirement.k_v], [requirement.achieved], "o", color=plots.COLORS[n], markersize=5)
        axis.axhline(wanted.tolerance, color=plots.GRAY, linewidth=0.8)
        plots.logarithmic(axis)
        axis.set(xlabel=f"k_v ({'s/rad' if first.rotary else 's/m'})", title=wanted.name)
        quantity = wanted.name.partition(" ")[0]  # the creep, or an error; the title has the rest
        axis.set_ylabel(f"{quantity} ({wanted.unit})" if wanted.unit else f"relative {quantity}")
    if shown:
        plots.legend(figure, axes[str(shown[0])])
    return figure
