"""Conversion of other programs' files into machines."""

from __future__ import annotations

from pathlib import Path

from stribeck.constants import path_of, show
from stribeck.errors import InputError
from stribeck.exports.exchange.bam import from_bam
from stribeck.scenario import Scenario

__all__ = ["from_bam", "import_"]


def import_(kind: str, file: str | Path) -> Scenario:
    """Convert another program's file into a machine, with its friction, motors and loads.

    Args:
        kind: ``"bam"`` (models m1 to m6, a JSON file).
        file: the file.

    Raises:
        InputError: if the kind is unknown, or the file is not such a model; one line for each problem.
    """
    if kind != "bam":
        raise InputError(f"kind: {show(kind)}: must be bam")
    return Scenario(from_bam(path_of(file, "file")))
