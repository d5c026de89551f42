"""What the laws guarantee: the five properties of each, with the figures that show why."""

from __future__ import annotations

from typing import Any

from stribeck import laws
from stribeck.analysis.properties import NAMES, Verdicts, check
from stribeck.laws.base import Law
from stribeck.paper import evidence
from stribeck.paper.common import Done, Variant
from stribeck.report.page import Chapter, Table

LAWS: dict[str, Variant] = {
    "lugre": ("lugre", {}),
    "lugre_arctan": ("lugre_arctan", {"k_v": 1e6}),
    "lugre_sobczyk": ("lugre_sobczyk", {"k_v": 1e6}),
    "lugre_majorant": ("lugre_majorant", {"k_v": 1e6}),
    "elastoplastic": ("elastoplastic", {"z_ba": 7e-6}),
    "elastoplastic_sobczyk": ("elastoplastic_sobczyk", {"z_ba": 7e-6, "k_v": 1e6}),
    "elastoplastic_majorant": ("elastoplastic_majorant", {"z_ba": 7e-6, "k_v": 1e6}),
    "dahl": ("dahl", {}),
}
_WORDS = {True: "yes", False: "no", None: "undecided"}
_HERE = "--parameters canudas1995 --set k_v=1e6"


def chapter(done: Done) -> Chapter:
    """The matrix, the paper's three properties with a verdict, and a figure for each reason."""
    made = {name: laws.law(law, "canudas1995", **own) for name, (law, own) in LAWS.items()}
    verdicts = {name: check(law) for name, law in made.items()}
    cycle, energy = evidence.energy(made["lugre_sobczyk"])
    drift, dither = evidence.dither(LAWS)
    creep, creeping = evidence.creep()
    figures = [evidence.storage(made), energy, evidence.unbounded(), dither, creeping]
    text = (
        "The paper's case for its law is that it keeps three properties of LuGre: (i) a unique solution, (ii) a bounded z, "
        "(iii) passivity from velocity to friction. Each is decided here for every law, with the parameters of Table 1: 'yes' "
        "is a proof by exact algebra or interval arithmetic over all v and z, 'no' a counterexample that was replayed. Table 1 "
        "does not meet LuGre's own condition for passivity, sigma_1 (F_s - F_c) <= sigma_2 F_c (158 against 0.4 N s/m), so that no "
        "law of its kind is passive with it; the last column is the speed up to which each one is.",
        "docs/theory.md has the proofs; stribeck check decides for parameters of your own.",
    )
    matrix = Table(["law", *NAMES, "passive for |v| up to (m/s)"], [_row(name, v) for name, v in verdicts.items()])
    numbers: dict[str, Any] = {
        "verdicts": {name: {n: v[n].holds for n in NAMES} for name, v in verdicts.items()},
        "largest_v_max": {name: v["passive"].evidence.get("largest_v_max") for name, v in verdicts.items()},
        "cycle": cycle, "drift": drift, "creep": creep,
    }  # fmt: skip
    tables = [matrix, _paper(verdicts, cycle, made["lugre_sobczyk"])]
    return Chapter("guarantees", "What the laws guarantee", text, tables, figures, numbers)


def _row(name: str, verdicts: Verdicts) -> list[str]:
    passive = verdicts["passive"]
    largest = passive.evidence.get("largest_v_max")
    speed = "any" if passive.holds else "none" if largest == 0 else "-" if largest is None else f"{largest:.3g}"
    return [name, *(_WORDS[verdicts[n].holds] for n in NAMES), speed]


def _paper(verdicts: dict[str, Verdicts], cycle: dict[str, float], law: Law) -> Table:
    """What the paper says of the properties, what was found, and the command that replays it."""
    sobczyk, arctan, lugre = (verdicts[f"lugre{kind}"] for kind in ("_sobczyk", "_arctan", ""))
    level = max((each["z_over_Z"] for each in arctan["bounded"].evidence.get("levels", [])), default=0.0)
    rows = [
        ["LuGre has (i) and (ii), and (iii) for proper parameters",
         f"(i) {_WORDS[lugre['unique'].holds]}, (ii) {_WORDS[lugre['bounded'].holds]}; with Table 1 it is passive only up to "
         f"{lugre['passive'].evidence.get('largest_v_max') or 0:.3g} m/s",
         "confirmed", "stribeck check lugre --parameters canudas1995"],
        ["Whether z of the first smooth law is bounded is an open question",
         f"it is not: z tends to g pi/(2 arctan(k_v |v|)), without limit as v -> 0; replayed up to {level:.3g} Z",
         "settled: not bounded" if arctan["bounded"].holds is False else "open", f"stribeck check lugre_arctan {_HERE}"],
        ["The proposed law has (i) and (ii)",
         f"(i) {_WORDS[sobczyk['unique'].holds]}, (ii) {_WORDS[sobczyk['bounded'].holds]}, with |z| <= F_s/sigma_0; and "
         f"dz/dt is continuously differentiable: {_WORDS[sobczyk['smooth'].holds]}",
         "confirmed" if sobczyk["unique"].holds and sobczyk["bounded"].holds else "not confirmed",
         f"stribeck check lugre_sobczyk {_HERE}"],
        ["The proposed law has (iii), proven in Sobczyk (2009)",
         f"for no parameters and no limit on the speed: a cycle of {cycle['time']:.2g} s takes {1e9 * cycle['put_in']:.3g} nJ and "
         f"gives back {1e9 * cycle['drawn_out']:.3g} nJ, a slower one more, without limit",
         "does not hold" if cycle["drawn_out"] > cycle["put_in"] else "confirmed",
         f"stribeck check lugre_sobczyk {_HERE} --v-max 1e-5 --out found; stribeck run found/passive.toml"],
        ["Its elasto-plastic extension (Remark 1) is possible too",
         f"bounded: {_WORDS[verdicts['elastoplastic_sobczyk']['bounded'].holds]}, smooth: "
         f"{_WORDS[verdicts['elastoplastic_sobczyk']['smooth'].holds]}; but it drifts, and it is not passive",
         "confirmed with a remark", f"stribeck check elastoplastic_sobczyk {_HERE} --set z_ba=7e-6"],
        ["A smooth law should keep the properties (the purpose of Section 3)",
         "with a majorant of |v| in its place they are kept: passive whenever LuGre is, for k_v >= 2 sigma_1/(pi F_s), and without drift "
         "below sigma_0 z_ba",
         "possible", f"stribeck check elastoplastic_majorant {_HERE} --set z_ba=7e-6 --set v_d=0.02"],
    ]  # fmt: skip
    return Table(["the paper", "found", "verdict", "replay"], rows, prose=True)
