"""``stribeck check``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from json import dumps
from math import ceil, floor, inf, isfinite, log10, nan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.shared import Json, Trust, Undetermined, app, place
from stribeck.errors import InputError, left_out, note

if TYPE_CHECKING:
    from stribeck.laws.base import Law
    from stribeck.properties import Verdict, Verdicts
    from stribeck.properties.ports import MachineVerdicts
    from stribeck.properties.steepness import Steepness
    from stribeck.scenario import Scenario

_DEFAULT_SET = "canudas1995"
# What an older check leaves: scenarios as _write_scenarios begins them, and pictures of them, which say by name what they are.
_COUNTEREXAMPLES = {"*.toml": r"# \S+ is not \w+: "} | {f"*not_*.{kind}": "" for kind in ("svg", "png", "pdf")}
STEEPNESS = "Steepness"
_BESIDE = 23  # columns, where the words of a verdict begin

# Tolerances, and what belongs to them: the smallest k_v that meets them is found.
Creep = Annotated[
    float | None,
    typer.Option(
        metavar="M/S", rich_help_panel=STEEPNESS,
        help="Find the smallest k_v whose creep under a held load is at most this (m/s).",
    ),
]  # fmt: skip
Share = Annotated[
    float | None,
    typer.Option(
        metavar="X", rich_help_panel=STEEPNESS, help="Load of --creep and --presliding-error over F_s; 0.95 unless given."
    ),
]  # fmt: skip
SteadyError = Annotated[
    float | None,
    typer.Option(
        metavar="X", rich_help_panel=STEEPNESS, help="Find k_v for this relative error of the steady force at --speed."
    ),
]
Speed = Annotated[
    float | None,
    typer.Option(
        metavar="M/S", rich_help_panel=STEEPNESS, help="Speed at which --steady-error is evaluated (m/s)."
    ),
]  # fmt: skip
PreslidingError = Annotated[
    float | None,
    typer.Option(
        metavar="X", rich_help_panel=STEEPNESS,
        help="Find k_v for this error of the presliding position, relative to its peak.",
    ),
]  # fmt: skip
ForceRate = Annotated[
    float | None,
    typer.Option(metavar="N/S", rich_help_panel=STEEPNESS, help="Rate of the force of --presliding-error (N/s)."),
]
PositionError = Annotated[
    float | None,
    typer.Option(
        metavar="M", rich_help_panel=STEEPNESS, help="Find k_v for this error of the position in --scenario (m)."
    ),
]
OfPosition = Annotated[
    Path | None,
    typer.Option(
        "--scenario", metavar="FILE", rich_help_panel=STEEPNESS,
        help="Scenario of --position-error; its constants are used unless --parameters is given.",
    ),
]  # fmt: skip
SampleTime = Annotated[
    float | None,
    typer.Option(
        metavar="S", rich_help_panel=STEEPNESS, help="Find k_v with which explicit Euler is stable at this step (s)."
    ),
]
Mass = Annotated[
    float | None,
    typer.Option(metavar="KG", rich_help_panel=STEEPNESS, help="Mass of the body for --presliding-error (kg)."),
]


@app.command(epilog="Example: stribeck check lugre_sobczyk --parameters canudas1995 --set k_v=1e7")
def check(
    what: Annotated[
        str,
        typer.Argument(metavar="LAW|FILE.toml", help="Law, FILE.py:NAME, or a machine file, whose contacts are all checked."),
    ],
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="NAME or FILE", help="Built-in parameter set or TOML file.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Set a constant, such as k_v=1e7; may be repeated.")
    ] = None,
    v_max: Annotated[
        float | None, typer.Option("--v-max", metavar="V", help="Check passivity for |v| <= V (m/s); every speed unless given.")
    ] = None,
    level: Annotated[
        str | None,
        typer.Option(metavar="LOW:HIGH", help="Let F_c and F_s vary in any way between LOW and HIGH times their values."),
    ] = None,
    force: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=MAX", help="Bound of a link's force in a machine (N or N m); unbounded unless given."),
    ] = None,
    verify: Annotated[
        bool, typer.Option("--verify", help="Check each proof by an independent program, and replay each counterexample.")
    ] = False,
    certificate: Annotated[
        Path | None, typer.Option(metavar="FILE", parser=place, help="Write the proofs to this JSON file.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", parser=place, help="Folder for the report and for counterexamples as scenarios."),
    ] = None,
    creep: Creep = None,
    share: Share = None,
    steady_error: SteadyError = None,
    speed: Speed = None,
    presliding_error: PreslidingError = None,
    force_rate: ForceRate = None,
    position_error: PositionError = None,
    scenario: OfPosition = None,
    sample_time: SampleTime = None,
    mass: Mass = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:  # fmt: skip
    """Decide five properties of a law or machine: a proof, or a counterexample that 'run' replays."""
    from stribeck.constants import require_positive

    if v_max is not None:
        require_positive("v_max", v_max, "m/s")
    asked = _Asked(v_max, verify, out, certificate, json)
    asked_for = {
        "creep": creep, "share": share, "steady_error": steady_error, "speed": speed,
        "presliding_error": presliding_error, "force_rate": force_rate, "position_error": position_error,
        "scenario": scenario, "sample_time": sample_time, "mass": mass,
    }  # fmt: skip
    tolerated: dict[str, object] = {name: x for name, x in asked_for.items() if x is not None}
    if what.lower().endswith(".toml"):
        of_a_law = [n for n, x in (("--parameters", parameters), ("--level", level)) if x]
        of_a_law += [f"--{name.replace('_', '-')}" for name in tolerated]
        if of_a_law:
            raise InputError([f"{n}: must be left out for a machine: it is about one law" for n in of_a_law])
        return _machine(Path(what), set_ or [], force or [], trust, asked)
    if force:
        raise InputError(
            f"--force: {force[0]!r}: needs a machine's FILE.toml: it bounds a link, a load or a motor there"
        )
    return _law(what, parameters, set_ or [], level, tolerated, trust, asked)


@dataclass(frozen=True)
class _Asked:
    """What is asked of a law and of a machine alike."""

    v_max: float | None
    verify: bool
    out: Path | None
    certificate: Path | None
    json: bool

    def refuse(self, *reads: Path) -> None:
        """Refuse places that cannot be written, before anything runs."""
        from stribeck.cli import show

        if self.out is not None:
            show.check_folder(self.out)
        if self.certificate is not None:
            show.check_file("--certificate", self.certificate, *reads)


def _law(
    name: str, parameters: str | None, assignments: list[str], level: str | None, tolerated: dict[str, object],
    trust: bool, asked: _Asked,
) -> int:  # fmt: skip
    from stribeck import laws
    from stribeck.cli import show
    from stribeck.parameter_sets.assignments import parse_assignments
    from stribeck.properties import check as decide

    bounds = level_of(level)
    given = parse_assignments(assignments)
    if "scenario" in tolerated:
        tolerated["scenario"] = scenario = show.load(Path(str(tolerated["scenario"])), [], trust)
        given = given if parameters else _constants_of(name, scenario) | given
    if parameters is None and _lacks_parameters(name, given):
        parameters = _DEFAULT_SET
        note(f"no parameters given: checked with the set {parameters}")
    open_k_v = bool(tolerated) and "k_v" not in given and "k_v" in laws.find(name).constants()
    law = laws.law(name, parameters, **given, **({"k_v": 1.0} if open_k_v else {}))
    if problem := laws.trouble(law):
        raise InputError(f"{name!r}: {problem}")
    asked.refuse(Path(name.rpartition(":")[0]), Path(parameters or ""))
    with show.progress(f"check {law.name}"):
        if tolerated:
            verdicts = _with_steepness(law, tolerated, bounds, asked.v_max, find_k_v=open_k_v)
        else:
            verdicts = decide(law, asked.v_max, level=bounds)
    if ":" in name:
        _note_what_makes_no_sense(law, verdicts)
    if asked.verify:
        verdicts.verify()
    written = _Written()
    if asked.out is not None:
        with written.whole(asked.out) as folder:
            written.files = _write_scenarios(verdicts, folder)
            with left_out("the page"):
                from stribeck.properties import said as report

                written.pages = report.write_check(verdicts, folder, show.command_line())
    if asked.certificate is not None:
        written.certify(asked.certificate, verdicts.certificates())
    if asked.json:
        show.print_json(verdicts.to_json() | written.to_json())
    else:
        _print(verdicts)
        written.tell()
    return 0


def _note_what_makes_no_sense(law: Law, verdicts: Verdicts) -> None:
    """Equations of a user that are not finite, not odd or not differentiable, and claims that are refuted."""
    from stribeck.laws import sanity

    for line in sanity.problems(law):
        note(f"{law.name}: {line}")
    for name, claimed in law.guarantees().items():
        if claimed and name in verdicts.properties and verdicts[name].holds is False:
            note(f"{law.name}: claims: {name}: True: is refuted")


def _machine(file: Path, assignments: list[str], forces: list[str], trust: bool, asked: _Asked) -> int:
    from stribeck.cli import show
    from stribeck.properties import check as decide

    stated = _forces(forces)
    scenario = show.load(file, assignments, trust)
    asked.refuse(file)
    with show.progress(f"check {scenario.name}"):
        found = decide(scenario, asked.v_max, forces=stated)
    if asked.verify:
        found.verify()
    written = _Written()
    if asked.out is not None:
        with written.whole(asked.out) as folder:
            written.files = [
                path for name, v in found.contacts.items() for path in _write_scenarios(v, folder, f"{name}_")
            ]
            with left_out("the page"):
                from stribeck.properties import said as report

                written.pages = report.write_machine_check(found, scenario, folder, show.command_line())
    if asked.certificate is not None:
        written.certify(asked.certificate, found.certificates())
    if asked.json:
        show.print_json(found.to_json() | {"forces": stated} | written.to_json())
    else:
        _print_machine(found)
        written.tell()
    return 0


@dataclass
class _Written:
    """What a check wrote: scenarios and proofs, and the page with its pictures, last the page; None where not asked for."""

    files: list[str] | None = None
    pages: list[Path] | None = None

    @contextmanager
    def whole(self, out: Path) -> Iterator[Path]:
        """A folder for what is written, which moves into ``out`` together, the page last."""
        from stribeck.files import together

        with together(out, last="report.html", older=_COUNTEREXAMPLES) as folder:
            yield folder
        self.files = [str(out / Path(file).name) for file in self.files or ()]
        self.pages = None if self.pages is None else [out / page.name for page in self.pages]

    def certify(self, file: Path, certificates: object) -> None:
        """Write the proofs as JSON."""
        from stribeck.files import write_text

        write_text(file, dumps(certificates, indent=1) + "\n")
        self.files = [*(self.files or ()), str(file)]

    def to_json(self) -> dict[str, list[str]]:
        """The paths."""
        files = {} if self.files is None else {"files": self.files}
        return files if self.pages is None else {**files, "report": [str(path) for path in self.pages]}

    def tell(self) -> None:
        """Print the paths, of the page's its own."""
        for file in (*(self.files or ()), *(self.pages or ())[-1:]):
            print(f"  wrote {file}")


