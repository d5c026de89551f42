"""The directive ``evidence``: a table from benchmarks/results/NAME.json, with its date and the commit that stored it.

The benchmarks print the same tables.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

RESULTS = (Path(__file__).resolve().parents[2] / "benchmarks" / "results").resolve()
Rows = tuple[list[str], list[list[object]]]


def number(x: object) -> str:
    """At most three digits; text as it stands."""
    if x is None:
        return "-"
    if isinstance(x, float):
        return f"{x:.0f}" if 1000 <= abs(x) < 1e5 else f"{x:.3g}"
    return str(x)


def listed(x: list[float]) -> str:
    """Numbers side by side."""
    return ", ".join(number(float(each)) for each in x)


def single(d: Any) -> Rows:
    """The table of single.json."""
    rows = [r for r in d["solvers"] if r.get("milliseconds")]
    return ["solver", "ms", "over Stribeck"], [
        [r["solver"], r["milliseconds"]["median"], r["ratio"]["median"]] for r in rows
    ]


def ensemble(d: Any) -> Rows:
    """The table of ensemble.json."""
    return ["solver", "what", "ms a lane (processor)", "ms a lane (wall)", "error"], [
        [r["solver"], r["what"], r["cpu_milliseconds"]["median"], r["wall_milliseconds"]["median"], r["error"]]
        for r in d["solvers"]
        if r.get("cpu_milliseconds")
    ]


def machines(d: Any) -> Rows:
    """The table of machines.json."""
    rows = [r for r in d["two_masses"] if r.get("seconds")]
    return ["solver", "ms", "over Stribeck"], [
        [r["solver"], 1e3 * r["seconds"]["median"], r["against_stribeck"]] for r in rows
    ]


def chains(d: Any) -> Rows:
    """The chains of machines.json."""
    return ["bodies", "solver", "ms", "over Stribeck"], [
        [chain["bodies"], r["solver"], 1e3 * r["seconds"]["median"], r["against_stribeck"]]
        for chain in d["chains"]
        for r in chain["solvers"]
        if r.get("seconds")
    ]


def startup(d: Any) -> Rows:
    """The table of startup.json."""
    return ["process", "s", "MB at most"], [
        [r["case"], r["seconds"]["median"], r["peak_megabytes"]] for r in d["cases"]
    ]


def backends(d: Any) -> Rows:
    """The table of backends.json."""
    return ["example", "WebAssembly over C, time", "first command, C (s)", "first command, WebAssembly (s)"], [
        [r["example"], r["ratio"]["median"], r["process"]["c"]["first"], r["process"]["wasm"]["first"]]
        for r in d["examples"]
    ]


def sampled(d: Any) -> Rows:
    """The table of sampled.json."""
    return ["machine", "encoder", "steps", "time over continuous control"], [
        [r["machine"], r["encoder"], r["steps"], r["ratio"]["median"]] for r in d["rows"]
    ]


def default_tolerance(d: Any) -> Rows:
    """The four numbers of a column are its quantiles of the scenarios' largest errors; the last two are shown."""
    return ["rtol", "y, 99 %", "y, largest", "v, 99 %", "v, largest", "F, 99 %", "F, largest", "steps, median"], [
        [r["rtol"], *(r[c][i] for c in "yvF" for i in (-2, -1)), r["steps"]] for r in d["table"]
    ]


def promise(d: Any) -> Rows:
    """The counts of promise.json, and the largest errors of the sets that kept the promise."""
    worst = ", ".join(f"{name} {x:.1e}" for name, x in d["worst_kept"].items())
    rows: list[list[object]] = [[what, count] for what, count in d["counts"].items()]
    return ["random sets", "count"], [*rows, [f"largest errors of those kept: {worst}", ""]]


