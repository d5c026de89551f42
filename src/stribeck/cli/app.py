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
) -> int:
    """List the laws: equation, constants, units, source, what each guarantees."""
    from stribeck.cli import laws as command

    return command.laws(law or [], json, test)


@app.command()
def fit(
    data: Annotated[
        list[Path], typer.Argument(metavar="DATA...", help="CSV, Parquet, MAT or NPZ; several files are several runs.")
    ],
    law: Annotated[list[str], typer.Option("--law", metavar="NAME", help="A law; of several, one is picked.")],
    time: Annotated[str | None, typer.Option("--time", metavar="COL", help="Column of the time.")] = None,
    position: Annotated[str | None, typer.Option("--position", metavar="COL", help="Column of the position.")] = None,
    velocity: Annotated[str | None, typer.Option("--velocity", metavar="COL", help="Column of the velocity.")] = None,
    force: Annotated[
        str | None, typer.Option("--force", metavar="COL", help="Column of the driving force, torque or current.")
    ] = None,
    force_gain: Annotated[
        str | None,
        typer.Option("--force-gain", metavar="X", help="Force per unit of that column; or a constant's name."),
    ] = None,
    acceleration: Annotated[str | None, typer.Option("--acceleration", metavar="COL")] = None,
    load: Annotated[str | None, typer.Option("--load", metavar="COL", help="Column of the normal load.")] = None,
    pressure: Annotated[str | None, typer.Option("--pressure", metavar="COL")] = None,
    command: Annotated[
        str | None, typer.Option("--command", metavar="COL", help="Column of what a drive is told (--drive).")
    ] = None,
    run: Annotated[str | None, typer.Option("--run", metavar="COL", help="Column of a run number.")] = None,
    unit: Annotated[
        list[str] | None, typer.Option("--unit", metavar="COL=UNIT", help="Unit of a column; SI unless given.")
    ] = None,
    mass: Annotated[float | None, typer.Option("--mass", metavar="M", help="kg; fitted unless given.")] = None,
    method: Annotated[
        str | None, typer.Option("--method", metavar="METHOD", help="static, presliding or dynamic.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="A constant that is given, such as k_v=1e6.")
    ] = None,
    free: Annotated[
        list[str] | None, typer.Option("--free", metavar="KEY", help="Fit a constant of the law's own too.")
    ] = None,
    term: Annotated[
        list[str] | None,
        typer.Option("--term", metavar="TERM", help="What the force holds beside mass and offset (docs/fit.md)."),
    ] = None,
    select: Annotated[
        bool, typer.Option("--select", help="Add the terms that lower the error over data left out.")
    ] = False,
    cutoff: Annotated[
        float | None,
        typer.Option("--cutoff", metavar="HZ", help="Of the motion's filter; else from the data; 0: none."),
    ] = None,
    trim: Annotated[
        int | None, typer.Option("--trim", metavar="N", help="Samples dropped at the start of a run.")
    ] = None,
    decimate: Annotated[
        int | None, typer.Option("--decimate", metavar="N", min=1, help="Fit one row in N; else from the data.")
    ] = None,
    robust: Annotated[bool, typer.Option("--robust", help="Huber's loss instead of squares.")] = False,
    folds: Annotated[int, typer.Option("--folds", min=2, help="Blocks of the cross-validation.")] = 10,
    starts: Annotated[int, typer.Option("--starts", min=1, help="Of the simulation-error fit.")] = 20,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of these starts.")] = 0,
    output: Annotated[
        str, typer.Option("--output", metavar="WHAT", help="What a simulation is to meet: force, velocity, position.")
    ] = "force",
    drive: Annotated[
        str | None,
        typer.Option("--drive", metavar="KIND[:KEY=VALUE,...]", help="What moves the body then: force, pid, spring."),
    ] = None,
    out: Out = None,
    json: Json = False,
) -> int:
    """Parameters of a law from a measured log, with intervals and a verdict on what the data cannot tell."""
    from stribeck.cli import fit as work

    columns = {
        "time": time, "position": position, "velocity": velocity, "acceleration": acceleration, "force": force,
        "load": load, "pressure": pressure, "run": run, "command": command,
    }  # fmt: skip
    request = {
        "mass": mass, "method": method, "free": free or (), "terms": term or (), "select": select, "decimate": decimate,
        "robust": robust, "folds": folds, "starts": starts, "seed": seed,
        "output": output, "drive": None if drive is None else work.drive(drive),
    }  # fmt: skip
    options = work.Options(columns, unit or [], force_gain, set_ or [], cutoff, trim, request)
    return work.fit(data, law, options, out, json)


@app.command()
def rig(
    stroke: Annotated[float, typer.Option("--stroke", metavar="M", help="The rig's travel, m.")],
    speed: Annotated[float, typer.Option("--speed", metavar="M/S", help="Its highest speed, m/s.")],
    force: Annotated[float, typer.Option("--force", metavar="N", help="Its largest force, N.")],
    deflection: Annotated[
        float | None,
        typer.Option("--deflection", metavar="M", help="Way to break-away, F_c/sigma_0, where it is roughly known."),
    ] = None,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="Write a SYNTHETIC log of the programme too: simulated, not measured.")
    ] = False,
    law: Annotated[str, typer.Option("--law", metavar="NAME", help="The synthetic rig's friction.")] = "lugre",
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="SET", help="Its constants: a set or a file.")
    ] = None,
    set_: Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="One of its constants.")] = None,
    seed: Annotated[int, typer.Option("--seed", help="Of its noise.")] = 0,
    out: Out = None,
    json: Json = False,
) -> int:
    """Print what to measure to fit a law: speeds, amplitudes, force rates for the limits of a rig."""
    from stribeck.cli import rig as command

    limits = (stroke, speed, force, deflection)
    return command.rig(limits, simulate, law, parameters, set_ or [], seed, out, json)


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
