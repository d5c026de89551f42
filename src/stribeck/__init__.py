"""Stribeck: friction models that control and mechatronics engineers can simulate, prove, fit and ship."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from stribeck.version import __version__ as __version__

if TYPE_CHECKING:
    from stribeck.constants import Constant
    from stribeck.errors import BuildError, InputError, NotDifferentiable, StribeckError, StribeckNote
    from stribeck.export import export
    from stribeck.identify.api import fit, read_log
    from stribeck.identify.result import Fit
    from stribeck.laws import law
    from stribeck.laws.base import BristleLaw, Claims, Law
    from stribeck.laws.library import library
    from stribeck.loops import design
    from stribeck.machine.elements.bodies import Body
    from stribeck.machine.elements.contacts import Contact
    from stribeck.machine.elements.controllers import Controller
    from stribeck.machine.elements.links import Link
    from stribeck.machine.elements.loads import Load
    from stribeck.machine.elements.motors import Motor
    from stribeck.machine.signal import File, Points, PointToPoint, Ramp, Sine, Spline, Step
    from stribeck.parameter_sets import allow_undetermined
    from stribeck.properties import Verdict, Verdicts, check
    from stribeck.properties.ports import MachineVerdicts
    from stribeck.scenario import Scenario
    from stribeck.scenario.objects import Machine
    from stribeck.simulation import Ensemble, Solution, simulate, simulate_ensemble
    from stribeck.sweeps.job import sweep

__all__ = [
    "Body", "BristleLaw", "BuildError", "Claims", "Constant", "Contact", "Controller", "Ensemble",
    "File", "Fit", "InputError", "Law", "Link", "Load", "Machine", "MachineVerdicts", "Motor",
    "NotDifferentiable", "PointToPoint", "Points", "Ramp", "Scenario", "Sine", "Solution", "Spline", "Step",
    "StribeckError", "StribeckNote", "Verdict", "Verdicts", "allow_undetermined", "check",
    "design", "export", "fit", "law", "library",
    "read_log", "simulate", "simulate_ensemble", "sweep",
]  # fmt: skip

# Public names and the modules they come from, imported at first use: 'import stribeck' itself costs nothing.
_HOME = {
    **dict.fromkeys(
        ("BuildError", "InputError", "NotDifferentiable", "StribeckError", "StribeckNote"), "stribeck.errors"
    ),
    "export": "stribeck.export",
    **dict.fromkeys(("fit", "read_log"), "stribeck.identify.api"),
    "Fit": "stribeck.identify.result",
    "sweep": "stribeck.sweeps.job",
    "Constant": "stribeck.constants",
    **dict.fromkeys(("BristleLaw", "Claims", "Law"), "stribeck.laws.base"),
    **dict.fromkeys(("Verdict", "Verdicts", "check"), "stribeck.properties"),
    "design": "stribeck.loops",
    "MachineVerdicts": "stribeck.properties.ports",
    "law": "stribeck.laws",
    "library": "stribeck.laws.library",
    "allow_undetermined": "stribeck.parameter_sets",
    "Scenario": "stribeck.scenario",
    "Body": "stribeck.machine.elements.bodies",
    "Contact": "stribeck.machine.elements.contacts",
    "Controller": "stribeck.machine.elements.controllers",
    "Link": "stribeck.machine.elements.links",
    "Load": "stribeck.machine.elements.loads",
    "Motor": "stribeck.machine.elements.motors",
    **dict.fromkeys(("File", "PointToPoint", "Points", "Ramp", "Sine", "Spline", "Step"), "stribeck.machine.signal"),
    "Machine": "stribeck.scenario.objects",
    **dict.fromkeys(("Ensemble", "Solution", "simulate", "simulate_ensemble"), "stribeck.simulation"),
}
_EXTRA = {"export": "export", "fit": "fit", "read_log": "fit"}  # where one package alone would not be enough


def __getattr__(name: str) -> Any:
    if name in _HOME:
        from stribeck.errors import needed

        with needed(f"stribeck.{name}", _EXTRA.get(name, "")):
            return getattr(importlib.import_module(_HOME[name]), name)
    raise AttributeError(f"module 'stribeck' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
