"""Recordings of machines whose numbers are known: simulated by the independent solver, which shares no code."""

import csv
import json
from functools import cache

import numpy as np
import tomli_w

from tests.reference.apart import solve

NOISE = 2e-5


def body(mass=1.0, F_c=1.0, gain=0.0, pull=0.0, amplitude=3.0, t_end=1.0, step=0.01, **more):
    """A body under a push, its friction, and a load that may raise its level."""
    law = {"sigma_0": 2e4, "sigma_1": 60.0, "sigma_2": 4.0, "F_c": F_c, "F_s": 1.3 * F_c, "v_s": 0.02} | more
    data = {
        "schema": 2, "name": "axis",
        "bodies": {"a": {"mass": mass}},
        "contacts": {"guide": {"from": "a", "law": {"name": "lugre_majorant", "k_v": 1e4, "parameters": law}}},
        "loads": {"push": {"on": "a", "kind": "signal", "signal": driven(amplitude, t_end, step)}},
        "solve": {"t_end": t_end}, "output": {"step": step},
    }  # fmt: skip
    if pull:
        weight = {"kind": "points", "t": [0.0, t_end], "value": [pull, pull]}
        data["loads"]["weight"] = {"on": "a", "kind": "signal", "signal": weight}
        data["contacts"]["guide"]["loads"] = [{"force": "weight", "F_c": gain, "F_s": gain}]
    return data


def driven(amplitude, t_end, step):
    """The push as it would be recorded: straight between samples."""
    t = np.arange(round(t_end / step) + 1) * step
    push = amplitude * np.sin(9 * t) * (1 + 0.6 * np.sin(23 * t))
    return {"kind": "points", "t": t.tolist(), "value": push.tolist()}


@cache
def played(data):
    """The columns of a machine, whose data is JSON: many tests record the same one."""
    return solve(json.loads(data), rtol=1e-9)


def record(path, data, seed=0, noise=NOISE, column="a.y", change=None):
    """Write what an encoder and the drive would record of a machine."""
    y = played(json.dumps(data))[column]
    t = np.arange(len(y)) * data["output"]["step"]
    rng = np.random.default_rng(seed)
    table = {
        "t": t,
        "y": y + noise * rng.standard_normal(len(t)),
        "u": np.array(data["loads"]["push"]["signal"]["value"]),
    }
    if change is not None:
        table = change(table)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(table)
        writer.writerows(zip(*table.values(), strict=True))


def logs(folder, entries, unknown, **more):
    """Write LOGS.toml; an entry is a file's name, or a table."""
    common = {"outputs": {"a.y": "y"}, "inputs": {"loads.push.signal": "u"}}
    listed = [{**common, **({"file": e} if isinstance(e, str) else e)} for e in entries]
    path = folder / "logs.toml"
    path.write_text(tomli_w.dumps({"log": listed, "unknown": unknown, **more}))
    return path