def level_of(text: str | None) -> tuple[float, float] | None:
    """LOW:HIGH as numbers."""
    if text is None:
        return None
    low, sign, high = text.partition(":")
    try:
        found = float(low), float(high)
    except ValueError:
        found = nan, nan
    if not sign or not 0 < found[0] <= found[1] < inf:
        raise InputError(f"--level: {text!r}: must be LOW:HIGH, two finite numbers with 0 < LOW <= HIGH, such as 1:2")
    return found


def _forces(texts: list[str]) -> dict[str, float]:
    """NAME=MAX as numbers."""
    found: dict[str, float] = {}
    for text in texts:
        name, sign, size = text.partition("=")
        try:
            value = float(size)
        except ValueError:
            value = nan
        if not (name and sign and isfinite(value) and value >= 0):
            raise InputError(f"--force: {text!r}: must be NAME=MAX, a link, load or motor and a finite number >= 0")
        found[name] = value
    return found


def _lacks_parameters(name: str, given: Mapping[str, object]) -> bool:
    """Whether a law needs a machine's parameters and none of them is given."""
    from stribeck import laws
    from stribeck.laws.base import PARAMETERS

    found = laws.find(name)
    return not set(given) & set(PARAMETERS) and any(found.constants()[n].required for n in found.uses)


