"""``stribeck parameters``."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.shared import Json, app, place
from stribeck.cli.text import say
from stribeck.errors import InputError

if TYPE_CHECKING:
    from stribeck.parameter_sets import ParameterSet
    from stribeck.parameter_sets.library import MachineSet


@app.command("parameters", epilog="Example: stribeck parameters mx106 --out mx106.toml")
def parameters(
    name: Annotated[str | None, typer.Argument(metavar="NAME", help="One set; all unless given.")] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", parser=place, help="Write the machine, ready for 'stribeck run'."),
    ] = None,
    json: Json = False,
) -> int:
    """The library: parameter sets of laws and whole machines, each with its source."""
    from stribeck.cli import show  # with all of the scenarios: not for --help of each command
    from stribeck.parameter_sets import load
    from stribeck.parameter_sets import parameters as of_laws
    from stribeck.parameter_sets.library import MachineSet, machine_set, machine_sets

    if name is None:
        if out is not None:
            raise InputError("--out: needs the NAME of a machine")
        return _all(list(of_laws().values()), list(machine_sets().values()), json)
    found = load(name) if name in of_laws() else machine_set(name)
    if out is not None:
        if not isinstance(found, MachineSet):
            raise InputError(f"--out: {name!r} is a set of a law's parameters, no machine")
        show.check_file("--out", out)
        _write(found, out)
    if json:
        show.print_json(asdict(found))
    elif isinstance(found, MachineSet):
        _machine(found)
    else:
        say(f"{found.name}: {found.title} ({found.motion})", 4)
        say(", ".join(f"{n} = {x:g}" for n, x in found.values.items()), 4, "    ")
        say(f"source: {found.source}", 4, "    ")
    if out is not None and not json:
        print(f"wrote {out}")
    return 0


def _all(of_laws: list[ParameterSet], machines: list[MachineSet], json: bool) -> int:
    """Every set, a line for each."""
    if json:
        from stribeck.cli.show import print_json

        print_json({"laws": {x.name: asdict(x) for x in of_laws}, "machines": {x.name: x.to_json() for x in machines}})
        return 0
    print("parameters of a law (law.parameters = NAME):")
    for each in of_laws:
        say(f"{each.name}: {each.title}", 6, "  ")
    print("machines ('stribeck parameters NAME --out FILE.toml' writes one):")
    for machine in machines:
        say(f"{machine.name}: {machine.title} ({machine.origin}; {machine.licence})", 6, "  ")
    return 0


def _machine(found: MachineSet) -> None:
    """One machine in words."""
    say(f"{found.name}: {found.title}", 4)
    for path, p in found.parameters.items():
        low, high = p.get("low"), p.get("high")
        interval = f" ({low} ... {high})" if low is not None and high is not None else ""
        say(f"{path} = {p['value']}{interval} {p.get('unit', '')}  {p.get('verdict', '')}".rstrip(), 8, "    ")
    for word in ("holds", "source", "record", "licence", "origin", "date", "command"):
        if text := getattr(found, word):
            say(f"{word}: {text}", 6, "    ")


def _write(found: MachineSet, out: Path) -> None:
    """The machine as a scenario file, with where it is from above."""
    import tomli_w

    from stribeck.files import write_text
    from stribeck.scenario import Scenario

    Scenario(dict(found.machine))  # what is written is valid
    about = "".join(f"# {word}: {getattr(found, word)}\n" for word in ("title", "source", "record", "licence", "date"))
    write_text(out, about + tomli_w.dumps(dict(found.machine)))