def majorants(d: Any) -> Rows:
    """The table of majorants.json."""
    laws = list(next(iter(d["results"].values())))
    return ["law", *(f"{case}: time, deviation" for case in d["results"])], [
        [law, *(f"{r[law]['cpu_over_lugre']:.2f}, {r[law]['deviation_of_peak']:.1e}" for r in d["results"].values())]
        for law in laws
    ]


def discretization(d: Any) -> Rows:
    """The table of discretization.json."""
    return ["law", "way", "step (ms)", "error of y (mm)", "energy lost (share)", "drift (mm)"], [
        [
            r["law"], r["way"], 1e3 * r["step"], 1e3 * r["stick_slip_max_error"], float(r["energy_lost"]),
            1e3 * r["drift"],
        ]
        for r in d["rows"]
    ]  # fmt: skip


def in_mujoco(d: Any) -> Rows:
    """The table of in_mujoco.json."""
    return [
        "way, integrator", "step (ms)", "stick-slip error (mm)", "break-away error (N)", "drift error (um)", "us a step",
    ], [
        [
            f"{r['way']}, {r['integrator']}", 1e3 * r["step"], 1e3 * r["stick_slip_max_error"], r["break_away_error"],
            1e6 * r["drift_error"], r["microseconds_a_step"],
        ]
        for r in d["rows"]
    ]  # fmt: skip


def arm_instructions(d: Any) -> Rows:
    """One row a law; in brackets the most, where it is more than the mean."""
    rows: dict[str, dict[str, object]] = {}
    for r in d["rows"]:
        text = f"{r['mean']} ({r['most']})" if r["most"] > r["mean"] else r["mean"]
        rows.setdefault(r["law"], {})[r["target"]] = text
    laws = {n: row for n, row in rows.items() if " " not in n}
    return ["law", *next(iter(laws.values()))], [[f"`{n}`", *row.values()] for n, row in laws.items()]


def controller_instructions(d: Any) -> Rows:
    """The table of controller_instructions.json."""
    return ["controller", "target", "mean", "at most"], [
        [r["controller"], r["target"], r["mean"], r["most"]] for r in d["rows"]
    ]


def learning(d: Any) -> Rows:
    """The table of learning.json; numbers side by side are those of its steps in time, from the smallest."""
    rates = d["steps_a_processor_second"]
    rows = []
    for row in d["rows"]:
        steps = [row[key] for key in sorted(set(row) - {"engine"}, key=float)]
        values = [listed([step[what] for step in steps]) for what in ("creep", "break_away", "energy")]
        rows.append([row["engine"], steps[0]["held"], *values, rates.get(row["engine"])])
    return ["engine", "held (s)", "creep (m/s)", "break-away (N)", "energy (J)", "steps a processor second"], rows


def design_attack(d: Any) -> Rows:
    """Of design_attack.json how many verdicts and factors agree, by kind of machine and of compensation."""
    kinds: dict[tuple[str, str], list[tuple[bool, bool]]] = {}
    for what in ("verdicts", "factors"):
        for r in d[what]:
            kinds.setdefault((what, r["kind"]), []).append((r["agrees"], r.get("chance", False)))
    head = ["what", "kind", "asked", "agree", "decided by chance"]
    return head, [[*key, len(x), *map(sum, zip(*x, strict=True))] for key, x in kinds.items()]


def verdicts(d: Any) -> Rows:
    """The table of verdicts.json."""
    words = ("laws", "verdicts", "undecided", "wrong", "crashes")
    return list(words), [[d["all"][word] for word in words]]


def learning_gpu(d: Any) -> Rows:
    """The speeds of learning_gpu.json: a column for each number of worlds."""
    worlds = sorted(d["steps_a_second"], key=int)
    engines = list(d["steps_a_second"][worlds[0]])
    rows: list[list[object]] = [[name, *(d["steps_a_second"][n][name] / 1e6 for n in worlds)] for name in engines]
    return [f"engine, on an {d['gpu']}", *(f"{int(n):,} worlds (million steps a second)" for n in worlds)], rows


