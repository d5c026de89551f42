"""``stribeck fit MACHINE.toml --logs LOGS.toml``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from stribeck.cli.fit import print_estimates
from stribeck.cli.options import given_options
from stribeck.cli.output import OutputFolder, command_line, print_json
from stribeck.cli.progress import progress
from stribeck.errors import InputError, refuse_twice
from stribeck.identify.actuator import MachineFit, fit_machine
from stribeck.identify.actuator.page import FILES, number_or_open, write_machine_fit
from stribeck.identify.actuator.result import Transfer
from stribeck.mouth.terminal import say
from stribeck.scenario import Scenario, parse_assignment, parse_assignments

if TYPE_CHECKING:
    import typer


_OPTIONS = ("law", "set_", "unknown", "starts", "seed", "logs", "transfer", "on", "out", "json")


def check_options(context: typer.Context) -> None:
    """Refuse options that say something of a log: of recordings LOGS.toml says it.

    Raises:
        InputError: a line for each.
    """
    wrong = [words for name, words in given_options(context).items() if name not in _OPTIONS]
    if wrong:
        raise InputError(
            [f"{name}: is for a log: with --logs, LOGS.toml says what is measured and sought" for name in wrong]
        )


@dataclass(frozen=True)
class RecordingsOptions:
    """A machine, its recordings, and what is sought, as the command line has them."""

    machine: Sequence[Path]
    logs: Path | None
    laws: Sequence[str]
    assignments: Sequence[str]
    unknown: Sequence[str]
    transfer: Path | None


def fit(asked: RecordingsOptions, *, starts: int, seed: int, out: Path | None, json: bool) -> int:
    """Read, fit, print, write."""
    machine, logs = asked.machine, asked.logs
    if logs is None:
        raise InputError(f"--transfer: {str(asked.transfer)!r}: needs --logs")
    if len(machine) != 1:
        raise InputError(f"DATA: {len(machine)} files: with --logs there must be one, the machine's")
    with OutputFolder(out, [machine[0], logs], FILES):
        scenario = Scenario.load(machine[0], parse_assignments(asked.assignments))
        with progress("fit") as share:
            found = fit_machine(
                scenario, logs, laws=_laws(asked.laws), unknown=sought(asked.unknown), transfer_to=asked.transfer,
                starts=starts, seed=seed, progress=share, folder=out,
            )  # fmt: skip
        summary, files = found.to_json(), list[str]()
        title = f"{scenario.name} fitted to {logs.name}"
        try:
            if out is not None:
                files = write_machine_fit(found, out, command_line(), title, scenario.folder, logs)
        finally:  # while the page is drawn, too: what was found is said
            _tell(found, summary, files, json)
    return {"done": 0, "stopped": 130}.get(found.status, 1)


def _tell(fit: MachineFit, summary: Mapping[str, object], files: list[str], json: bool) -> None:
    if json:
        print_json({**summary, "files": files})
    else:
        _print(fit, files)


def sought(texts: Sequence[str]) -> dict[str, object]:
    """``PATH=LOW:HIGH``, or ``PATH=TABLE`` as in LOGS.toml, as a mapping."""
    found: list[tuple[str, object]] = []
    for text in texts:
        path, _, given = text.partition("=")
        ends = given.split(":")
        try:
            pair = [float(x) for x in ends]
        except ValueError:
            pair = []
        table: object = parse_assignment(text)[1] if "{" in given else pair
        if not path.strip() or not (isinstance(table, dict) or len(pair) == 2):
            raise InputError(f"--unknown: {text!r}: must be PATH=LOW:HIGH, or PATH={{ low = X, high = X, start = X }}")
        found.append((path.strip(), table))
    refuse_twice([path for path, _ in found], "--unknown")
    return dict(found)


def _laws(texts: Sequence[str]) -> dict[str, list[str]]:
    """``CONTACT=NAME,NAME`` as a mapping."""
    found = []
    for text in texts:
        contact, equals, names = text.partition("=")
        if not equals or not contact or not names:
            raise InputError(f"--law: {text!r}: must be CONTACT=NAME,NAME with --logs")
        found.append((contact.strip(), [name.strip() for name in names.split(",")]))
    refuse_twice([contact for contact, _ in found], "--law")
    return dict(found)


def _print(fit: MachineFit, files: Sequence[str]) -> None:
    print(f"{fit.status}{': ' + fit.reason if fit.reason else ''}")
    print_estimates({**fit.parameters, **fit.levels})
    for name, p in fit.parameters.items():
        if p.why and fit.status != "stopped":
            say(f"{name}: {p.state}: {p.why}", 6, "  ")
        if p.experiment:
            say(f"to find it: {p.experiment}", 6, "      ")
    for group in fit.correlated:
        say(f"go together: {', '.join(group['names'])}", 6, "  ")
    for log in fit.logs:
        for x in log.traces:
            used = " (held out)" if log.held_out else ""
            print(f"  {log.file}{used}: {x.column} error {x.rms:.4g} {x.unit}, {100 * x.relative:.3g} % of its changes")
    for name, b in fit.baselines.items():
        shares = (("fitted", b.get("fitted")), ("held out", b.get("held_out")))
        said = b.get("why") or ", ".join(f"{word} {100 * x:.3g} %" for word, x in shares if x is not None)
        print(f"  {name}: {said}")
    if fit.laws:
        for label, error in fit.laws["errors"].items():
            print(f"  {label}: held out {100 * error:.3g} %, {fit.laws['numbers'][label]} numbers")
        for label, why in fit.laws["failed"].items():
            say(f"{label}: not fitted: {why}", 6, "  ")
        say(f"law picked: {fit.laws['picked']}", 6, "  ")
    if fit.transfer is not None:
        _print_transfer(fit.transfer)
    for text in fit.notes:
        say(text, 6, "  note: ")
    for file in files:
        print(f"  wrote {file}")


def _print_transfer(found: Transfer) -> None:
    """How well the other recordings were predicted, and which numbers are other there."""
    for log in found["logs"]:
        errors = log["errors"]
        assert isinstance(errors, dict)
        for column, x in errors.items():
            print(f"  {log['file']} (other): {column} predicted to {100 * x['relative']:.3g} % of its changes")
    moved = ", ".join(m["name"] for m in found["moved"]) or "nothing"
    say(f"other recordings: beyond both intervals moved {moved}", 6, "  ")
    for m in found["moved"]:
        (a, b), (c, d) = ([number_or_open(x[end]) for end in ("low", "high")] for x in (m["from"], m["to"]))
        say(f"{m['name']}: {a} ... {b}, there {c} ... {d}", 6, "      ")
    if found["not_told"]:
        say(f"not told of {', '.join(found['not_told'])}", 6, "      ")
