"""``--part machine --target c``: the machine with its solver in C99, and a program that runs it."""

from __future__ import annotations

from stribeck.export.c.ccode import pair, render
from stribeck.export.machine.model import MachineModel


def files(model: MachineModel) -> dict[str, str | bytes]:
    """``NAME.c``, ``NAME.h`` and ``NAME_run.c``, by file name."""
    values = model.context()
    return {**pair(model.name, "machine", values), f"{model.name}_run.c": render("machine_run.c", **values)}