def coverage(d: Any) -> Rows:
    """The counts of coverage.json, added up by kind of record."""
    kinds: dict[str, list[int]] = {}
    for name, c in d["cases"].items():
        kind = "machine that lacks a term" if "lacks" in name else name.partition(",")[0]
        counts = (c["experiments"], c["numbers"], c["identifiable"], c["interval"], c["range"])
        kinds[kind] = [a + b for a, b in zip(kinds.get(kind, [0] * 5), counts, strict=True)]
    head = ["records", "experiments", "numbers", "identifiable", "intervals hold", "ranges hold"]
    return head, [[kind, *counts] for kind, counts in kinds.items()]


def percent(x: float | None, digits: int = 1) -> str | None:
    """A share."""
    return None if x is None else f"{100 * x:.{digits}f} %"


# of estimates.json, the families of records
INCOMPLETE = {
    "lacking": "a term lacks, or none", "bent": "friction bends otherwise", "pointed": "another exponent",
    "other": "friction of another kind",
}  # fmt: skip
PAIRS = {"agree": "halves; other motions", "same": "the same motion twice"}
MOTIONS = {"held": "speeds measured", "rigs": "encoders", "kinds": "rigs of other kinds"}


def estimates(d: Any) -> Rows:
    """How many intervals and ranges of estimates.json hold the truth."""
    head = [
        "records",
        "seeds",
        "estimates",
        "interval holds",
        "range holds",
        "usable",
        "levels",
        "range holds",
        "usable",
    ]
    keys = ("interval", "range", "usable"), ("levels range", "levels usable", "levels half width")
    rows: list[list[object]] = [
        [
            f"{name}: {text}", f"{c['first']} to {c['first'] + c['seeds'] - 1}", c["n"], *(percent(c[k]) for k in keys[0]),
            c.get("levels n"), *(percent(c.get(k)) for k in keys[1]),
        ]
        for name, text in INCOMPLETE.items()
        if (c := d.get(name))
    ]  # fmt: skip
    complete = [d[n] for n in (*INCOMPLETE, *PAIRS) if "complete n" in d.get(n, {})]
    total = sum(c["complete n"] for c in complete)
    share = percent(sum(c["complete n"] * c["complete interval"] for c in complete) / max(total, 1))
    return [*head, "half width"], [*rows, ["all whose law is complete", None, total, share, *[None] * 6]]


def other_kinds(d: Any) -> Rows:
    """How many ranges hold in each kind of the family ``other`` in estimates.json."""
    c = d.get("other", {})
    kinds = [name.removesuffix(" usable") for name in c if name.endswith(" usable")]
    rows = [[kind, c[f"{kind} n"], percent(c[f"{kind} range"]), percent(c[f"{kind} usable"])] for kind in kinds]
    return ["friction", "estimates", "range holds", "usable"], rows


def agreements(d: Any) -> Rows:
    """How often the intervals of two records in estimates.json agree."""
    head = ["two records", "seeds", "pairs", "intervals agree", "median difference, in joint intervals"]
    return head, [
        [text, c["seeds"], c["n"], percent(c["agree"]), c["median difference"]]
        for name, text in PAIRS.items()
        if (c := d.get(name))
    ]


def further_motions(d: Any) -> Rows:
    """Errors on further motions in estimates.json; all once more by whether they leave the ranges that the fit saw."""
    what = ("mean log ratio", "within 1 %", "within 5 %")
    rows: list[list[Any]] = [
        [x, d[n]["seeds"], *(d[n][k] for k in ("n", *what, "worst"))] for n, x in MOTIONS.items() if n in d
    ]
    for part in ("inside", "outside"):
        of = [d[n] for n in MOTIONS if f"{part} n" in d.get(n, {})]
        count = sum(c[f"{part} n"] for c in of)
        means = [sum(c[f"{part} {k}"] * c[f"{part} n"] for c in of) / max(count, 1) for k in what]
        rows.append([part, None, count, *means, max((c[f"{part} worst"] for c in of), default=0.0)])
    return ["rigs", "seeds", "motions", *what, "worst"], [
        [*row[:3], f"{row[3]:+.2f}", percent(row[4], 0), percent(row[5], 0), f"{row[6]:+.2f}"] for row in rows
    ]


