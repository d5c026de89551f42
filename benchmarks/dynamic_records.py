"""Recordings with known truth for counts on fits by simulation: one body, arms, and machines, with sensors of every kind.

But for the presliding rig, which moves as it is told, motions are SciPy's, of equations written here or in
tests/reference/apart.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import measure  # noqa: F401  (by which tests/ can be imported)
import numpy as np
from scipy.integrate import solve_ivp

import stribeck
from stribeck.identify.plan import motion
from stribeck.identify.synthetic import Experiment, Sensors, experiment
from stribeck.laws import find
from tests.identify import rig
from tests.reference.apart import solve

Draw = np.random.Generator
Constants = dict[str, float]
Sampled = tuple[np.ndarray, np.ndarray, np.ndarray]  # times, what was read, what drove
Record = Callable[[Draw, Constants, float, "Term"], Sampled]


def moved(rates: Callable[..., Any], t: np.ndarray, states: int) -> np.ndarray:
    """The states at the times, from rest; position, speed and the bristles' force first, where there are bristles."""
    atol = np.full(states, 1e-13)
    solution = solve_ivp(rates, (0.0, t[-1]), np.zeros(states), "LSODA", t, rtol=1e-11, atol=atol, max_step=2e-3)
    assert solution.success, solution.message
    return np.asarray(solution.y)


def lugre(p: Constants, v: float, w: float, speed: float) -> tuple[float, float]:
    """dw/dt and the friction of LuGre's law, with w = sigma_0 z; ``speed`` is |v|, or what is smooth in its place."""
    level = p["F_c"] + (p["F_s"] - p["F_c"]) * math.exp(-min((v / p["v_s"]) ** 2, 700.0))
    bends = v - speed * w / level
    return p["sigma_0"] * bends, w + p["sigma_1"] * bends + p["sigma_2"] * v


def waves(draw: Draw, t: np.ndarray, low: float, high: float) -> np.ndarray:
    """Three sines, 0 at first."""
    f, phase = draw.uniform(low, high, 3), draw.uniform(0, 2 * np.pi, 3)
    return np.asarray(sum(np.sin(2 * np.pi * a * t + b) - np.sin(b) for a, b in zip(f, phase, strict=True)))


# -- presliding loops and strokes of a rig ----------------------------------------------------------------------------

RIG_LAWS: dict[str, Constants] = {"lugre": {}, "elastoplastic_majorant": {"k_v": 1e5, "z_ba": 4e-6}}

LOOPS = [rig.loop(size, rate) for size in (8e-6, 2e-5, 6e-5) for rate in (4.0, 20.0)]
# every fourth record leaves something out, so that some constants cannot be determined
PARTIAL = (LOOPS[:4], rig.STROKES, rig.STROKES[-2:])


