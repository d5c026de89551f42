"""``stribeck check``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from json import dumps
from math import inf, nan
from pathlib import Path
from typing import TYPE_CHECKING

from stribeck import laws
from stribeck.cli import show
from stribeck.cli.text import say, width
from stribeck.constants import DECIDED, require_positive
from stribeck.constants import show as shown
from stribeck.errors import InputError, left_out, note
from stribeck.laws.base import PARAMETERS, Law
from stribeck.properties import NAMES, Verdict, Verdicts
from stribeck.properties import check as decide
from stribeck.properties.plain import Json
from stribeck.properties.verdicts import ranges_in_words
from stribeck.scenario import parse_assignments

if TYPE_CHECKING:
    from stribeck.properties.margins import Margins

_DEFAULT_SET = "canudas1995"
# What an older check leaves: scenarios as write_scenarios begins them, and pictures of them, which say by name what they are.
_COUNTEREXAMPLES = {
    "*.toml": r"# \S+ is not \w+: ", **{f"*not_{name}.{kind}": "" for name in NAMES for kind in ("svg", "png", "pdf")},
}  # fmt: skip
_BESIDE = 23  # columns, where the words of a verdict begin


def check(
    name: str | None, parameters: str | None, assignments: list[str], v_max: float | None, json: bool,
    every: bool = False, margins: bool = False, verify: bool = False, out: Path | None = None,
    certificate: Path | None = None, level: str | None = None,
) -> int:  # fmt: skip
    """Check the law named, or every law, and print the verdicts; 0 whatever they are."""
    bounds = level_of(level)
    if bounds is not None and (every or margins):
        raise InputError("--level: must stand without --all and --margins, which are for constants that do not vary")
    if every == (name is not None):
        raise InputError("LAW: must be given, or --all for every law, and not both")
    if every and (margins or out is not None or certificate is not None):
        raise InputError("--all: must stand without --margins, --out and --certificate, which are for one law")
    refuse_v_max(v_max)
    given = parse_assignments(assignments)
    if parameters is None and not set(given) & set(PARAMETERS) and (every or _needs_parameters(name)):
        parameters = _DEFAULT_SET
        note(f"no parameters given: checked with the set {parameters}")
    if every:
        return _all(parameters, given, v_max, json, verify)
    assert name is not None
    law = laws.law(name, parameters, **given)
    if problem := laws.trouble(law):
        raise InputError(f"{name!r}: {problem}")
    if out is not None:
        show.check_folder(out)
    if certificate is not None:
        show.check_file("--certificate", certificate, Path(name.rpartition(":")[0]), Path(parameters or ""))
    verdicts = decide(law, v_max, level=bounds)
    if verify:
        verdicts.verify()
    data = verdicts.to_json()
    found = _margins(verdicts) if margins and law.has_z else None
    if found is not None:
        data["margins"] = asdict(found)
    written = FilesWritten()
    if out is not None:
        with written.whole(out) as place:
            written.files = write_scenarios(verdicts, place)
            with left_out("the page"):
                from stribeck.report import check as report

                written.pages = report.write_check(verdicts, place, found, show.command_line())
    if certificate is not None:
        written.certify(certificate, verdicts.certificates())
    if json:
        show.print_json(data | written.to_json())
    else:
        _print(verdicts, found)
        written.tell()
    return 0


@dataclass
class FilesWritten:
    """What a check wrote: scenarios and proofs, and the page with its pictures, last the page; None where not asked for."""

    files: list[str] | None = None
    pages: list[Path] | None = None

    @contextmanager
    def whole(self, out: Path) -> Iterator[Path]:
        """A folder for what is written, which moves into ``out`` together, the page last."""
        from stribeck.files import together

        with together(out, last="report.html", older=_COUNTEREXAMPLES) as place:
            yield place
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


def refuse_v_max(v_max: float | None) -> None:
    """Raise unless it is a speed or none."""
    if v_max is not None:
        require_positive("v_max", v_max, "m/s")


def refuse_force(force: list[str]) -> None:
    """--force is about a machine's links."""
    raise InputError(
        f"--force: {shown(force[0])}: needs --scenario: it bounds the force of a link, a load or a motor there"
    )


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


def _needs_parameters(name: str | None) -> bool:
    found = laws.find(name) if name is not None else None
    return found is not None and any(found.constants()[n].required for n in found.uses)


