"""Scenarios in a few words, scaled to a machine."""

import pytest

from stribeck import Scenario, simulate
from stribeck.simulation import compiler
from tests.simulation.independent import MACHINES, machine

WITH_K_V = (
    "lugre_arctan", "lugre_sobczyk", "lugre_majorant", "elastoplastic_sobczyk", "elastoplastic_majorant",
    "coulomb_viscous", "stribeck",
)  # fmt: skip
BRISTLES = ("lugre", *WITH_K_V[:3], "elastoplastic", *WITH_K_V[3:5], "dahl")
LAWS = (*BRISTLES, "coulomb_viscous", "stribeck", "makkar")

needs_compiler = pytest.mark.skipif(compiler.find() is None, reason="needs a C compiler")


def law_table(name, on="canudas1995", **constants):
    """A law with the parameters of a machine, its own constants scaled to it."""
    p = machine(on)
    if name == "makkar":
        slope = 1 / p["v_s"]
        own = {
            "g1": p["F_s"] - p["F_c"], "g2": slope, "g3": 0.1 * slope, "g4": p["F_c"], "g5": slope, "g6": p["sigma_2"],
        }  # fmt: skip
        return {"name": name, **own, **constants}
    own = {"k_v": 1e4 / p["v_s"]} if name in WITH_K_V else {}
    if name.startswith("elastoplastic"):
        own["z_ba"] = 0.7 * p["F_c"] / p["sigma_0"]
    return {"name": name, "parameters": on, **own, **constants}


def rig(law, drive, signal, t_end, on="canudas1995", rows=200, initial=None, mass=None, **solve):
    """The data of a scenario: ``law`` a name or a table, ``drive`` a kind or a table."""
    return {
        "schema": 1,
        "law": law_table(law, on) if isinstance(law, str) else law,
        "plant": {"mass": mass or MACHINES[on][6], "initial": initial or {}},
        "drive": {**({"kind": drive} if isinstance(drive, str) else drive), "signal": signal},
        "solve": {"t_end": t_end, **solve},
        "output": {"step": t_end / rows},
    }


def spring(on, stretch=1.0):
    """A spring that F_s stretches by so many m."""
    return {"kind": "spring", "stiffness": machine(on)["F_s"] / stretch}


def pid(on, stretch=1.0, mass=None):
    """A PID controller that answers an error of so many m with F_s, damped."""
    k_p = machine(on)["F_s"] / stretch
    k_d = 2 * (k_p * (mass or MACHINES[on][6])) ** 0.5
    return {"kind": "pid", "K_p": k_p, "K_i": k_p * k_p / k_d / 2, "K_d": k_d}


def solved(data, folder=None):
    """The solution of a scenario's data, compiled and complete."""
    solution = simulate(Scenario(data, folder=folder))
    assert solution.status == "done", solution.reason
    assert solution.stats["solver"] == "rodas5p"
    return solution
