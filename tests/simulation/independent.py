"""A second solver on equations written anew from theory.md: plain floats, SciPy's LSODA, one run for each signal piece.

Nothing of stribeck is used here, so that a mistake in its equations, code or solver cannot stand on both sides.
"""

from itertools import pairwise
from math import floor, sqrt

import numpy as np
from scipy.integrate import odeint

from tests.reference import apart_parts

# theory.md, section 7; the mass is the machine's, or a plausible one: sigma_0 sigma_1 sigma_2 F_c F_s v_s mass
MACHINES = {
    "canudas1995": (1e5, sqrt(1e5), 0.4, 1.0, 1.5, 1e-3, 1.0),
    "olsson1998": (260.0, 0.6, 0.0176, 0.28, 0.33, 0.01, 0.0023),
    "direct_drive2016": (2750.0, 45.2, 1.819, 6.975, 8.558, 0.06109, 0.045),
    "liu2015": (1.67e6, 6e3, 2.6e4, 2.5, 3.0, 1.6e-8, 1.0),
    "valve_graphite": (1.038e9, 2.442e5, 7.048e4, 669.9, 942.1, 3.22e-3, 10.0),
    "valve_teflon": (3.084e5, 650.0, 6.817, 0.415, 0.5148, 3.43e-4, 1.0),
}


def machine(name):
    """The parameters of a machine by name."""
    return dict(zip(("sigma_0", "sigma_1", "sigma_2", "F_c", "F_s", "v_s"), MACHINES[name][:6], strict=True))


def friction(law, p):
    """(v, z) -> (dz/dt, F) of a law of theory.md, section 1."""
    return lambda v, z: apart_parts.friction(law, p, v, z)


def signal(table, t_end):
    """The breaks of a signal within (0, t_end), and from them a function: the piece's number -> (t -> value)."""
    built = apart_parts.Signal(table)
    breaks = sorted({t for t in built.knots if 0 < t < t_end})

    def line(piece):
        value = built.piece(breaks[piece - 1] if piece else 0.0)
        return lambda t: value(t)[0]

    return breaks, line


def _body(data, force_of):
    """(t, r, x) -> dx/dt for x = y, v, z, and I under PID control; for y, z where the velocity is given."""
    drive, mass = data["drive"], data.get("plant", {}).get("mass")

    def given_velocity(r, x):
        return [r, force_of(r, x[1])[0]]

    def force(r, x):
        dz, F = force_of(x[1], x[2])
        return [x[1], (r - F) / mass, dz]

    def spring(r, x):
        dz, F = force_of(x[1], x[2])
        return [x[1], (drive["stiffness"] * (r - x[0]) - F) / mass, dz]

    def pid(r, x):
        dz, F = force_of(x[1], x[2])
        u = -drive["K_p"] * (x[0] - r) - drive["K_i"] * x[3] - drive["K_d"] * x[1]
        return [x[1], (u - F) / mass, dz, x[0] - r]

    return {"velocity": given_velocity, "force": force, "spring": spring, "pid": pid}[drive["kind"]]


def _start(data):
    initial = data.get("plant", {}).get("initial", {})
    y, v, z = (initial.get(name, 0.0) for name in "yvz")
    return {"velocity": [y, z], "pid": [y, v, z, 0.0]}.get(data["drive"]["kind"], [y, v, z])


def constants(data):
    """The constants of the law of a scenario's data, all in one table."""
    law = {key: value for key, value in data["law"].items() if key not in ("name", "parameters")}
    given = data["law"].get("parameters", {})
    return {**(machine(given) if isinstance(given, str) else given), **law}


def _tolerances(p, kind):
    """What is nothing beside the natural length and speed of a law."""
    length = p["F_s"] / p["sigma_0"] if "sigma_0" in p else 1e-5
    y, v = 1e-13 * length, 1e-13 * p.get("v_s", 1e-4)
    return {"velocity": [y, y], "pid": [y, v, y, y]}.get(kind, [y, v, y])


def solve(data, rtol=1e-12, evaluations=2_000_000):
    """The columns t, y, v, z and F of a scenario's data on its output rows.

    Raises:
        RuntimeError: LSODA gave up, or needed more evaluations than allowed.
    """
    p, kind = constants(data), data["drive"]["kind"]
    force_of, atol = friction(data["law"]["name"], p), _tolerances(p, kind)
    body, t_end, step = _body(data, force_of), data["solve"]["t_end"], data["output"]["step"]
    rows = np.arange(floor(t_end / step + 1e-9) + 1) * step
    end = max(t_end, rows[-1])
    breaks, line = signal(data["drive"]["signal"], end)
    edges, x, count = [0.0, *breaks, end], np.array(_start(data)), 0
    states, inputs = [], []
    for piece, (begin, stop) in enumerate(pairwise(edges)):
        r = line(piece)

        def rates(t, x, r=r):
            nonlocal count
            count += 1
            if count > evaluations:
                raise RuntimeError("too long")
            return body(r(t), x)

        final = piece == len(edges) - 2
        inner = rows[(rows >= begin) & ((rows <= stop) if final else (rows < stop))]
        times = np.concatenate([[begin], inner, [stop]])
        result, info = odeint(
            rates, x, times, tfirst=True, rtol=rtol, atol=atol, mxstep=10**7, tcrit=[stop], full_output=True,
            hmax=0.05 / data["drive"]["signal"].get("frequency", 1e-9),
        )  # fmt: skip
        if info["message"] != "Integration successful.":
            raise RuntimeError(info["message"])
        x = result[-1]
        states.append(result[1:-1])
        inputs += [r(t) for t in inner]
    return _columns(rows, np.concatenate(states), inputs, kind, force_of)


def _columns(rows, x, inputs, kind, force_of):
    v, z = (np.array(inputs), x[:, 1]) if kind == "velocity" else (x[:, 1], x[:, 2])
    F = np.array([force_of(*pair)[1] for pair in zip(v, z, strict=True)])
    return {"t": rows, "y": x[:, 0], "v": v, "z": z, "F": F}
