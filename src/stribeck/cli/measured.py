"""The commands about measured data, and their options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.shared import Json, Out, ScenarioFile, Set, Trust, Undetermined, app


@app.command(epilog="Example: stribeck fit log.csv --time t --position y --force F --out fit")
def fit(
    data: Annotated[
        list[Path], typer.Argument(metavar="DATA...", help="CSV, Parquet, MAT or NPZ; several files are several runs.")
    ],
    law: Annotated[
        list[str] | None, typer.Option("--law", metavar="NAME", help="A law; of several, or without it, one is picked.")
    ] = None,
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
    acceleration: Annotated[
        str | None, typer.Option("--acceleration", metavar="COL", help="Column of the acceleration.")
    ] = None,
    load: Annotated[str | None, typer.Option("--load", metavar="COL", help="Column of the normal load.")] = None,
    pressure: Annotated[str | None, typer.Option("--pressure", metavar="COL", help="Column of the pressure.")] = None,
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
        bool | None,
        typer.Option("--select/--no-select", help="Add terms that predict data left out better (docs/fit.md)."),
    ] = None,
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
    logs: Annotated[
        Path | None,
        typer.Option("--logs", metavar="LOGS.toml", help="DATA is a machine, and these are its recordings."),
    ] = None,
    transfer: Annotated[
        Path | None, typer.Option("--transfer", metavar="LOGS.toml", help="Recordings of another unit or day (--logs).")
    ] = None,
    out: Out = None,
    json: Json = False,
) -> int:
    """Parameters of a law from a measured log, or of a machine from its recordings (--logs), with intervals and a verdict
    on what the data cannot tell."""
    if logs is not None:
        from stribeck.cli import actuator

        return actuator.fit(data, logs, law or [], set_ or [], transfer, starts, seed, out, json)
    if transfer is not None:
        from stribeck.errors import InputError

        raise InputError(f"--transfer: {str(transfer)!r}: needs --logs")
    from stribeck.cli import fit as work
    from stribeck.identify.api import is_simulated
    from stribeck.identify.data.prepare import Preparation
    from stribeck.identify.options import FitOptions

    columns = {
        "time": time, "position": position, "velocity": velocity, "acceleration": acceleration, "force": force,
        "load": load, "pressure": pressure, "run": run, "command": command,
    }  # fmt: skip
    options = FitOptions(
        mass=mass, method=method, constants=work.constants(set_ or []), free=tuple(free or ()), terms=tuple(term or ()),
        select=select, decimate=decimate, robust=robust, folds=folds, starts=starts, seed=seed, output=output,
        drive=None if drive is None else work.drive(drive),
    )  # fmt: skip
    how = Preparation(cutoff, trim, is_simulated(law or [], method))
    return work.fit(data, law or [], work.columns(columns, unit or [], force_gain), how, options, out, json)


@app.command(epilog="Example: stribeck predict another.csv --fit fit --out predicted")
def predict(
    data: Annotated[list[Path], typer.Argument(metavar="DATA...", help="A record that the fit has not seen.")],
    fit: Annotated[Path, typer.Option("--fit", metavar="DIR", help="The folder that stribeck fit --out wrote.")],
    time: Annotated[
        str | None, typer.Option("--time", metavar="COL", help="Columns: as in the fit unless given.")
    ] = None,
    position: Annotated[str | None, typer.Option("--position", metavar="COL", help="Column of the position.")] = None,
    velocity: Annotated[str | None, typer.Option("--velocity", metavar="COL", help="Column of the velocity.")] = None,
    force: Annotated[
        str | None, typer.Option("--force", metavar="COL", help="Column of the driving force, torque or current.")
    ] = None,
    force_gain: Annotated[
        str | None, typer.Option("--force-gain", metavar="X", help="Factor from that column to N or N m.")
    ] = None,
    load: Annotated[str | None, typer.Option("--load", metavar="COL", help="Column of the normal load.")] = None,
    pressure: Annotated[str | None, typer.Option("--pressure", metavar="COL", help="Column of the pressure.")] = None,
    unit: Annotated[
        list[str] | None, typer.Option("--unit", metavar="COL=UNIT", help="A column's unit; may be repeated.")
    ] = None,
    cutoff: Annotated[float | None, typer.Option("--cutoff", metavar="HZ", help="Of the motion's filter.")] = None,
    out: Out = None,
    json: Json = False,
) -> int:
    """The force that a fitted model predicts for another record: error, overlay and page."""
    from stribeck.cli import fit as words
    from stribeck.cli import predict as command

    columns = {
        "time": time, "position": position, "velocity": velocity, "force": force, "load": load, "pressure": pressure,
    }  # fmt: skip
    return command.predict(data, fit, words.columns(columns, unit or [], force_gain), cutoff, out, json)


@app.command(epilog="Example: stribeck validate rig.toml --log log.csv --time t --position y")
def validate(
    scenario: ScenarioFile,
    log: Annotated[Path, typer.Option("--log", metavar="FILE", help="The measured record.")],
    time: Annotated[str | None, typer.Option("--time", metavar="COL", help="Column of the time.")] = None,
    position: Annotated[str | None, typer.Option("--position", metavar="COL", help="Compared with y.")] = None,
    velocity: Annotated[str | None, typer.Option("--velocity", metavar="COL", help="Compared with v.")] = None,
    force: Annotated[
        str | None, typer.Option("--force", metavar="COL", help="Measured friction, compared with F.")
    ] = None,
    force_gain: Annotated[
        str | None, typer.Option("--force-gain", metavar="X", help="Factor from that column to N or N m.")
    ] = None,
    command: Annotated[
        str | None,
        typer.Option("--command", metavar="COL", help="What drove the rig: it replaces the scenario's signal."),
    ] = None,
    unit: Annotated[
        list[str] | None, typer.Option("--unit", metavar="COL=UNIT", help="A column's unit; may be repeated.")
    ] = None,
    set_: Set = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
) -> int:
    """A scenario against a measured record: overlay, error, residuals."""
    from stribeck.cli import fit as words
    from stribeck.cli import predict as work

    columns = {"time": time, "position": position, "velocity": velocity, "force": force, "command": command}
    of_log = words.columns(columns, unit or [], force_gain)
    return work.validate(scenario, log, of_log, set_ or [], out, json, trust)


@app.command(epilog="Example: stribeck rig --stroke 0.05 --speed 0.1 --force 50 --out plan")
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
    _undetermined: Undetermined = False,
) -> int:
    """Print what to measure to fit a law: speeds, amplitudes, force rates for the limits of a rig."""
    from stribeck.cli import rig as command

    limits = (stroke, speed, force, deflection)
    return command.rig(limits, simulate, law, parameters, set_ or [], seed, out, json)
