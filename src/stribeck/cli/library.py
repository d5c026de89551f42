"""``stribeck library``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stribeck.cli.shared import Json, app, place
from stribeck.errors import InputError
from stribeck.mouth.terminal import say

if TYPE_CHECKING:
    from stribeck.laws.library import Library
    from stribeck.parameter_sets import ParameterSet
    from stribeck.parameter_sets.library import MachineSet


@app.command(epilog="Example: stribeck library mx106 --out mx106.toml")
def library(
    name: Annotated[
        list[str] | None,
        typer.Argument(metavar="[NAME]...", help="Law, FILE.py:NAME, parameter set or machine."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE.toml", parser=place, help="Write the named machine as a scenario file."),
    ] = None,
    json: Json = False,
) -> int:
    """List friction laws, parameter sets and machines with their sources; a NAME shows its details."""
    from stribeck.cli import show
    from stribeck.laws import library as shelf

    found = shelf.library(*(name or ()))
    if out is not None:
        _write(found, name or [], out)
    if json:
        show.print_json(found.to_dict())
        return 0
    if not name:
        _print_list(found)
    else:
        for each, law in found.laws.items():
            _print_law(shelf.described(law, each))
        for parameter_set in found.sets.values():
            _print_set(parameter_set)
        for machine in found.machines.values():
            _print_machine(machine)
    if out is not None:
        print(f"wrote {out}")
    return 0


def _write(found: Library, names: list[str], out: Path) -> None:
    """Write the machine as a scenario file, with its source above.

    Raises:
        InputError: not exactly one machine is named, or the file cannot be written.
    """
    import tomli_w

    from stribeck.cli import show
    from stribeck.files import write_text
    from stribeck.scenario import Scenario

    if len(names) != 1 or len(found.machines) != 1:
        raise InputError(f"--out: needs the NAME of one machine, not {', '.join(names) or 'none'}")
    show.check_file("--out", out)
    (machine,) = found.machines.values()
    Scenario(dict(machine.machine))  # a file that is written can be run
    words = ("title", "source", "record", "licence", "date")
    about = "".join(f"# {word}: {getattr(machine, word)}\n" for word in words)
    write_text(out, about + tomli_w.dumps(dict(machine.machine)))


def _print_list(found: Library) -> None:
    print("laws ('stribeck library NAME' shows equations, constants and claims):")
    for name, law in found.laws.items():
        say(f"{name}: {' '.join((law.__doc__ or '').split())}", 6, "  ")
    print('parameter sets of a law (parameters = "NAME"):')
    for each in found.sets.values():
        say(f"{each.name}: {each.title}", 6, "  ")
    print("machines ('stribeck library NAME --out FILE.toml' writes one):")
    for machine in found.machines.values():
        say(f"{machine.name}: {machine.title} ({machine.origin}; {machine.licence})", 6, "  ")


def _print_set(found: ParameterSet) -> None:
    say(f"{found.name}: {found.title} ({found.motion})", 4)
    say(", ".join(f"{n} = {x:g}" for n, x in found.values.items()), 4, "    ")
    say(f"source: {found.source}", 4, "    ")


def _print_machine(found: MachineSet) -> None:
    say(f"{found.name}: {found.title}", 4)
    for path, p in found.parameters.items():
        low, high = p.get("low"), p.get("high")
        interval = f" ({low} ... {high})" if low is not None and high is not None else ""
        say(
            f"{path} = {p['value']}{interval} {p.get('unit', '')}  {p.get('state', p.get('verdict', ''))}".rstrip(),
            8,
            "    ",
        )
    for word in ("holds", "source", "record", "licence", "origin", "date", "command"):
        if text := getattr(found, word):
            say(f"{word}: {text}", 6, "    ")


def _print_law(law: dict[str, Any]) -> None:
    say(f"{law['name']}: {law['summary']}", 4)
    for equation in law["equations"]:
        say(equation["text"], 8, "    ")
    claims = _claims(law["guarantees"])
    none = "none stated" if law["has_z"] else "no internal state, so none of the five properties"
    say(claims or none, 13, "  claims     ")
    for form, changed in law["with"].items():
        parts = [*(e["text"] for e in changed["equations"]), _claims(changed["guarantees"])]
        say("; ".join(part for part in parts if part), 13, f"  with {form}: ")
    own = [f"{n} ({_unit_or_words(p)}, {p['meaning']})" for n, p in law["parameters"].items() if p["where"] == "law"]
    if own:
        say("; ".join(own), 13, "  constants  ")
    used = [n for n, p in law["parameters"].items() if p["where"] != "law"]
    say(", ".join(used) or "none", 13, "  parameters ")
    say(law["source"], 13, "  source     ")
    print()


def _claims(guarantees: dict[str, object]) -> str:
    from stribeck.constants import DECIDED

    words = []
    for name, claim in guarantees.items():
        if claim is not None:
            text = f"if {claim['if']['text']}" if isinstance(claim, dict) else DECIDED[bool(claim)]
            words.append(f"{name.replace('_', '-')}: {text}")
    return "; ".join(words)


def _unit_or_words(parameter: dict[str, Any]) -> str:
    return str(parameter["allowed"] if parameter["allowed"].startswith("one of") else parameter["unit"])
