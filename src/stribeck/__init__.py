"""Stribeck: friction models that control and mechatronics engineers can simulate, prove, fit and ship."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from stribeck.version import __version__ as __version__

if TYPE_CHECKING:
    from stribeck.cli.doctor import doctor
    from stribeck.cli.new import new
    from stribeck.constants import Constant
    from stribeck.errors import InputError, StribeckError
    from stribeck.explorer import explore
    from stribeck.exports import export
    from stribeck.exports.exchange import import_
    from stribeck.identify.api import fit
    from stribeck.identify.predict import predict
    from stribeck.identify.result import Fit
    from stribeck.laws import law
    from stribeck.laws.base import BristleLaw, Law, StaticLaw
    from stribeck.laws.library import library
    from stribeck.loops import design
    from stribeck.machine import signal as signals
    from stribeck.machine.elements.bodies import Body
    from stribeck.machine.elements.contacts import Contact
    from stribeck.machine.elements.controllers import Controller
    from stribeck.machine.elements.links import Link
    from stribeck.machine.elements.loads import Load
    from stribeck.machine.elements.motors import Motor
    from stribeck.properties import check
    from stribeck.scenario import Scenario, load
    from stribeck.scenario.objects import Machine
    from stribeck.simulation import Ensemble, Solution, simulate
    from stribeck.sweeps.job import sweep

__all__ = [
    "Body", "BristleLaw", "Constant", "Contact", "Controller", "Ensemble", "Fit", "InputError", "Law", "Link", "Load",
    "Machine", "Motor", "Scenario", "Solution", "StaticLaw", "StribeckError", "check", "design", "doctor", "explore",
    "export", "fit", "import_", "law", "library", "load", "new", "predict", "signals", "simulate", "sweep",
]  # fmt: skip

# The modules that the public names come from, imported at first use: 'import stribeck' itself costs nothing.
_HOME = {
    "stribeck.cli.doctor": ("doctor",),
    "stribeck.cli.new": ("new",),
    "stribeck.constants": ("Constant",),
    "stribeck.errors": ("InputError", "StribeckError"),
    "stribeck.explorer": ("explore",),
    "stribeck.exports.exchange": ("import_",),
    "stribeck.exports": ("export",),
    "stribeck.identify.api": ("fit",),
    "stribeck.identify.predict": ("predict",),
    "stribeck.identify.result": ("Fit",),
    "stribeck.laws": ("law",),
    "stribeck.laws.base": ("BristleLaw", "Law", "StaticLaw"),
    "stribeck.laws.library": ("library",),
    "stribeck.loops": ("design",),
    "stribeck.properties": ("check",),
    "stribeck.scenario": ("Scenario", "load"),
    "stribeck.machine.elements.bodies": ("Body",),
    "stribeck.machine.elements.contacts": ("Contact",),
    "stribeck.machine.elements.controllers": ("Controller",),
    "stribeck.machine.elements.links": ("Link",),
    "stribeck.machine.elements.loads": ("Load",),
    "stribeck.machine.elements.motors": ("Motor",),
    "stribeck.scenario.objects": ("Machine",),
    "stribeck.simulation": ("Ensemble", "Solution", "simulate"),
    "stribeck.sweeps.job": ("sweep",),
}  # fmt: skip
_MODULES = {"signals": "stribeck.machine.signal"}  # names that are a module of theirs
_EXTRA = {"export": "fmu", "fit": "fit", "predict": "fit"}  # where one package alone would not be enough


def __getattr__(name: str) -> Any:
    if name in __all__:
        from stribeck.errors import needed

        with needed(f"stribeck.{name}", _EXTRA.get(name, "")):
            if name in _MODULES:
                return importlib.import_module(_MODULES[name])
            home = next(module for module, names in _HOME.items() if name in names)
            return getattr(importlib.import_module(home), name)
    raise AttributeError(f"module 'stribeck' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