def _constants_of(name: str, scenario: Scenario) -> dict[str, float | str | None]:
    """The constants of a scenario's law that the law of this name has too."""
    from stribeck import laws
    from stribeck.laws.base import PARAMETERS

    known, law = {*laws.find(name).constants(), *PARAMETERS}, scenario.law
    constants = {**law.machine, **law.p.numbers, **law.p.words}
    return {n: x for n, x in constants.items() if n in known} | {"rotary": law.rotary}


def _with_steepness(
    law: Law, tolerated: Mapping[str, object], level: tuple[float, float] | None, v_max: float | None, *, find_k_v: bool
) -> Verdicts:
    """The verdicts and the smallest k_v; with ``find_k_v`` on the law with that k_v, and none if no k_v will do."""
    from stribeck.properties import Verdicts
    from stribeck.properties import check as decide
    from stribeck.properties.steepness import Tolerated, smallest_steepness

    found = smallest_steepness(law, Tolerated.given({**tolerated, "v_max": v_max}))
    k_v = found[law.name].k_v
    if find_k_v and not k_v:
        verdicts = Verdicts(law, {}, v_max)
    else:
        verdicts = decide(law.replace(k_v=k_v) if find_k_v else law, v_max, level=level)
    verdicts.steepness = found
    return verdicts


