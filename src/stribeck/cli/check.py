"""``stribeck check``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from json import dumps
from math import inf, isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.shared import Json, Trust, Undetermined, app, place
from stribeck.errors import InputError, left_out, note

if TYPE_CHECKING:
    from stribeck.properties import Verdict, Verdicts
    from stribeck.properties.ports import MachineVerdicts

_DEFAULT_SET = "canudas1995"
# What an older check leaves: scenarios as _write_scenarios begins them, and pictures of them, which say by name what they are.
_COUNTEREXAMPLES = {"*.toml": r"# \S+ is not \w+: "} | {f"*not_*.{kind}": "" for kind in ("svg", "png", "pdf")}
_BESIDE = 23  # columns, where the words of a verdict begin


@app.command(epilog="Example: stribeck check lugre_sobczyk --parameters canudas1995 --set k_v=1e7")
def check(
    what: Annotated[
        str,
        typer.Argument(metavar="LAW|FILE.toml", help="A law (FILE.py:NAME too), or a machine: each of its contacts."),
    ],
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="NAME or FILE", help="The machine's parameters.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Another constant, such as k_v=1e7.")
    ] = None,
    v_max: Annotated[
        float | None, typer.Option("--v-max", metavar="V", help="Passivity is asked for |v| <= V, m/s.")
    ] = None,
    level: Annotated[
        str | None,
        typer.Option(metavar="LOW:HIGH", help="F_c and F_s vary in any way between LOW and HIGH times theirs."),
    ] = None,
    force: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=MAX", help="Of a machine: the force of this link stays within +-MAX."),
    ] = None,
    verify: Annotated[
        bool, typer.Option("--verify", help="Check each proof by other code, and replay each counterexample.")
    ] = False,
    certificate: Annotated[
        Path | None, typer.Option(metavar="FILE", parser=place, help="Write the proofs here, for others to check.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", parser=place, help="Folder for a page, and for counterexamples as scenarios to run."),
    ] = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:  # fmt: skip
    """Does this law with these parameters have each property? A proof, or a counterexample that 'run' replays."""
    from stribeck.constants import require_positive

    if v_max is not None:
        require_positive("v_max", v_max, "m/s")
    asked = _Asked(v_max, verify, out, certificate, json)
    if what.lower().endswith(".toml"):
        if problems := [f"{n}: must be left out for a machine, whose file says it"
                        for n, x in (("--parameters", parameters), ("--level", level)) if x]:  # fmt: skip
            raise InputError(problems)
        return _machine(Path(what), set_ or [], force or [], trust, asked)
    if force:
        raise InputError(
            f"--force: {force[0]!r}: needs a machine's FILE.toml: it bounds a link, a load or a motor there"
        )
    return _law(what, parameters, set_ or [], level, asked)


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


def _law(name: str, parameters: str | None, assignments: list[str], level: str | None, asked: _Asked) -> int:
    from stribeck import laws
    from stribeck.cli import show
    from stribeck.laws.base import PARAMETERS
    from stribeck.properties import check as decide
    from stribeck.scenario import parse_assignments

    bounds = level_of(level)
    given = parse_assignments(assignments)
    if parameters is None and not set(given) & set(PARAMETERS) and _needs_parameters(name):
        parameters = _DEFAULT_SET
        note(f"no parameters given: checked with the set {parameters}")
    law = laws.law(name, parameters, **given)
    if problem := laws.trouble(law):
        raise InputError(f"{name!r}: {problem}")
    asked.refuse(Path(name.rpartition(":")[0]), Path(parameters or ""))
    verdicts = decide(law, asked.v_max, level=bounds)
    if asked.verify:
        verdicts.verify()
    written = _Written()
    if asked.out is not None:
        with written.whole(asked.out) as folder:
            written.files = _write_scenarios(verdicts, folder)
            with left_out("the page"):
                from stribeck.report import check as report

                written.pages = report.write_check(verdicts, folder, show.command_line())
    if asked.certificate is not None:
        written.certify(asked.certificate, verdicts.certificates())
    if asked.json:
        show.print_json(verdicts.to_json() | written.to_json())
    else:
        _print(verdicts)
        written.tell()
    return 0


def _machine(file: Path, assignments: list[str], forces: list[str], trust: bool, asked: _Asked) -> int:
    from stribeck.cli import show
    from stribeck.properties import check as decide

    stated = _forces(forces)
    scenario = show.load(file, assignments, trust)
    asked.refuse(file)
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
                from stribeck.report import check as report

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


def _needs_parameters(name: str) -> bool:
    from stribeck import laws

    found = laws.find(name)
    return any(found.constants()[n].required for n in found.uses)


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
    from stribeck.cli.text import say
    from stribeck.constants import DECIDED

    heading, *more = verdicts.headings()
    say(of + heading, 4)
    for line in more:
        say(line, 4, "  ")
    for name, verdict in verdicts.properties.items():
        again = {True: ", verified", False: ", NOT CONFIRMED", None: ""}[verdict.verified]
        say(f"{verdict.reason}{again}", _BESIDE, f"  {name:11}{DECIDED[verdict.holds]:10}")
        for line in _lines(verdict.evidence):
            say(line, _BESIDE + 2, " " * _BESIDE)


def _print_machine(found: MachineVerdicts) -> None:
    from stribeck.cli.text import say
    from stribeck.constants import SHOWN

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
