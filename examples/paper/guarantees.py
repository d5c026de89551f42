"""What the laws guarantee: the five properties of each, and what the paper says of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from examples.paper.common import BRISTLES, Chapter, Done, Printed, finish
from examples.paper.statements import passivity_cycle
from stribeck import laws
from stribeck.constants import DECIDED
from stribeck.laws.base import Law
from stribeck.mouth import plots
from stribeck.mouth.document import Table
from stribeck.properties import NAMES, Verdicts, check
from stribeck.properties.storage import Storage

_HERE = "--parameters canudas1995 --set k_v=1e6"
_V_MAX = 0.02  # m/s: LuGre with Table 1 is passive up to about twice that


def chapter(done: Done) -> Chapter:
    """The matrix, the paper's statements with a verdict, and the storage interval of each law."""
    built = {name: laws.law(law, "canudas1995", **own) for name, (law, own) in BRISTLES.items()}
    verdicts = {name: check(law) for name, law in built.items()}
    cycle = passivity_cycle(1e6)
    text = (
        "The paper's case for its law is that it keeps three properties of LuGre: (i) a unique solution, (ii) a bounded z, "
        "(iii) passivity from velocity to friction. Each is decided here for every law, with the parameters of Table 1: 'yes' "
        "is a proof by exact algebra or interval arithmetic over all v and z, 'no' a counterexample that was replayed. Table 1 "
        "does not meet LuGre's own condition for passivity, sigma_1 (F_s - F_c) <= sigma_2 F_c (158 against 0.4 N s/m), so no "
        "law of its kind is passive with it at every speed; the last column is the speed up to which each one is (by sampling; - "
        "where it was not found in time).",
        "docs/explanation/theory.md has the proofs; stribeck check decides for parameters of your own.",
    )
    matrix = Table(["law", *NAMES, "passive for |v| up to (m/s)"], [_row(name, v) for name, v in verdicts.items()])
    numbers: dict[str, object] = {
        "verdicts": {name: {n: v[n].holds for n in NAMES} for name, v in verdicts.items()},
        "sampled_v_max": {name: v["passive"].evidence.get("sampled_v_max") for name, v in verdicts.items()},
        "cycle": cycle,
    }
    tables = [matrix, _paper(verdicts, cycle)]
    return Chapter("guarantees", "What the laws guarantee", text, tables, [_storage(built)], numbers)


def _row(name: str, verdicts: Verdicts) -> list[str]:
    passive = verdicts["passive"]
    largest = passive.evidence.get("sampled_v_max")
    speed = "any" if passive.holds else "none" if largest == 0 else "-" if largest is None else f"{largest:.3g}"
    return [name, *(DECIDED[verdicts[n].holds] for n in NAMES), speed]


