"""The commands about measured data, and their options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.shared import Json, Out, ScenarioFile, Set, Trust, Undetermined, app
from stribeck.errors import InputError

# Columns of a record.
Data = Annotated[
    list[Path] | None,
    typer.Argument(metavar="DATA...", help="CSV, Parquet, MAT or NPZ; several files are several runs."),
]
Time = Annotated[str | None, typer.Option("--time", metavar="COL", help="Column of the time.")]
Position = Annotated[str | None, typer.Option("--position", metavar="COL", help="Column of the position.")]
Velocity = Annotated[str | None, typer.Option("--velocity", metavar="COL", help="Column of the velocity.")]
Acceleration = Annotated[str | None, typer.Option("--acceleration", metavar="COL", help="Column of the acceleration.")]
Force = Annotated[
    str | None, typer.Option("--force", metavar="COL", help="Column of the driving force, torque or current.")
]
GainOrName = Annotated[
    str | None, typer.Option("--force-gain", metavar="X", help="Force per unit of that column; or a constant's name.")
]
Gain = Annotated[str | None, typer.Option("--force-gain", metavar="X", help="Factor from that column to N or N m.")]
Load = Annotated[str | None, typer.Option("--load", metavar="COL", help="Column of the normal load.")]
Pressure = Annotated[str | None, typer.Option("--pressure", metavar="COL", help="Column of the pressure.")]
Command = Annotated[
    str | None, typer.Option("--command", metavar="COL", help="Column of what a drive is told (--drive).")
]
Run = Annotated[str | None, typer.Option("--run", metavar="COL", help="Column of a run number.")]
Unit = Annotated[list[str] | None, typer.Option("--unit", metavar="COL=UNIT", help="A column's unit; may be repeated.")]
UnitOrSI = Annotated[
    list[str] | None, typer.Option("--unit", metavar="COL=UNIT", help="Unit of a column; SI unless given.")
]
# Of fit alone.
Laws = Annotated[
    list[str] | None, typer.Option("--law", metavar="NAME", help="A law; of several, or without it, one is picked.")
]
Mass = Annotated[float | None, typer.Option("--mass", metavar="M", help="kg; fitted unless given.")]
Method = Annotated[str | None, typer.Option("--method", metavar="METHOD", help="static, presliding or dynamic.")]
Given = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="A constant that is given, such as k_v=1e6.")
]
Free = Annotated[list[str] | None, typer.Option("--free", metavar="KEY", help="Fit a constant of the law's own too.")]
Terms = Annotated[
    list[str] | None,
    typer.Option("--term", metavar="TERM", help="What the force holds beside mass and offset, or delay (docs/fit.md)."),
]
Select = Annotated[
    bool | None,
    typer.Option("--select/--no-select", help="Add terms that predict data left out better (docs/fit.md)."),
]
Cutoff = Annotated[
    float | None,
    typer.Option("--cutoff", metavar="HZ", help="Of the motion's filter; else from the data; 0: none."),
]
Trim = Annotated[int | None, typer.Option("--trim", metavar="N", help="Samples dropped at the start of a run.")]
Decimate = Annotated[
    int | None, typer.Option("--decimate", metavar="N", min=1, help="Fit one row in N; else from the data.")
]
Robust = Annotated[bool, typer.Option("--robust", help="Huber's loss instead of squares.")]
Folds = Annotated[int, typer.Option("--folds", min=2, help="Blocks of the cross-validation.")]
Starts = Annotated[int, typer.Option("--starts", min=1, help="Of the simulation-error fit.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Of these starts.")]
Output = Annotated[
    str, typer.Option("--output", metavar="WHAT", help="What a simulation is to meet: force, velocity, position.")
]
Drive = Annotated[
    str | None,
    typer.Option("--drive", metavar="KIND[:KEY=VALUE,...]", help="What moves the body then: force, pid, spring."),
]
Logs = Annotated[
    Path | None,
    typer.Option("--logs", metavar="LOGS.toml", help="DATA is a machine, and these are its recordings."),
]
Sought = Annotated[
    list[str] | None,
    typer.Option("--unknown", metavar="PATH=LOW:HIGH", help="What is sought beside [unknown] of LOGS.toml (--logs)."),
]
Transfer = Annotated[
    Path | None, typer.Option("--transfer", metavar="LOGS.toml", help="Recordings of another unit or day (--logs).")
]

Plan = Annotated[
    str | None,
    typer.Option(
        "--plan",
        metavar="stroke=M,speed=M/S,force=N[,deflection=M]",
        help="Print what to measure on a rig with these limits. deflection: way to break-away, F_c/sigma_0, if known.",
    ),
]
Simulate = Annotated[
    bool,
    typer.Option(
        "--simulate", help="With --plan and --out: write a synthetic log of it too (of --law, --set, --seed)."
    ),
]


@app.command(epilog="Example: stribeck fit log.csv --time t --position y --force F --out fit")
def fit(
    context: typer.Context,
    data: Data = None,
    law: Laws = None,
    time: Time = None,
    position: Position = None,
    velocity: Velocity = None,
    force: Force = None,
    force_gain: GainOrName = None,
    acceleration: Acceleration = None,
    load: Load = None,
    pressure: Pressure = None,
    command: Command = None,
    run: Run = None,
    unit: UnitOrSI = None,
    mass: Mass = None,
    method: Method = None,
    set_: Given = None,
    free: Free = None,
    term: Terms = None,
    select: Select = None,
    cutoff: Cutoff = None,
    trim: Trim = None,
    decimate: Decimate = None,
    robust: Robust = False,
    folds: Folds = 10,
    starts: Starts = 20,
    seed: Seed = 0,
    output: Output = "force",
    drive: Drive = None,
    logs: Logs = None,
    unknown: Sought = None,
    transfer: Transfer = None,
    plan: Plan = None,
    simulate: Simulate = False,
    out: Out = None,
    json: Json = False,
) -> int:
    """Parameters of a law from a measured log, or of a machine from its recordings (--logs), with intervals and a verdict
    on what the data cannot tell."""
    if plan is not None:
        from stribeck.cli import plan as planning

        return planning.plan(
            context, plan, simulate=simulate, laws=law or [], assignments=set_ or [], seed=seed, out=out, json=json
        )
    if simulate:
        raise InputError("--simulate: goes with --plan, which is not given")
    if not data:
        raise InputError("DATA: missing: a log to fit, or --plan to learn what to measure")
    if logs is not None or transfer is not None or unknown:
        from stribeck.cli import actuator

        actuator.check_options(context)
        return actuator.fit(data, logs, law or [], set_ or [], unknown or [], transfer, starts, seed, out, json)
    from stribeck.cli import fit as work
    from stribeck.identify.options import FitOptions

    columns = {
        "time": time, "position": position, "velocity": velocity, "acceleration": acceleration, "force": force,
        "load": load, "pressure": pressure, "run": run, "command": command,
    }  # fmt: skip
    options = FitOptions(
        mass, method, work.constants(set_ or []), tuple(free or ()), tuple(term or ()), select, decimate, robust, folds,
        starts, seed, output, work.drive(drive),
    )  # fmt: skip
    named = work.columns(columns, unit or [], force_gain)
    return work.fit(data, law or [], named, cutoff, trim, options, out, json)


@app.command(epilog="Example: stribeck predict another.csv --fit fit --out predicted")
def predict(
    data: Annotated[list[Path], typer.Argument(metavar="DATA...", help="A record that the fit has not seen.")],
    fit: Annotated[Path, typer.Option("--fit", metavar="DIR", help="The folder that stribeck fit --out wrote.")],
    time: Annotated[
        str | None, typer.Option("--time", metavar="COL", help="Columns: as in the fit unless given.")
    ] = None,
    position: Position = None,
    velocity: Velocity = None,
    force: Force = None,
    force_gain: Gain = None,
    load: Load = None,
    pressure: Pressure = None,
    unit: Unit = None,
    cutoff: Annotated[float | None, typer.Option("--cutoff", metavar="HZ", help="Of the motion's filter.")] = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
) -> int:
    """The force that a fitted model predicts for another record: error, overlay and page."""
    from stribeck.cli import fit as words
    from stribeck.cli import predict as command

    columns = {
        "time": time, "position": position, "velocity": velocity, "force": force, "load": load, "pressure": pressure,
    }  # fmt: skip
    return command.predict(data, fit, words.columns(columns, unit or [], force_gain), cutoff, out, json, trust)


@app.command(epilog="Example: stribeck validate rig.toml --log log.csv --time t --position y")
def validate(
    scenario: ScenarioFile,
    log: Annotated[Path, typer.Option("--log", metavar="FILE", help="The measured record.")],
    time: Time = None,
    position: Annotated[str | None, typer.Option("--position", metavar="COL", help="Compared with y.")] = None,
    velocity: Annotated[str | None, typer.Option("--velocity", metavar="COL", help="Compared with v.")] = None,
    force: Annotated[
        str | None, typer.Option("--force", metavar="COL", help="Measured friction, compared with F.")
    ] = None,
    force_gain: Gain = None,
    command: Annotated[
        str | None,
        typer.Option("--command", metavar="COL", help="What drove the rig: it replaces the scenario's signal."),
    ] = None,
    unit: Unit = None,
    set_: Set = None,
    trust: Trust = False,
    _undetermined: Undetermined = False,
    out: Out = None,
    json: Json = False,
) -> int:
    """A scenario against a measured record: overlay, error, residuals."""
    from stribeck.cli import fit as words
    from stribeck.cli import predict as work

    columns = {"time": time, "position": position, "velocity": velocity, "force": force, "command": command}
    of_log = words.columns(columns, unit or [], force_gain)
    return work.validate(scenario, log, of_log, set_ or [], out, json, trust)
