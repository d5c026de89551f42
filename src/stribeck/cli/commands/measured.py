"""The command ``validate`` and its options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli import record
from stribeck.cli.record import Gain, Time, Unit
from stribeck.cli.shared import Json, Out, ScenarioFile, Set, Trust, Undetermined, app


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
    from stribeck.cli import predict as work

    columns = {"time": time, "position": position, "velocity": velocity, "force": force, "command": command}
    of_log = record.columns(columns, unit or [], force_gain)
    return work.validate(scenario, log, of_log, set_ or [], out, json, trust)
