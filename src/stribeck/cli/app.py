"""The commands and their options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import stribeck

app = typer.Typer(
    help="Friction models that you can simulate, prove, fit and ship.",
    no_args_is_help=True,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

ScenarioFile = Annotated[
    Path, typer.Argument(metavar="SCENARIO.toml", help="Scenario file; 'stribeck new' writes one.")
]
Out = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Folder for the files; made if need be.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="PATH=VALUE", help="Replace a value, such as law.k_v=1e6; may be repeated."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output, and nothing else there.")]


def _version(wanted: bool) -> None:
    if wanted:
        print(f"stribeck {stribeck.__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


@app.command()
def run(
    scenario: ScenarioFile,
    out: Out = None,
    set_: Set = None,
    json: Json = False,
    keep_c: Annotated[
        Path | None, typer.Option("--keep-c", metavar="FILE", help="Write the generated C here, to read or debug.")
    ] = None,
) -> int:
    """Simulate one scenario; without --out, print the summary and write nothing."""
    from stribeck.cli import run as command

    return command.run(scenario, out, set_ or [], json, keep_c)


@app.command()
def compare(
    scenario: ScenarioFile,
    law: Annotated[
        list[str],
        typer.Option("--law", metavar="NAME[:KEY=VALUE,...]", help="A law to compare; the first is the reference."),
    ],
    out: Out = None,
    set_: Set = None,
    json: Json = False,
) -> int:
    """Simulate one scenario under several laws and show where they deviate."""
    from stribeck.cli import compare as command

    return command.compare(scenario, law, out, set_ or [], json)


@app.command()
def laws(
    law: Annotated[
        list[str] | None, typer.Argument(metavar="[LAW]...", help="Only these; FILE.py:NAME is one too.")
    ] = None,
    json: Json = False,
    test: Annotated[bool, typer.Option("--test", help="Test numerically all that the laws claim.")] = False,
    sets: Annotated[
        bool, typer.Option("--sets", help="List the parameter sets, and the laws that are passive with each.")
    ] = False,
) -> int:
    """List the laws: equation, constants, units, source, what each guarantees."""
    from stribeck.cli import laws as command

    return command.laws(law or [], json, test, sets)


@app.command()
def advise(
    law: Annotated[str, typer.Argument(metavar="LAW", help="A bristle law with k_v.")],
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="NAME or FILE", help="The machine's parameters.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Another constant, such as z_ba=7e-6.")
    ] = None,
    creep: Annotated[float | None, typer.Option(help="Tolerated creep in m/s under a held load.")] = None,
    share: Annotated[float, typer.Option(help="That load, and presliding's, as a share of F_s.")] = 0.95,
    steady_error: Annotated[float | None, typer.Option(help="Tolerated relative error of friction at --speed.")] = None,
    speed: Annotated[float | None, typer.Option(help="That speed, m/s.")] = None,
    presliding_error: Annotated[
        float | None, typer.Option(help="Tolerated error of the presliding position, relative to its peak.")
    ] = None,
    force_rate: Annotated[float | None, typer.Option(help="The force's rate in presliding, N/s.")] = None,
    position_error: Annotated[
        float | None, typer.Option(help="Tolerated error of the position in --scenario, m.")
    ] = None,
    scenario: Annotated[Path | None, typer.Option(metavar="SCENARIO.toml", help="That scenario.")] = None,
    sample_time: Annotated[
        float | None, typer.Option(help="Step of the target, s: explicit Euler is to be stable with it.")
    ] = None,
    v_max: Annotated[float | None, typer.Option(help="Largest speed that matters, m/s; 100 v_s unless given.")] = None,
    mass: Annotated[float | None, typer.Option(help="Mass of the body, kg.")] = None,
    out: Out = None,
    json: Json = False,
) -> int:
    """Which k_v? The smallest that meets what you tolerate, what it costs, and the same for the majorant law."""
    from stribeck.cli import advise as command

    tolerated = {
        "creep": creep, "share": share, "steady_error": steady_error, "speed": speed, "presliding_error": presliding_error,
        "force_rate": force_rate, "position_error": position_error, "scenario": scenario, "sample_time": sample_time,
        "v_max": v_max, "mass": mass,
    }  # fmt: skip
    return command.advise(law, parameters, set_ or [], tolerated, out, json)


@app.command()
def check(
    law: Annotated[str | None, typer.Argument(metavar="[LAW]", help="A law; FILE.py:NAME is one too.")] = None,
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="NAME or FILE", help="The machine's parameters.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Another constant, such as k_v=1e7.")
    ] = None,
    v_max: Annotated[
        float | None, typer.Option("--v-max", metavar="V", help="Passivity is asked for |v| <= V, m/s.")
    ] = None,
    every: Annotated[bool, typer.Option("--all", help="Every law with the parameters.")] = False,
    margins: Annotated[
        bool, typer.Option("--margins", help="How far each constant can move before passivity changes.")
    ] = False,
    verify: Annotated[
        bool, typer.Option("--verify", help="Run each proof and replay each counterexample again.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Write counterexamples here, as scenarios to run.")
    ] = None,
    json: Json = False,
) -> int:
    """Does this law with these parameters have each property? A proof, or a counterexample that 'run' replays."""
    from stribeck.cli import check as command

    return command.check(law, parameters, set_ or [], v_max, json, every, margins, verify, out)


@app.command()
def new(
    name: Annotated[
        str, typer.Argument(metavar="[NAME]", help="A name for it, or that of a built-in example.")
    ] = "my_rig",
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Where to; NAME.toml unless given.")] = None,
    examples: Annotated[bool, typer.Option("--list", help="List the built-in examples.")] = False,
) -> int:
    """Write a commented scenario file to start from."""
    from stribeck.cli import new as command

    return command.new(name, out, examples)


@app.command()
def paper(
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for the report.")] = Path("stribeck-report"),
    json: Json = False,
) -> int:
    """Simulate the phenomena of the paper and leave one page with the plots."""
    from stribeck.cli import paper as command

    return command.paper(out, json)


@app.command()
def doctor(json: Json = False) -> int:
    """Show compiler, cache and versions, and run a self-test."""
    from stribeck.cli import doctor as command

    return command.doctor(json)
