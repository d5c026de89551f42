"""``stribeck fit MACHINE.toml --logs LOGS.toml``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from stribeck.cli import show
from stribeck.cli.text import say
from stribeck.errors import InputError, refuse_twice
from stribeck.identify.actuator import MachineFit, fit_machine
from stribeck.identify.actuator.page import FILES, number_or_open, write_machine_fit
from stribeck.scenario import Scenario, parse_assignments

if TYPE_CHECKING:
    import typer


_OPTIONS = ("law", "set_", "starts", "seed", "logs", "transfer", "on", "out", "json")


def check_options(context: typer.Context) -> None:
    """Refuse options that say something of a log: of recordings LOGS.toml says it.

    Raises:
        InputError: a line for each.
    """
    given = [x for x in context.command.params if x.param_type_name == "option" and x.name not in _OPTIONS]
    wrong = [
        x.opts[0]
        for x in given
        if x.name and (source := context.get_parameter_source(x.name)) and source.name == "COMMANDLINE"
    ]
    if wrong:
        raise InputError(
            [f"{name}: is for a log: with --logs, LOGS.toml says what is measured and sought" for name in wrong]
        )


def fit(
    machine: Sequence[Path], logs: Path | None, laws: Sequence[str], assignments: Sequence[str], transfer: Path | None,
    starts: int, seed: int, out: Path | None, json: bool, on: str | None = None,
) -> int:  # fmt: skip
    """Read, fit, print, write."""
    if logs is None:
        raise InputError(f"--transfer: {str(transfer)!r}: needs --logs")
    if len(machine) != 1:
        raise InputError(f"DATA: {len(machine)} files: with --logs there must be one, the machine's")
    if out is not None:
        show.check_folder(out, [machine[0], logs], FILES)
    scenario = Scenario.load(machine[0], parse_assignments(assignments))
    with show.lanes_on(on), show.progress("fit") as tell:
        found = fit_machine(
            scenario, logs, laws=_laws(laws), transfer_to=transfer, starts=starts, seed=seed, progress=tell, folder=out
        )
    summary, files = found.to_json(), list[str]()
    try:
        if out is not None:
            files = write_machine_fit(
                found, out, show.command_line(), f"{scenario.name} fitted to {logs.name}", scenario.folder, logs
            )
    except KeyboardInterrupt:  # while the page is drawn: what was found is said
        _tell(found, summary, files, json)
        raise
    _tell(found, summary, files, json)
    return {"done": 0, "stopped": 130}.get(found.status, 1)


def _tell(fit: MachineFit, summary: Mapping[str, object], files: list[str], json: bool) -> None:
    if json:
        show.print_json({**summary, "files": files})
    else:
        _print(fit, files)


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
    width = max(map(len, fit.parameters), default=4)
    print(f"  {'':{width}}  {'value':>12}  {'95 % interval':>27}  {'unit':<10}  verdict")
    for name, p in fit.parameters.items():
        interval = "-" if p.verdict == "not judged" else f"{number_or_open(p.low)} ... {number_or_open(p.high)}"
        print(f"  {name:{width}}  {number_or_open(p.value):>12}  {interval:>27}  {p.unit:<10}  {p.verdict}")
    for name, p in fit.parameters.items():
        if p.why and p.verdict != "not judged":
            say(f"{name}: {p.verdict}: {p.why}", 6, "  ")
        if p.experiment:
            say(f"to tell it: {p.experiment}", 6, "      ")
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
        say(f"law picked: {fit.laws['picked']}", 6, "  ")
    if fit.transfer is not None:
        moved = ", ".join(m["name"] for m in fit.transfer["moved"]) or "nothing"
        say(f"other recordings: beyond both intervals moved {moved}", 6, "  ")
    for text in fit.notes:
        say(text, 6, "  note: ")
    for file in files:
        print(f"  wrote {file}")