def _all(
    parameters: str | None, given: Mapping[str, float | str], v_max: float | None, json: bool, verify: bool
) -> int:
    from stribeck.properties.matrix import every_law

    sets = (laws.parameters_for(cls, parameters) for cls in laws.builtin().values()) if parameters else ()
    values = {n: x for each in sets for n, x in each.items()}
    known = {n for cls in laws.builtin().values() for n in cls.constants()}
    if unknown := [n for n in given if n not in known]:
        raise InputError([f"--set: {n}: no law has such a constant" for n in unknown])
    found = every_law({**values, **given})
    if not found:
        raise InputError("--all: no law has all that it needs; give --parameters, or all of sigma_0 ... v_s with --set")
    checked: list[Verdicts] = []
    with show.progress("checking every law") as tell:
        for i, law in enumerate(found):
            checked.append(decide(law, v_max))
            if verify:
                checked[-1].verify()
            if tell is not None:
                tell((i + 1) / len(found))
    if json:
        show.print_json({"parameters": parameters, "v_max": v_max, "laws": [v.to_json() for v in checked]})
    else:
        _print_matrix(checked, parameters)
        if verify:
            odd = [f"{v.law.name}: {n}" for v in checked for n, p in v.properties.items() if p.verified is False]
            fine = "all proofs confirmed by the independent checker, all counterexamples replayed"
            print(f"NOT CONFIRMED: {', '.join(odd)}" if odd else fine)
    return 0


def _margins(verdicts: Verdicts) -> Margins:
    from stribeck.properties.margins import margins

    return margins(verdicts.law, verdicts.v_max, verdicts["bounded"].holds is not False)


def write_scenarios(verdicts: Verdicts, out: Path, prefix: str = "") -> list[str]:
    """A scenario for each counterexample that one can show."""
    from tomli_w import dumps as toml

    from stribeck.files import write_text

    files = []
    for name, verdict in verdicts.properties.items():
        if verdict.holds is False and verdict.scenario is not None:
            path = out / f"{prefix}{name}.toml"
            write_text(
                path,
                f"# {verdicts.law.name} is not {name}: {verdict.method}\n{_stated(verdict)}{toml(verdict.scenario)}",
            )
            files.append(str(path))
    return files


def _stated(verdict: Verdict) -> str:
    stated = verdict.evidence.get("replay", {})
    return "".join(f"# at the end: {name} = {value!r}\n" for name, value in stated.items())


def _constants(law: Law) -> str:
    values = {n: f"{x:g}" for n, x in law.p.numbers.items()} | law.choices
    return ", ".join(f"{n} = {x}" for n, x in values.items())


def print_verdicts(verdicts: Verdicts, of: str = "") -> None:
    """A law's constants, its verdicts and their evidence."""
    say(f"{of}{verdicts.law.name} with {_constants(verdicts.law)}", 4)
    if verdicts.level:
        say(f"for every history of {ranges_in_words(verdicts.level)}", 4, "  ")
    for name, verdict in verdicts.properties.items():
        again = {True: ", verified", False: ", NOT CONFIRMED", None: ""}[verdict.verified]
        reason = verdict.evidence.get("reason") if verdict.holds is None else verdict.method
        say(f"{reason}{again}", _BESIDE, f"  {name:11}{DECIDED[verdict.holds]:10}")
        for line in _lines(verdict.evidence):
            say(line, _BESIDE + 2, " " * _BESIDE)


def _print(verdicts: Verdicts, margins: Margins | None) -> None:
    print_verdicts(verdicts)
    if margins is None:
        return
    for name, margin in margins.constants.items():
        ends = [f"{word} {x:.9g}" for word, x in (("from", margin.low), ("up to", margin.high)) if x is not None]
        word = "passive" if margins.passive else "not passive"
        say(f"{name} = {margin.value:g}: {word} {' '.join(ends) or 'whatever it is'}", 15, "  margin     ")
    if margins.largest_v_d:
        print(f"  remedy     passive with v_d up to {margins.largest_v_d:.6g} m/s (as sampled)")


def _lines(evidence: Mapping[str, Json]) -> list[str]:
    """The evidence in short: numbers and words; of lists their entries, of long ones their length."""
    lines = []
    plain = {n: x for n, x in evidence.items() if isinstance(x, int | float | str) and n != "reason"}
    if plain:
        lines.append(", ".join(f"{n} {x:.9g}" if isinstance(x, float) else f"{n} {x}" for n, x in plain.items()))
    for name in ("programme", "levels"):
        rows = evidence.get(name, ())
        lines += [", ".join(f"{n} {x:.6g}" for n, x in row.items()) for row in rows]
    return lines


def _print_matrix(checked: list[Verdicts], parameters: str | None) -> None:
    say(f"parameters {parameters or 'as given'}; own constants: " + _own(checked), 4)
    wide = max(len(v.law.name) for v in checked)
    cell = min(12, (width() - 2 - wide) // len(NAMES))
    print(f"{'':{wide}}  " + "".join(f"{name:{cell}}" for name in NAMES))
    for v in checked:
        print(f"{v.law.name:{wide}}  " + "".join(f"{DECIDED[v[name].holds]:{cell}}" for name in NAMES))


def _own(checked: list[Verdicts]) -> str:
    own = {n: x for v in checked for n, x in v.law.p.numbers.items() if n in v.law.own_constants()}
    return ", ".join(f"{n} = {x:g}" for n, x in own.items())