def presliding(name: str, seed: int) -> Experiment:
    """An encoder of 5 nm and a force with noise of 1 % of the Coulomb friction."""
    draw = np.random.default_rng((seed, sum(name.encode())))
    values = {key: value * float(np.exp(draw.uniform(-0.25, 0.25))) for key, value in rig.TRUTH.items()}
    values["F_s"] = values["F_c"] * float(draw.uniform(1.2, 1.6))
    law = find(name)({**values, **RIG_LAWS[name]})
    sensors = Sensors(position_resolution=5e-9, force_noise=0.01 * values["F_c"])
    tests = [*LOOPS, *rig.STROKES] if seed % 4 != 3 else PARTIAL[seed // 4 % 3]
    number = 1000 * list(RIG_LAWS).index(name) + seed
    return experiment(law, motion(tests, rig.STEP / rig.FINER), sensors, seed=number, every=rig.FINER)


# -- a body under two sines of force ----------------------------------------------------------------------------------

BODY = {"sigma_0": 1e5, "sigma_1": 316.0, "sigma_2": 0.4, "F_c": 1.0, "v_s": 1e-3}  # Canudas de Wit et al. 1995
MASS = 1.1


@dataclass(frozen=True)
class Sensing:
    """How a body's motion is recorded, and what is fitted; SI units.

    Attributes:
        drift: of the position over the record.
        outliers: the share of positions that are wild.
        delay: how late the position is; ``term``: whether the fit looks for it.
    """

    output: str = "position"
    noise: float = 1e-6
    rate: float = 500.0
    seconds: float = 12.0
    quantum: float = 0.0
    force_noise: float = 0.0
    drift: float = 0.0
    outliers: float = 0.0
    delay: float = 0.0
    term: bool = False


def body(how: Sensing, seed: int) -> tuple[dict[str, np.ndarray], Constants]:
    """The columns, and the truth behind them."""
    draw = np.random.default_rng(seed)
    p = {name: value * float(np.exp(draw.uniform(-0.25, 0.25))) for name, value in BODY.items()}
    p["F_s"] = p["F_c"] * float(draw.uniform(1.3, 1.6))
    slow, fast, margin = draw.uniform(0.3, 0.5), draw.uniform(1.3, 1.9), 0.02

    def force(t: Any) -> Any:
        return 2.1 * np.sin(2 * np.pi * slow * t + 0.3) + 0.7 * np.sin(2 * np.pi * fast * t)

    def rates(t: float, x: np.ndarray) -> list[float]:
        dw, friction = lugre(p, x[1], x[2], abs(x[1]))
        return [x[1], (float(force(t)) - friction) / MASS, dw]

    t = np.arange(0, how.seconds, 1 / how.rate)
    y = moved(rates, np.concatenate([[0.0], t + margin - how.delay]), 3)[0][1:]
    y = y + how.noise * draw.standard_normal(len(t)) + how.drift * np.sin(np.pi * t / how.seconds)
    y = np.where(draw.random(len(t)) < how.outliers, y + 1e-3 * draw.standard_normal(len(t)), y)
    y = how.quantum * np.round(y / how.quantum) if how.quantum else y
    measured = force(t + margin) + how.force_noise * draw.standard_normal(len(t))
    return {"t": t, "y": y, "F": measured}, {**p, "mass": MASS, "offset": 0.0, "delay": how.delay}


# -- an arm that more than friction holds back ------------------------------------------------------------------------

HELD = ("sin", "sincos", "torque", "offset", "direction", "spring")


def arm(kind: str, seed: int) -> tuple[dict[str, np.ndarray], Constants]:
    """Columns with a load ``tau`` that is known row by row, and the truth; rad, N m."""
    draw = np.random.default_rng(seed)
    about = {"sigma_0": 300.0, "sigma_1": 1.5, "sigma_2": 0.05, "F_c": 0.3, "v_s": 0.05, "mass": 0.05}
    p = {name: value * float(np.exp(draw.uniform(-0.25, 0.25))) for name, value in about.items()}
    p["F_s"] = p["F_c"] * float(draw.uniform(1.3, 1.6))
    weight = float(np.exp(draw.uniform(-0.25, 0.25)))
    p |= {"offset": 0.0} | {
        "sin": {"gravity_sin": weight},
        "sincos": {"gravity_sin": weight, "gravity_cos": draw.uniform(-0.5, 0.5)},
        "torque": {"area": 1.0},
        "offset": {"gravity_sin": weight, "offset": draw.uniform(-0.2, 0.2)},
        "direction": {"gravity_sin": 0.6 * weight, "sigma_2_by_direction": draw.uniform(0.005, 0.02)},
        "spring": {"stiffness": 1.5 * weight},
    }[kind]
    slow, fast, size, *phase = *draw.uniform([0.4, 1.3, 0.9], [0.7, 2.1, 1.2]), *draw.uniform(0, 6, 4)

    def torque(t: Any) -> Any:
        return size * (np.sin(2 * np.pi * slow * t + phase[0]) + 0.6 * np.sin(2 * np.pi * fast * t + phase[1]))

    def load(t: Any) -> Any:
        return 0.3 * np.sin(2 * np.pi * 0.9 * t + phase[2]) + 0.2 * np.sin(2 * np.pi * 0.23 * t + phase[3])

    def rates(t: float, x: np.ndarray) -> list[float]:
        y, v, w = x
        held = p["offset"] + p.get("gravity_sin", 0.0) * np.sin(y) + p.get("gravity_cos", 0.0) * np.cos(y)
        held += p.get("stiffness", 0.0) * y + p.get("sigma_2_by_direction", 0.0) * abs(v) + p.get("area", 0.0) * load(t)
        dw, friction = lugre(p, v, w, abs(v))
        return [v, (torque(t) - held - friction) / p["mass"], dw]

    t = np.arange(0, 12.0, 1 / 500.0)
    y = moved(rates, t, 3)[0] + 1e-5 * draw.standard_normal(len(t))
    return {"t": t, "y": y, "F": torque(t), "tau": load(t)}, p


# -- machines ---------------------------------------------------------------------------------------------------------

LAW = "contacts.joint.law.parameters."
REST = {"initial": {"y": 0.0, "v": 0.0}}
STILL = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}
MOTOR = {"K": 0.5, "R": 1.0, "L": 0.3}
SERVO_DAMPING = 0.03  # of its bristles, N m s/rad
PLAY, CURRENT_GAIN, MOTOR_MASS, BELT, BELT_DAMPING = 2e-3, 25.0, 1.5, 2e5, 30.0
# terms that a machine's friction lacks, of a share of the friction
LACKS = ("bump", "drag", "position", "load", "direction", "spring", "time", "ripple", "offset", "root")


