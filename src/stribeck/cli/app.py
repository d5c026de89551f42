"""The command with all its commands, in the order in which ``stribeck --help`` shows them."""

from __future__ import annotations

from copy import copy

from typer import Typer

from stribeck.cli.options import app

# isort: off
from stribeck.cli import run as run
from stribeck.cli import sweep as sweep
from stribeck.cli import new as new
from stribeck.cli import explore as explore
from stribeck.cli import check as check
from stribeck.cli import design as design
from stribeck.cli import export as export
from stribeck.cli import import_ as import_
from stribeck.cli import library as library
from stribeck.cli import fit as fit
from stribeck.cli import predict as predict
from stribeck.cli import doctor as doctor
# isort: on

__all__ = ["app", "with_command"]


def with_command(name: str) -> Typer:
    """The command with this one alone, whose options are then all that is made; with all where there is no such one."""
    if not (named := [each for each in app.registered_commands if each.name == name]):
        return app
    only = copy(app)
    only.registered_commands = named
    return only
