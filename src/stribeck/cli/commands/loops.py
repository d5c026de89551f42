"""The commands about what friction does to a controlled axis."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.shared import ControllerName, Json, Out, ScenarioFile, Set, Trust, Undetermined, app


@app.command(epilog="Example: stribeck gains servo.toml --out gains")
def gains(
    scenario: ScenarioFile,
    v_max: Annotated[
        float | None,
        typer.Option("--v-max", metavar="V", help="Speeds to prove it for, m/s; twice those met unless given."),
    ] = None,
    set_: Set = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Show whether a servo's Lyapunov function decreases: conditions on the gains, a proof, and the simulation.

    Of a machine: whether its loop is quiet, creeps, hunts or grows with the gains that it has, as 'stribeck design' says.
    """
    from stribeck.cli import gains as command

    return command.gains(scenario, v_max, set_ or [], out, json, trust)


@app.command(epilog="Example: stribeck design machine.toml --vary controllers.axis.K_p=10:1000 --out design")
def design(
    scenario: ScenarioFile,
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="PATH=LOW:HIGH", help="Find where the verdict changes; may be repeated."),
    ] = None,
    compensate: Annotated[bool, typer.Option("--compensate", help="Compare remedies against friction.")] = False,
    uncertainty: Annotated[
        Path | None,
        typer.Option(
            "--uncertainty", metavar="parameters.toml", help="Intervals of the friction, of a fit; else 10 % both ways."
        ),
    ] = None,
    controller: ControllerName = None,
    seed: Annotated[int, typer.Option("--seed", metavar="N", help="Seed of the random samples of the friction.")] = 0,
    set_: Set = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Will this axis hunt? Verdict, boundaries, errors, and what may be done against its friction."""
    from stribeck.cli import design as command

    options = {
        "vary": vary or [], "compensate": compensate, "uncertainty": uncertainty, "controller": controller, "seed": seed,
    }  # fmt: skip
    return command.run(scenario, set_ or [], options, out, json, trust)