@dataclass(frozen=True)
class Term:
    """What the truth has and the machine that is fitted has not."""

    what: str = ""
    size: float = 0.0
    v_s: float = 1.0
    phase: float = 0.0
    waves: float = 1.0

    def put(self, data: dict[str, Any], loads: str) -> None:
        """Give it to a machine's file, with the force that ``loads`` its joint."""
        joint, what, size = data["contacts"]["joint"], self.what, self.size
        force = size * joint["law"]["parameters"]["F_c"]
        by_speed = {
            "bump": lambda v: math.exp(-min((v / self.v_s) ** 2, 700.0)) * smooth_sign(v), "drag": lambda v: v * abs(v) / 16,
            "direction": lambda v: abs(smooth_sign(v)), "root": lambda v: smooth_sign(v) * abs(v) ** 0.5,
        }  # fmt: skip
        if what in by_speed:
            data["contacts"]["term"] = {"from": "arm", "law": {"name": lambda v: force * by_speed[what](v)}}
        elif what == "position":
            level = {"amplitude": [size], "waves": [1.0], "phase": [self.phase + math.pi / 2]}
            joint["factors"] = {"level": level}
        elif what == "time":
            joint["factors"] = {"level": {"signal": {**STILL, "t": [0.0, 2.0], "value": [1 - size / 2, 1 + size / 2]}}}
        elif what == "load":
            joint["loads"] = [{"force": loads, "F_c": size}]
        elif what == "spring":
            data["links"] = {**data.get("links", {}), "term": {"from": "arm", "to": "ground", "stiffness": force}}
        elif what == "ripple":
            data["loads"]["term"] = {"on": "arm", "kind": "ripple", "amplitude": [-force], "waves": [self.waves]}
        elif what == "offset":
            data["loads"]["term"] = {"on": "arm", "kind": "signal", "signal": {**STILL, "value": [-force, -force]}}


def smooth_sign(v: float) -> float:
    """The sign of the speed in the machines that lack a term."""
    return 2 / math.pi * math.atan(50.0 * v)


def lacking(draw: Draw, what: str) -> Term:
    """A term of 0.3 to 10 % of the friction; of a load 0.05 to 1 % of it."""
    low, high = (0.0005, 0.01) if what == "load" else (0.003, 0.1)
    size = float(np.exp(draw.uniform(np.log(low), np.log(high)))) * draw.choice([-1.0, 1.0])
    size = abs(size) if what in ("bump", "load", "drag", "root") else size
    v_s = float(np.exp(draw.uniform(np.log(0.05), np.log(1.0))))
    return Term(what, size, v_s, draw.uniform(0, 6), float(draw.integers(5, 30)))


def upright(draw: Draw, truth: Constants, size: float, term: Term) -> Sampled:
    """An arm on its head: a controller sets the voltage, a sample late and straight from sample to sample."""
    step, rows = 0.004, [np.array([0.05, 0.0, 0.0])]
    t, u = step * np.arange(1001), [0.0]
    inertia, gravity, level, viscous = truth.values()

    def rates(s: float, x: np.ndarray, begin: float) -> list[float]:
        y, v, i = x
        volts = u[-2] + (u[-1] - u[-2]) * (s - begin) / step
        friction = level * (2 / math.pi) * math.atan(200 * v) + viscous * v
        pull = MOTOR["K"] * i + gravity * math.sin(y) - friction
        return [v, pull / inertia, (volts - MOTOR["R"] * i - MOTOR["K"] * v) / MOTOR["L"]]

    for now in t[:-1]:
        y, v, _ = rows[-1]
        wanted = 8.0 * (size * (0.25 * np.sin(2.1 * now) + 0.15 * np.sin(5.3 * now)) - y) - 2.0 * v
        u.append(wanted / MOTOR["K"] * MOTOR["R"] + MOTOR["K"] * v)
        end = solve_ivp(rates, (now, now + step), rows[-1], "DOP853", rtol=1e-10, atol=1e-13, args=(now,))
        rows.append(end.y[:, -1])
    return t, np.array(rows)[:, 0], np.array(u)