def _paper(verdicts: Mapping[str, Verdicts], cycle: Mapping[str, float]) -> Table:
    """What the paper says of the properties, what was found, and the command that replays it."""

    def result(law: str, *names: str) -> str:
        return ", ".join(f"{name.replace('_', ' ')}: {DECIDED[verdicts[law][name].holds]}" for name in names)

    def all_hold(law: str, *names: str) -> bool:
        return all(verdicts[law][name].holds for name in names)

    bounded = verdicts["lugre_arctan"]["bounded"]
    level = max((each["z_over_Z"] for each in bounded.evidence.get("levels", [])), default=0.0)
    draws = cycle["drawn_out"] > cycle["put_in"]
    rows = [
        ["LuGre has (i) and (ii), and (iii) with a proper choice of its parameters",
         f"{result('lugre', 'unique', 'bounded', 'passive')} with Table 1, which is no such choice",
         "confirmed" if all_hold("lugre", "unique", "bounded") else "not confirmed",
         "stribeck check lugre --parameters canudas1995"],
        ["Whether z of the first smooth law is bounded is an open question",
         f"it is not: z tends to g pi/(2 arctan(k_v |v|)), without limit as v -> 0; replayed up to {level:.3g} Z",
         "settled: not bounded" if bounded.holds is False else "open", f"stribeck check lugre_arctan {_HERE}"],
        ["The proposed law has (i) and (ii)",
         f"{result('lugre_sobczyk', 'unique', 'bounded')}, |z| <= F_s/sigma_0; {result('lugre_sobczyk', 'smooth')}",
         "confirmed" if all_hold("lugre_sobczyk", "unique", "bounded") else "not confirmed",
         f"stribeck check lugre_sobczyk {_HERE}"],
        ["The proposed law has (iii), proven in Sobczyk (2009)",
         f"for no parameters, however slow it moves: a cycle of {cycle['time']:.2g} s takes {1e9 * cycle['put_in']:.3g} nJ and "
         f"gives back {1e9 * cycle['drawn_out']:.3g} nJ, a slower one more, without limit",
         "does not hold" if draws else "confirmed",
         f"stribeck check lugre_sobczyk {_HERE} --v-max 1e-5 --out found; stribeck run found/passive.toml"],
        ["The approximation extends to the elasto-plastic law (Remark 1)",
         f"{result('elastoplastic_sobczyk', 'bounded', 'smooth', 'passive', 'drift_free')}",
         "confirmed with a remark", f"stribeck check elastoplastic_sobczyk {_HERE} --set z_ba=7e-6"],
        ["A smooth law should keep the properties (the purpose of Section 3)",
         "it can: with a majorant of |v| it is passive whenever LuGre is (k_v >= 2 sigma_1/(pi F_s)); "
         f"elastoplastic_majorant is {result('elastoplastic_majorant', 'bounded', 'smooth', 'drift_free')}",
         "possible", f"stribeck check elastoplastic_majorant {_HERE} --set z_ba=7e-6 --set v_d=0.02"],
    ]  # fmt: skip
    return Table(["the paper", "computed", "verdict", "replay"], rows, prose=True)


def _storage(made: Mapping[str, Law]) -> Printed:
    """L(z) and U(z) of each law: where the one passes the other there is no storage function."""
    names = list(made)
    share = np.concatenate([np.linspace(0.004, 0.9, 90), np.linspace(0.905, 0.998, 30)])
    with plots.style():
        figure, axes = plots.figure([names[:4], names[4:]], 4.6)
        for name, law in made.items():
            Z, axis = float(law.z_bound(law.p)), axes[name]
            scale = law.p.sigma_0 * Z
            low, high = (np.clip(x / scale, -9, 9) for x in Storage(law, _V_MAX, reach=Z).interval(share * Z))
            none = low > high * (1 + 1e-9) + 1e-12
            axis.fill_between(share, low, high, where=~none, color=plots.COLORS[6], alpha=0.35, linewidth=0)
            axis.fill_between(share, high, low, where=none, color=plots.COLORS[1], alpha=0.35, linewidth=0)
            plots.line(axis, 2, share, high, "U: energy that winding up needs")
            plots.line(axis, 1, share, low, "L: energy that unwinding gives back")
            axis.plot(share, share, color=plots.GRAY, linewidth=0.8, label="sigma_0 z")
            axis.set(title=name, ylim=(-0.4, 3.4), xlim=(0, 1))
        for name in names[4:]:
            axes[name].set_xlabel("z/Z")
        for name in (names[0], names[4]):
            axes[name].set_ylabel("slope / (sigma_0 Z)")
        plots.legend(figure, axes[names[0]])
        return finish(
            figure, "guarantees_storage",
            f"The slope of a storage function must lie between L and U (Table 1, |v| <= {_V_MAX:g} m/s, Z = F_s/sigma_0, Dahl's "
            "F_c/sigma_0). Where L is above U (orange) there is none, and two speeds by turns draw energy: in both laws with the "
            "drive S_0^2 v for every z, however slow; in lugre_arctan where z is large. LuGre, the majorants and the other "
            "elasto-plastic laws have room for one at this speed.",
        )  # fmt: skip
