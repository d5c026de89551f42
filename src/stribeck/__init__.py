"""Stribeck: friction models that control and mechatronics engineers can simulate, prove, fit and ship."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from stribeck.version import __version__ as __version__

if TYPE_CHECKING:
    from stribeck.analysis.advise import Advice, advise
    from stribeck.analysis.properties import Verdict, Verdicts, check, storage_interval
    from stribeck.analysis.properties.margins import margins
    from stribeck.analysis.properties.matrix import check_all
    from stribeck.errors import BuildError, InputError, NotDifferentiable, StribeckError, StribeckNote
    from stribeck.export import export
    from stribeck.identify.fitting import fit
    from stribeck.laws import law
    from stribeck.parameter_sets import parameters
    from stribeck.scenario import Scenario
    from stribeck.simulation import Ensemble, Solution, simulate, simulate_ensemble

__all__ = [
    "Advice", "BuildError", "Ensemble", "InputError", "NotDifferentiable", "Scenario", "Solution", "StribeckError",
    "StribeckNote", "Verdict", "Verdicts", "advise", "check", "check_all", "export", "fit", "law", "margins",
    "parameters", "simulate", "simulate_ensemble", "storage_interval",
]  # fmt: skip

# Public names and the modules they come from, imported at first use: 'import stribeck' itself costs nothing.
_HOME = {
    **dict.fromkeys(
        ("BuildError", "InputError", "NotDifferentiable", "StribeckError", "StribeckNote"), "stribeck.errors"
    ),
    **dict.fromkeys(("Advice", "advise"), "stribeck.analysis.advise"),
    "export": "stribeck.export",
    "fit": "stribeck.identify.fitting",
    **dict.fromkeys(("Verdict", "Verdicts", "check", "storage_interval"), "stribeck.analysis.properties"),
    "check_all": "stribeck.analysis.properties.matrix",
    "law": "stribeck.laws",
    "margins": "stribeck.analysis.properties.margins",
    "parameters": "stribeck.parameter_sets",
    "Scenario": "stribeck.scenario",
    **dict.fromkeys(("Ensemble", "Solution", "simulate", "simulate_ensemble"), "stribeck.simulation"),
}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(importlib.import_module(_HOME[name]), name)
    raise AttributeError(f"module 'stribeck' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