def servo(draw: Draw, truth: Constants, size: float, term: Term) -> Sampled:
    """A motor with LuGre friction in a sampled loop: an encoder of 4000 steps, a torque that is held, and noise of 0.5 %."""
    names, rows, fine = ("inertia", "F_c", "sigma_2", "F_s", "v_s", "sigma_0"), 4001, 25
    p = {"sigma_1": SERVO_DAMPING, **dict(zip(names, truth.values(), strict=True))}
    step, encoder = 1e-3, 2 * math.pi / 4000
    t, h = step * np.arange(rows), step / fine
    waved = 2.0 * np.sin(2 * np.pi * (0.25 * t + draw.uniform())) + 0.5 * np.sin(2 * np.pi * (0.8 * t + draw.uniform()))
    wanted, gains = waved - waved[0], p["inertia"] * np.array([4800.0, 80.0])
    x, y, u, speed = np.zeros(3), np.zeros(rows), np.zeros(rows), 0.0

    def rates(x: np.ndarray, push: float) -> np.ndarray:
        dw, friction = lugre(p, x[1], x[2], abs(x[1]))
        return np.array([x[1], (push - friction) / p["inertia"], dw])

    for i in range(rows):
        y[i] = encoder * round(x[0] / encoder)
        speed = 0.8 * speed + 0.2 * (y[i] - y[i - 1]) / step if i else 0.0
        u[i] = np.clip(gains @ (wanted[i] - y[i], -speed), -6 * p["F_s"], 6 * p["F_s"])
        for _ in range(fine):
            a = rates(x, u[i])
            b = rates(x + h / 2 * a, u[i])
            c = rates(x + h / 2 * b, u[i])
            x = x + h / 6 * (a + 2 * b + 2 * c + rates(x + h * c, u[i]))
    return t, y, u + 0.005 * p["F_s"] * draw.standard_normal(rows)


def true_file(name: str, truth: Constants, size: float, t: np.ndarray) -> dict[str, Any]:
    """A machine's file with its true constants, and its rows at the times."""
    case = CASES[name]
    changes = {**truth, **case.known(size), "output.step": float(t[1]), "solve.t_end": float(t[-1])}
    return stribeck.Scenario(case.machine).with_changes(changes).data


def pushed_by(u: np.ndarray, t: np.ndarray, data: dict[str, Any]) -> np.ndarray:
    """The position of the joint's body under a push that is straight between samples."""
    data["loads"]["push"]["signal"] = {"kind": "points", "t": t.tolist(), "value": u.tolist()}
    return np.asarray(solve(data, 1e-11)["arm.y"])


def waved(name: str, force: float, low: float, high: float, loads: str = "push") -> Record:
    """Recordings of a machine under three sines of force, at 0.2 kHz."""

    def record(draw: Draw, truth: Constants, size: float, term: Term) -> Sampled:
        t = 0.005 * np.arange(401)
        u, data = force * size * waves(draw, t, low, high), true_file(name, truth, size, t)
        term.put(data, loads)
        return t, pushed_by(u, t, data), u

    return record


def belt(draw: Draw, truth: Constants, size: float, term: Term) -> Sampled:
    """A motor, a belt and a carriage under a position loop; its current has noise of 20 mA."""
    t = 0.004 * np.arange(751)
    a, w = draw.uniform(0.04, 0.08), draw.uniform(0.4, 0.8)
    b, q = draw.uniform(0.01, 0.02), draw.uniform(1.3, 2.2)
    data = true_file("belt", truth, size, t)
    del data["loads"]["push"]
    for name, way, frequency in (("slow", 2 * a, w), ("fast", 2 * b, q)):  # each has half of the loop's gains
        signal = {"kind": "sine", "amplitude": way, "frequency": frequency, "phase": -math.pi / 2, "offset": way}
        data["links"][name] = {"from": {"signal": signal}, "to": "motor", "stiffness": 2000.0, "damping": 60.0}
    columns = solve(data, 1e-11)
    current = (columns["slow.f"] + columns["fast.f"]) / CURRENT_GAIN
    return t, columns["motor.y"], current + 0.02 * draw.standard_normal(len(t))


