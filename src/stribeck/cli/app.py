"""The command with all its commands, in the order in which ``stribeck --help`` shows them."""

from __future__ import annotations

from copy import copy

from typer import Typer

from stribeck.cli import check, design, doctor, explore, export, fit, import_, library, new, predict, run, sweep  # noqa: F401
from stribeck.cli.options import app

__all__ = ["app", "with_command"]

_ORDER = [
    "run",
    "sweep",
    "new",
    "explore",
    "check",
    "design",
    "export",
    "import",
    "library",
    "fit",
    "predict",
    "doctor",
]
app.registered_commands.sort(key=lambda each: _ORDER.index(str(each.name)))


def with_command(name: str) -> Typer:
    """The command with this one alone, whose options are then all that is made; with all where there is no such one."""
    if not (named := [each for each in app.registered_commands if each.name == name]):
        return app
    only = copy(app)
    only.registered_commands = named
    return only
