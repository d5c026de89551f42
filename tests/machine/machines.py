"""Machines in a few words."""

import copy

import numpy as np

from tests.simulation import rig


def law(name="lugre_majorant", **changes):
    """A friction law of some newtons, milli- and micrometers."""
    own = {"k_v": 1e5} if name != "lugre" else {}
    own |= {"z_ba": 2e-5} if name.startswith("elastoplastic") else {}
    p = {"sigma_0": 2e4, "sigma_1": 60.0, "sigma_2": 1.5, "F_c": 1.0, "F_s": 1.4, "v_s": 0.02}
    own |= {n: changes.pop(n) for n in ("k_v", "z_ba", "v_d") if n in changes}
    return {"name": name, **own, "parameters": {**p, **changes}}


def machine(bodies, t_end=0.7, rows=28, energy=True, **sections):
    """The data of a machine."""
    return {
        "schema": 2, "name": "machine", "bodies": bodies, **sections,
        "solve": {"t_end": t_end}, "output": {"step": t_end / rows, "energy": energy},
    }  # fmt: skip


def push(amplitude=3.0, frequency=2.0, on="a"):
    """A sine of a force."""
    signal = {"kind": "sine", "amplitude": amplitude, "frequency": frequency}
    return {"on": on, "kind": "signal", "signal": signal}


def edited(data, changes):
    """A copy with other values at dotted paths."""
    data = copy.deepcopy(data)
    for path, value in changes.items():
        *parents, last = path.split(".")
        table = data
        for name in parents:
            table = table.setdefault(name, {})
        table[last] = value
    return data


def solved(data, folder=None):
    """The solution of a machine's data, compiled and complete."""
    solution = rig.solved(data, folder)
    if solution.scenario.output.energy:
        assert_balanced(solution)
    return solution


def assert_balanced(columns, share=1e-7):
    """E_in + E_stored(0) = E_stored + E_dissipated, to a share of the largest energy that was there."""
    went_in, stored, lost = (np.asarray(columns[f"E_{name}"]) for name in ("in", "stored", "dissipated"))
    size = max(np.max(np.abs(went_in)), np.max(np.abs(stored)), 1e-12)
    assert np.max(np.abs(went_in + stored[0] - stored - lost)) <= share * size