def joint(draw: Draw, truth: Constants, size: float, term: Term, seconds: float = 2.0) -> Sampled:
    """A rotor and an arm with play between them; the friction on the rotor grows with the gear's torque."""
    t = 0.005 * np.arange(round(seconds / 0.005) + 1)
    u = 3.0 * np.sin(2 * np.pi * (0.8 * t + 3 / seconds * t**2)) * np.cos(2 * np.pi * draw.uniform(0.1, 0.3) * t)
    return t, pushed_by(u, t, true_file("joint", truth, size, t)), u


@dataclass(frozen=True)
class Case:
    """A machine: its file, what is sought with its usual value, what its records are, and how they are fitted."""

    machine: dict[str, Any]
    usual: Constants
    record: Record
    drive: str
    noise: float
    recordings: int = 2
    known: Callable[[float], Constants] = lambda size: {}
    held: bool = False  # the drive between samples


def machine(law: dict[str, Any], bodies: dict[str, Any], end: float, **more: Any) -> dict[str, Any]:
    """A machine whose first body has the joint; ``more`` is what drives and links it."""
    contact = {"from": "arm", "law": law, **more.pop("contact", {})}
    built = {"schema": 2, "name": "case", "bodies": {n: {**REST, **x} for n, x in bodies.items()}}
    return {**built, "contacts": {"joint": contact}, **more, "solve": {"t_end": end}, "output": {"step": 0.004}}


def pushed(on: str = "arm", **more: Any) -> dict[str, Any]:
    """A signal's load on a body, and others."""
    return {"push": {"on": on, "kind": "signal", "signal": STILL}, **more}


def pendulum(amplitude: float, phase: float = 0.0, on: str = "arm") -> dict[str, Any]:
    """The weight of a body that turns."""
    return {"on": on, "kind": "pendulum", "amplitude": amplitude, "phase": phase}


def law(name: str, k_v: float | None, **parameters: float) -> dict[str, Any]:
    """A law's table; without ``k_v``, with |v|."""
    return {"name": name, **({"k_v": k_v} if k_v else {}), "parameters": parameters}