def bounds(d: Any) -> Rows:
    """How many ranges of static friction and Stribeck velocity, which may be bounds, hold in estimates.json."""
    rows: list[list[object]] = []
    for label in ("F_s two-sided", "F_s at least", "v_s two-sided", "v_s at most"):
        of = [(d[n][f"{label} n"], d[n][f"{label} holds"]) for n in INCOMPLETE if f"{label} n" in d.get(n, {})]
        count = sum(n for n, _ in of)
        rows.append([label, count, percent(sum(n * held for n, held in of) / max(count, 1))])
    return ["estimate", "n", "range holds"], rows


def fit_speed(d: Any) -> Rows:
    """The table of fit_speed.json."""
    head = ["fit", "processor (s)", "wall (s)", "memory (GB)"]
    return head, [[r["fit"], r["processor_s"], r["wall_s"], r["memory_gb"]] for r in d["fits"]]


def explorer(d: Any) -> Rows:
    """The table of explorer.json."""
    return ["screen", "charts", "simulation (ms)"], [
        [n, r["charts"], r["solved_ms"]["median"]] for n, r in d["cases"].items()
    ]


TABLES: dict[str, Callable[[Any], Rows]] = {
    "single": single, "ensemble": ensemble, "machines": machines, "chains": chains, "startup": startup,
    "backends": backends, "sampled": sampled, "default_tolerance": default_tolerance, "promise": promise,
    "majorants": majorants,
    "discretization": discretization, "in_mujoco": in_mujoco, "arm_instructions": arm_instructions,
    "controller_instructions": controller_instructions, "learning": learning, "learning_gpu": learning_gpu,
    "design_attack": design_attack, "verdicts": verdicts, "explorer": explorer, "coverage": coverage,
    "fit_speed": fit_speed, "estimates": estimates, "agreements": agreements, "further_motions": further_motions,
    "bounds": bounds, "other_kinds": other_kinds,
}  # fmt: skip
# tables whose file has another name
FILES = {"chains": "machines", **dict.fromkeys(("agreements", "further_motions", "bounds", "other_kinds"), "estimates")}


def stored(file: Path) -> str:
    """When the file was committed and in which commit; empty outside a checkout."""
    command = ["git", "-C", str(file.parent), "log", "-1", "--format=commit %h of %cs", "--", file.name]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
    except OSError:
        return ""


def table(name: str, data: Any) -> str:
    """A table of results as Markdown."""
    head, rows = TABLES[name](data)
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(number(x).replace("|", "\\|") for x in line) + " |" for line in lines)


def markdown(name: str) -> str:
    """The table as Markdown, and the line about its origin."""
    file = RESULTS / f"{FILES.get(name, name)}.json"
    data = json.loads(file.read_text(encoding="utf-8"))
    machine = data.get("machine", {})
    about = [
        f"`benchmarks/results/{file.name}`",
        f"measured {machine['date'][:10]}" if "date" in machine else "",
        f"{machine['processor']}, {machine['cores']} cores" if "processor" in machine else "",
        stored(file),
    ]
    return f"{table(name, data)}\n\n*{'; '.join(x for x in about if x)}.*\n"


class Evidence(SphinxDirective):
    """``{evidence} NAME``: the table of that result."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The table and its origin."""
        name = self.arguments[0]
        self.env.note_dependency(str(RESULTS / f"{FILES.get(name, name)}.json"))
        return self.parse_text_to_nodes(markdown(name))


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("evidence", Evidence)
    return {"parallel_read_safe": True}