def _write_scenarios(verdicts: Verdicts, out: Path, prefix: str = "") -> list[str]:
    """A scenario for each counterexample that one can show."""
    from tomli_w import dumps as toml

    from stribeck.files import write_text

    files = []
    for name, verdict in verdicts.properties.items():
        if verdict.holds is False and verdict.scenario is not None:
            path = out / f"{prefix}{name}.toml"
            head = f"# {verdicts.law.name} is not {name}: {verdict.method}\n{_stated(verdict)}"
            write_text(path, head + toml(verdict.scenario))
            files.append(str(path))
    return files


def _stated(verdict: Verdict) -> str:
    stated = verdict.evidence.get("replay", {})
    return "".join(f"# at the end: {name} = {value!r}\n" for name, value in stated.items())


def _print(verdicts: Verdicts, of: str = "") -> None:
    """A law's constants, its verdicts and their evidence."""
    from stribeck.constants import DECIDED
    from stribeck.mouth.terminal import say

    heading, *more = verdicts.headings()
    say(of + heading, 4)
    for line in more:
        say(line, 4, "  ")
    for each in verdicts.steepness.values():
        _print_steepness(each)
    for name, verdict in verdicts.properties.items():
        again = {True: ", verified", False: ", NOT CONFIRMED", None: ""}[verdict.verified]
        say(f"{verdict.reason}{again}", _BESIDE, f"  {name:11}{DECIDED[verdict.holds]:10}")
        for line in _lines(verdict.evidence):
            say(line, _BESIDE + 2, " " * _BESIDE)


def _print_steepness(found: Steepness) -> None:
    from stribeck.constants import rotary_unit
    from stribeck.mouth.terminal import say

    def unit(linear: str) -> str:
        return rotary_unit(linear) if found.rotary else linear

    speed, steepness = unit("m/s"), unit("s/m")
    say(f"k_v = {_k_v_in_words(found.k_v, steepness)}", 6, f"  {found.law}: ")
    for each in found.requirements:
        tolerance = f"{100 * each.tolerance:.4g} %" if not each.unit else f"{each.tolerance:.4g} {each.unit}"
        say(f"{each.name}, {tolerance}: {_k_v_in_words(each.k_v, steepness)}", 8, "    ")
        say(f"by {each.method}: {each.detail}", 8, "        ")
    if (c := found.cost) is None:
        return
    fast = f"up to {c.v_max:.4g} {speed}: stiffness {c.stiffness:.4g} 1/s"
    say(f"{fast}, explicit steps below {c.largest_step:.4g} s", 6, "    ")
    if c.body_stiffness is not None:
        print(f"    with the body: eigenvalues up to {c.body_stiffness:.4g} 1/s")
    bent = f"dF/dv changes by up to {c.force_bend:.4g} {unit('N s/m')} per {speed} there"
    say(f"|v| is bent within {c.bend:.4g} {speed}; {bent}", 6, "    ")


def _k_v_in_words(k_v: float | None, unit: str) -> str:
    """A required k_v: a number, any, or none."""
    return "none will do" if k_v is None else f"{rounded_up(k_v)} {unit}" if k_v else "any will do"


def rounded_up(x: float) -> str:
    """Four digits, rounded up: a smaller k_v would miss the tolerance."""
    if not x:
        return "0"
    unit = 10.0 ** (floor(log10(x)) - 3)
    return f"{ceil(x / unit * (1 - 1e-12)) * unit:.4g}"  # 1e-12: the rounding of x / unit itself


def _print_machine(found: MachineVerdicts) -> None:
    from stribeck.constants import SHOWN
    from stribeck.mouth.terminal import say

    for name, verdicts in found.contacts.items():
        _print(verdicts, f"{name}: ")
    say(f"passive at its ports: {SHOWN[found.passive]}: {found.why}", 4, f"{found.name}: ")
    for path, what in found.ports.items():
        say(f"{path}: {what}", 13, "  port       ")


def _lines(evidence: Mapping[str, object]) -> list[str]:
    """The evidence in short: numbers and words; of lists their entries."""
    lines = []
    plain = {n: x for n, x in evidence.items() if isinstance(x, int | float | str) and n != "reason"}
    if plain:
        lines.append(", ".join(f"{n} {x:.9g}" if isinstance(x, float) else f"{n} {x}" for n, x in plain.items()))
    for name in ("programme", "levels"):
        rows = evidence.get(name)
        if isinstance(rows, list):
            lines += [", ".join(f"{n} {x:.6g}" for n, x in row.items()) for row in rows]
    return lines