CASES = {
    "arm": Case(
        machine(law("coulomb_viscous", 50.0, F_c=0.12, sigma_2=0.06), {"arm": {"inertia": 0.2}}, 2.0,
                loads=pushed(gravity=pendulum(3.0))),
        {"bodies.arm.inertia": 0.17, "loads.gravity.amplitude": 3.3, f"{LAW}F_c": 0.1, f"{LAW}sigma_2": 0.05},
        waved("arm", 1.33, 0.3, 1.5), "loads.push.signal", 5e-4,
    ),
    "geared": Case(
        machine(law("coulomb_viscous", 50.0, F_c=0.48, sigma_2=0.06), {"arm": {"inertia": 0.025}, "far": {"inertia": 0.06}}, 2.0,
                links={"gear": {"from": "arm", "to": "far", "stiffness": 70.0, "damping": 0.1}},
                loads=pushed(gravity=pendulum(1.0, on="far"))),
        {"bodies.arm.inertia": 0.02, "links.gear.stiffness": 60.0, f"{LAW}F_c": 0.4, f"{LAW}sigma_2": 0.03},
        waved("geared", 0.9, 0.3, 1.5, loads="gear"), "loads.push.signal", 5e-4,
    ),
    "slide": Case(
        machine(law("lugre_majorant", 1e4, sigma_0=2e4, sigma_1=60.0, sigma_2=3.5, F_c=0.9, F_s=1.7, v_s=0.02),
                {"arm": {"mass": 1.2}}, 2.0, loads=pushed()),
        {"bodies.arm.mass": 1.0, f"{LAW}F_c": 1.0, f"{LAW}sigma_2": 4.0, f"{LAW}F_s": 1.7, f"{LAW}v_s": 0.02,
         f"{LAW}sigma_0": 2e4, f"{LAW}sigma_1": 60.0},
        waved("slide", 1.5, 0.5, 2.5), "loads.push.signal", 2e-5,
    ),
    "fast": Case(
        machine(law("stribeck", 1e3, sigma_2=3.5, F_c=0.9, F_s=1.4, v_s=0.02), {"arm": {"mass": 1.2}}, 2.0, loads=pushed()),
        {"bodies.arm.mass": 1.0, f"{LAW}F_c": 1.0, f"{LAW}sigma_2": 4.0, f"{LAW}F_s": 1.6, f"{LAW}v_s": 0.008},
        waved("fast", 3.0, 0.5, 2.5), "loads.push.signal", 3e-4,
    ),
    "upright": Case(
        machine(law("coulomb_viscous", 200.0, F_c=0.3, sigma_2=0.1), {"arm": {"inertia": 0.1, "initial": {"y": 0.05, "v": 0.0}}},
                4.0, loads={"gravity": pendulum(1.0, np.pi)}, motors={"drive": {"on": "arm", **MOTOR, "signal": STILL}}),
        {"bodies.arm.inertia": 0.05, "loads.gravity.amplitude": 2.0, f"{LAW}F_c": 0.15, f"{LAW}sigma_2": 0.03},
        upright, "motors.drive.signal", 5e-4, recordings=1,
    ),
    "servo": Case(
        machine(law("lugre", None, sigma_0=20.0, sigma_1=SERVO_DAMPING, sigma_2=1e-4, F_c=0.02, F_s=0.03, v_s=1.0),
                {"arm": {"inertia": 4e-5}}, 4.0, loads=pushed()),
        {"bodies.arm.inertia": 5e-5, f"{LAW}F_c": 0.02, f"{LAW}sigma_2": 1e-4, f"{LAW}F_s": 0.035, f"{LAW}v_s": 1.0,
         f"{LAW}sigma_0": 15.0},
        servo, "loads.push.signal", 0.0, recordings=1, held=True,
    ),
    "belt": Case(
        machine(law("lugre_majorant", 1e4, sigma_0=2e5, sigma_1=300.0, v_s=0.02, F_c=10.0, F_s=20.0, sigma_2=15.0),
                {"arm": {"mass": 4.0}, "motor": {"mass": MOTOR_MASS}}, 3.0,
                links={"belt": {"from": "motor", "to": "arm", "stiffness": BELT, "damping": BELT_DAMPING}},
                loads={"push": {"on": "motor", "kind": "signal", "gain": CURRENT_GAIN, "signal": STILL}}),
        {"bodies.arm.mass": 4.0, f"{LAW}F_c": 12.0, f"{LAW}sigma_2": 20.0, f"{LAW}F_s": 18.0},
        belt, "loads.push.signal", 1e-5, recordings=1,
    ),
    "joint": Case(
        machine(law("lugre_majorant", 1e3, sigma_0=400.0, sigma_1=1.0, sigma_2=0.03, F_c=0.4, F_s=1.0, v_s=0.3),
                {"arm": {"inertia": 0.02}, "far": {"inertia": 0.06}}, 2.0,
                contact={"loads": [{"force": "gear", "F_c": 0.06}]},
                links={"gear": {"from": "arm", "to": "far", "stiffness": 60.0, "damping": 0.1, "gap": PLAY}},
                loads=pushed(gravity=pendulum(1.0, on="far"))),
        {"bodies.arm.inertia": 0.02, "links.gear.stiffness": 60.0, f"{LAW}F_c": 0.4, f"{LAW}sigma_2": 0.03,
         "contacts.joint.loads.0.F_c": 0.06},
        joint, "loads.push.signal", 5e-4,
        known=lambda size: {"bodies.far.inertia": 0.04 + 0.04 * size, "loads.gravity.amplitude": 2.0 * size},
    ),
}  # fmt: skip
KEPT = tuple(f"{LAW}{n}" for n in ("F_s", "v_s", "sigma_0", "sigma_1"))  # so that F_s stays above F_c


def gaps(t: np.ndarray, y: np.ndarray, u: np.ndarray, draw: Draw) -> Sampled:
    """Six gaps of two to nine samples."""
    keep = np.ones(len(t), bool)
    for first in draw.integers(20, len(t) - 30, 6):
        keep[first : first + draw.integers(2, 10)] = False
    return t[keep], y[keep], u[keep]


def late(t: np.ndarray, y: np.ndarray, u: np.ndarray, draw: Draw) -> Sampled:
    """The encoder's clock is 0.1 % slow."""
    return t, np.interp(t * (1 - 1e-3), t, y), u


FAULTS: dict[str, Callable[[np.ndarray, np.ndarray, np.ndarray, Draw], Sampled]] = {
    "short": lambda t, y, u, draw: (t[: len(t) // 2], y[: len(t) // 2], u[: len(t) // 2]),
    "gaps": gaps, "slow clock": late, "coarse input": lambda t, y, u, draw: (t, y, u),
}  # fmt: skip
