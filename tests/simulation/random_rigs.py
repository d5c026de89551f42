"""Rigs that nobody chose: random laws, parameters, drives and signals, sane in their proportions."""

import numpy as np

from tests.simulation.rig import LAWS, WITH_K_V


def random_rig(seed):
    """The data of a scenario."""
    random = np.random.default_rng(seed)
    law, p, mass = _law(random)
    drive, size, time = _drive(random, law["name"], p, mass)
    drive["signal"] = _signal(random, size, time)
    reach = p["F_s"] / p["sigma_0"]
    initial = {"y": _between(random, -3, 3) * reach}
    if drive["kind"] != "velocity" and random.random() < 0.5:
        initial["v"] = _between(random, -20, 20) * p["v_s"]
    if "sigma_0" in law["parameters"] and law["name"] not in ("coulomb_viscous", "stribeck"):
        initial["z"] = _between(random, -0.9, 0.9) * p["F_c"] / p["sigma_0"]
    return {
        "schema": 1, "law": law, "plant": {"mass": mass, "initial": initial}, "drive": drive,
        "solve": {"t_end": time}, "output": {"step": time / 250},
    }  # fmt: skip


def _between(random, low, high):
    return float(random.uniform(low, high))


def _scaled(random, low, high):
    return float(10 ** random.uniform(np.log10(low), np.log10(high)))


def _law(random):
    name = str(random.choice([law for law in LAWS if law != "makkar"]))
    mass, sigma_0, v_s = _scaled(random, 1e-2, 1e2), _scaled(random, 1e3, 1e8), _scaled(random, 1e-4, 1e-1)
    F_c = _scaled(random, 1, 100) * mass
    p = {
        "sigma_0": sigma_0, "sigma_1": _scaled(random, 0.1, 3) * (sigma_0 * mass) ** 0.5,
        "sigma_2": _scaled(random, 1e-4, 1e-2) * F_c / v_s, "F_c": F_c, "F_s": F_c * _between(random, 1, 2), "v_s": v_s,
    }  # fmt: skip
    own = {"k_v": _scaled(random, 30, 3e4) / v_s} if name in WITH_K_V else {}
    if name.startswith("elastoplastic"):
        own["z_ba"] = _between(random, 0.1, 0.9) * F_c / sigma_0
    return {"name": name, "parameters": p, **own}, p, mass


def _drive(random, law, p, mass):
    """The drive, the size of its signal and the length of the run."""
    kind = str(random.choice(["force", "spring", "pid", "velocity"]))
    settle = (mass / p["sigma_0"]) ** 0.5
    if kind == "velocity":
        return {"kind": kind}, p["v_s"] * _scaled(random, 0.3, 30), p["F_s"] / p["sigma_0"] / p["v_s"] * 100
    if kind == "force":
        return {"kind": kind}, p["F_s"] * _scaled(random, 0.6, 3), settle * _scaled(random, 30, 200)
    k = p["sigma_0"] * _scaled(random, 1e-4, 1e-2)
    size, time = p["F_s"] / k * _scaled(random, 1, 10), (mass / k) ** 0.5 * _scaled(random, 6, 40)
    if kind == "spring":
        return {"kind": kind, "stiffness": k}, size, time
    k_d = 2 * (k * mass) ** 0.5
    return {"kind": kind, "K_p": k, "K_i": _between(random, 0, 0.3) * k * k / k_d, "K_d": k_d}, size, time


def _signal(random, size, time):
    kind = str(random.choice(["points", "ramp", "sine", "step"]))
    if kind == "ramp":
        return {"kind": kind, "rate": size / time * _between(random, 0.5, 3)}
    if kind == "sine":
        offset, phase = size * _between(random, -0.5, 0.5), _between(random, -3, 3)
        return {"kind": kind, "amplitude": size, "frequency": 3 / time, "offset": offset, "phase": phase}
    if kind == "step":
        return {"kind": kind, "value": size, "time": _between(random, -0.1, 0.5) * time}
    t = np.sort(random.uniform(0, 0.9 * time, 6))
    t[3] = t[2]  # a jump
    return {"kind": kind, "t": t.tolist(), "value": (size * random.uniform(-1, 1, 6)).tolist()}
