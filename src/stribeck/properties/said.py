"""How a check is told: the documents of verdicts on a law, and on a machine's contacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from stribeck.constants import DECIDED, SHOWN, rotary_unit
from stribeck.errors import StribeckError
from stribeck.laws import said as of_law
from stribeck.laws.base import Law
from stribeck.mouth import plots
from stribeck.mouth.cells import digits, rounded_up
from stribeck.mouth.document import PAGE, Cell, Chapter, Document, Figure, Head, Table
from stribeck.mouth.quantities import Quantity, scale
from stribeck.properties.verdicts import Verdict, Verdicts, ranges_in_words
from stribeck.simulation.drawing import figure_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawn

    from stribeck.properties.ports import MachineVerdicts
    from stribeck.properties.steepness import Steepness

_MEANING = {
    "unique": "one z(t) for every v(t)",
    "bounded": "z stays within a bound, whatever v(t)",
    "smooth": "dF/dt exists wherever dv/dt does",
    "passive": "no motion draws energy from friction",
    "drift_free": "below some load the contact is elastic: no creep",
}
_AGAIN = {True: ", verified", False: ", NOT CONFIRMED", None: ""}
_LISTED = ("programme", "levels")  # evidence that is a list of steps
_STEPS = 40  # of a list that is shown
_SENSE = "Yes is proved; for no there is a counterexample. The constants are taken as exact."


def law(found: Verdicts) -> Document:
    """The verdicts on a law: first the smallest k_v if tolerances were given."""
    chapters = [_steepness(found.steepness)] if found.steepness else []
    if found.properties:
        chapters.append(_verdicts(found, "verdicts", "Verdicts"))
    chapters += [
        Chapter("curve", "Friction at held speeds", figures=[_curve(found.law)], on=PAGE),
        *_replays(found, "", "replays", "The counterexamples"),
        of_law.chapter(found.law),
    ]
    return Document(found.law.name, _in_short(found), found.headings(), chapters)


def machine(found: MachineVerdicts) -> Document:
    """What the contacts guarantee, and what follows for the machine."""
    contacts: list[list[Cell]] = [
        [name, v.law.name, ranges_in_words(found.ranges[name]) or "nothing", DECIDED[v["passive"].holds]]
        for name, v in found.contacts.items()
    ]
    tables = [Table(["contact", "law", "what varies", "passive"], contacts, prose=True, on=PAGE)]
    if found.ports:
        tables.append(Table(["port", "what acts there"], [list(row) for row in found.ports.items()], prose=True))
    text = [
        "A machine of passive contacts, links and pendulums is passive from its ports to the velocities there: no motion "
        "draws more energy from it than was put in. What varies is bounded by the file: signals over the whole run, positions "
        "and speeds without limit."
    ]
    chapters = [Chapter("machine", "The machine", text, tables)]
    for name, verdicts in found.contacts.items():
        chapters.append(_verdicts(verdicts, f"contact-{name}", f"Contact {name}", headed=True))
        chapters += _replays(verdicts, name, f"replays-{name}", f"Counterexamples of {name}")
    laws = [of_law.chapter(v.law, f"law-{i}", f" of {name}") for i, (name, v) in enumerate(found.contacts.items())]
    lead = f"passive at its ports: {SHOWN[found.passive]}: {found.why}"
    return Document(found.name, lead, (), [*chapters, *laws])


def _in_short(found: Verdicts) -> str:
    """Which properties are proved, refuted and undecided."""
    if not found.properties:
        return "no k_v meets the tolerances"
    limit = f" for |v| up to {found.v_max:g} {'rad/s' if found.law.rotary else 'm/s'}" if found.v_max else ""
    named = {
        word: ", ".join(name.replace("_", "-") for name, v in found.properties.items() if v.holds is holds)
        for word, holds in ((f"proved{limit}", True), ("refuted", False), ("undecided", None))
    }
    return "; ".join(f"{word}: {names}" for word, names in named.items() if names)


def _verdicts(found: Verdicts, key: str, title: str, headed: bool = False) -> Chapter:
    """The properties, how each was decided with its evidence, and for which histories it holds."""
    rows: list[list[Cell]] = [
        [name.replace("_", "-"), _MEANING[name], DECIDED[v.holds], "\n".join([v.reason + _AGAIN[v.verified], *_evidence(v)])]
        for name, v in found.properties.items()
    ]  # fmt: skip
    table = Table(["property", Head("meaning", on=PAGE), "holds", "how it was decided"], rows, prose=True)
    facts = found.headings() if headed else []
    return Chapter(key, title, [_SENSE], [table], facts=facts, headed=headed)


def _evidence(verdict: Verdict) -> list[str]:
    """The evidence in short: numbers and words; of lists their entries."""
    lines = []
    plain = {n: x for n, x in verdict.evidence.items() if isinstance(x, int | float | str) and n != "reason"}
    if plain:
        lines.append(", ".join(f"{n} {x:.9g}" if isinstance(x, float) else f"{n} {x}" for n, x in plain.items()))
    for name in _LISTED:
        steps: Sequence[Mapping[str, float]] = verdict.evidence.get(name, ())
        lines += [", ".join(f"{n} {x:.6g}" for n, x in step.items()) for step in steps[:_STEPS]]
    return lines


def _curve(law: Law) -> Figure:
    """Steady friction, and near rest."""

    def draw() -> Drawn:
        slow = float(law.scales(law.p).speed)
        wide, near = 20 * slow * np.linspace(-1, 1, 801), 10.0 ** np.linspace(-6, 3, 400) * slow
        units = ("rad/s", "N m") if law.rotary else ("m/s", "N")
        made, axes = plots.figure([["wide", "near"]], 2.8)
        for name, v in (("wide", wide), ("near", near)):
            force = np.asarray(law.steady_force(v))
            of_v = scale([Quantity("v", units[0], "", v)], plain=name == "near")
            of_F = scale([Quantity("F", units[1], "", np.append(force, 0.0))])
            axes[name].plot(of_v.of(v), of_F.of(force), color=plots.COLOURS[2])
            axes[name].set(xlabel=of_v.label, ylabel=of_F.label)
        plots.logarithmic(axes["near"], y=False)
        axes["wide"].set_title("held speeds")
        axes["near"].set_title("near rest, and far")
        return made

    return Figure("curve", "The friction force when a speed is held.", draw)


def _replays(found: Verdicts, of: str, key: str, title: str) -> list[Chapter]:
    """A chapter of counterexamples as motions, where there are any."""
    figures = [
        _replay(name, v, of) for name, v in found.properties.items() if v.holds is False and v.scenario is not None
    ]
    text = ["Each counterexample as a motion: 'stribeck run' on its file gives the same numbers."]
    return [Chapter(key, title, text, figures=figures, on=PAGE)] if figures else []


def _replay(name: str, verdict: Verdict, of: str) -> Figure:
    """The motion of a counterexample; none where it cannot be simulated."""
    words = name.replace("_", "-")

    def draw() -> Drawn | None:
        from stribeck.scenario import Scenario
        from stribeck.simulation import simulate

        assert verdict.scenario is not None
        try:
            return figure_of(simulate(Scenario(verdict.scenario)), f"not {words}")
        except StribeckError:
            return None

    stated = ", ".join(f"{n} = {x:.6g}" for n, x in verdict.evidence.get("replay", {}).items())
    caption = f"Not {words}: {verdict.method}. At the end: {stated}."
    return Figure(f"{of}_not_{name}" if of else f"not_{name}", caption, draw)


# -- the smallest k_v ------------------------------------------------------------------------------------------------


def _steepness(found: Mapping[str, Steepness]) -> Chapter:
    """The smallest k_v, what each tolerance needs, and what it costs."""
    facts, rows = [], list[list[Cell]]()
    for law, each in found.items():
        unit = rotary_unit if each.rotary else str
        speed, steep = unit("m/s"), unit("s/m")
        facts.append(f"{law}: k_v = {_k_v(each.k_v, steep)}")
        for r in each.requirements:
            row = f"{r.name}, {_tolerance(r.tolerance, r.unit)}", _k_v(r.k_v, steep), f"by {r.method}: {r.detail}"
            facts.append(f"{row[0]}: {row[1]}, {row[2]}")
            rows.append([law, *row])
        if (c := each.cost) is not None:
            body = "" if c.body_stiffness is None else f"; with the body: eigenvalues up to {c.body_stiffness:.4g} 1/s"
            steps = f"stiffness {c.stiffness:.4g} 1/s, explicit steps below {c.largest_step:.4g} s"
            facts.append(f"up to {c.v_max:.4g} {speed}: {steps}{body}")
            bent = f"dF/dv changes by up to {c.force_bend:.4g} {unit('N s/m')} per {speed} there"
            facts.append(f"|v| is rounded within {c.bend:.4g} {speed}; {bent}")
    table = Table(["law", "tolerance", "needs k_v", "how it was found"], rows, prose=True, on=PAGE)
    figure = Figure("steepness", "Each error against k_v; grey: tolerated.", lambda: errors_against_k_v(found))
    return Chapter("steepness", "The smallest k_v", tables=[table], figures=[figure], facts=facts)


def _tolerance(x: float, unit: str) -> str:
    return f"{digits(x, count=4)} {unit}" if unit else f"{digits(100 * x, count=4)} %"


def _k_v(k_v: float | None, unit: str) -> str:
    """A required k_v: a number, rounded up as a smaller one would miss the tolerance; any, or none."""
    return "none will do" if k_v is None else f"{rounded_up(k_v)} {unit}" if k_v else "any will do"


def errors_against_k_v(found: Mapping[str, Steepness]) -> Drawn:
    """What is tolerated against k_v, a panel for each tolerance, the chosen k_v marked. Call within the plots' style."""
    first = next(iter(found.values()))
    shown = [i for i in range(len(first.requirements)) if any(each.requirements[i].points for each in found.values())]
    panels = [str(i) for i in shown] or ["none"]
    rows = [panels[i : i + 2] for i in range(0, len(panels), 2)]
    if len(rows[-1]) < len(rows[0]):
        rows[-1] = rows[-1] * 2
    made, axes = plots.figure(rows, 0.6 + 2.5 * len(rows))
    for i in shown:
        axis, wanted = axes[str(i)], first.requirements[i]
        for n, (law, each) in enumerate(found.items(), start=1):
            one = each.requirements[i]
            points = [(k, x) for k, x in one.points if x > 0]
            if points:
                k_v, measure = zip(*points, strict=True)
                plots.line(axis, n, k_v, measure, law)
            if one.k_v and one.achieved:
                axis.plot([one.k_v], [one.achieved], "o", color=plots.COLOURS[n], markersize=5)
        axis.axhline(wanted.tolerance, color=plots.GREY, linewidth=0.8)
        plots.logarithmic(axis)
        axis.set(xlabel=f"k_v ({'s/rad' if first.rotary else 's/m'})", title=wanted.name)
        axis.set_ylabel((wanted.unit and f"({wanted.unit})") or "share")
    if shown:
        plots.legend(made, axes[str(shown[0])])
    return made
