"""A time-optimal move with friction: how fast can a limited force move a body and stop it?

The law is a CasADi function; the problem is discretised by implicit steps (Radau collocation, order 5), which the stiff
bristles need, and solved by IPOPT. Run it: python docs/time_optimal_move.py PICTURE.svg
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.optimize import brentq

import stribeck
from stribeck.exports.python import to_casadi

LAW = {"name": "lugre_majorant", "k_v": 1e4, "parameters": "olsson1998"}  # a DC servo: N m, rad
MASS, LIMIT, DISTANCE = 0.0023, 1.0, 1.0  # kg m^2, N m, rad
law = stribeck.law(LAW["name"], LAW["parameters"], k_v=LAW["k_v"])


@dataclass
class Move:
    """The time in s, and force, angle, speed and deflection at the ends of the intervals."""

    time: float
    t: np.ndarray
    u: np.ndarray
    y: np.ndarray
    v: np.ndarray
    z: np.ndarray


def coulomb_time() -> tuple[float, float]:
    """The fastest move against Coulomb and viscous friction alone, in closed form: its time, and when the force turns."""
    tau, F_c, viscous = MASS / law.p.sigma_2, law.p.F_c, law.p.sigma_2
    top, back = (LIMIT - F_c) / viscous, (LIMIT + F_c) / viscous  # the speeds that either force would reach

    def stop(turn: float) -> tuple[float, float]:
        fast = -top * math.expm1(-turn / tau)
        braking = tau * math.log1p(fast / back)
        return turn + braking, top * turn - back * braking

    turn = brentq(lambda turn: stop(turn)[1] - DISTANCE, 0, 10 * math.sqrt(DISTANCE * MASS / (LIMIT - F_c)))
    return stop(turn)[0], turn


def solve(intervals: int = 60) -> Move:
    """Minimise the time; position, velocity and deflection are scaled to be near 1."""
    friction, scale = to_casadi(law), law.scales(law.p)
    size = ca.DM([DISTANCE, math.sqrt(DISTANCE * LIMIT / MASS), scale.length])
    x, u = ca.MX.sym("x", 3), ca.MX.sym("u")
    _, v, z = ca.vertsplit(x * size)
    rate, force = friction(v, z)
    f = ca.Function("f", [x, u], [ca.vertcat(v, (u - force) / MASS, rate) / size])

    points = ca.collocation_points(3, "radau")
    weights = ca.collocation_coeff(points)[0]
    problem = ca.Opti()
    time, forces = problem.variable(), problem.variable(intervals)
    step, start, ends = time / intervals, ca.DM([0, 0, 0]), []
    guess, turn = coulomb_time()
    turn /= guess
    for k in range(intervals):
        inner = problem.variable(3, 3)
        rates = ca.horzcat(*(f(inner[:, j], forces[k]) for j in range(3)))
        problem.subject_to(ca.vec(ca.horzcat(start, inner) @ weights - step * rates) == 0)
        share = (k + 1) / intervals
        speed = share / turn if share < turn else (1 - share) / (1 - turn)
        problem.set_initial(inner, ca.repmat(ca.DM([share, speed, 0.6]), 1, 3))
        problem.set_initial(forces[k], LIMIT if share < turn else -LIMIT)
        start = inner[:, 2]
        ends.append(start)
    problem.subject_to(problem.bounded(-LIMIT, forces, LIMIT))
    problem.subject_to(start[:2] == ca.DM([1, 0]))
    problem.subject_to(time >= 0.1 * guess)
    problem.set_initial(time, guess)
    problem.minimize(time)
    problem.solver("ipopt", {"print_time": False, "expand": True}, {"print_level": 0, "sb": "yes", "max_iter": 500})
    found = problem.solve()
    states = np.hstack([np.zeros((3, 1)), found.value(ca.horzcat(*ends))]) * np.array(size)
    total = float(found.value(time))
    return Move(total, np.linspace(0, total, intervals + 1), np.array(found.value(forces)), *states)


def simulate(move: Move) -> stribeck.Solution:
    """The same force in Stribeck's own simulation."""
    t, value = np.repeat(move.t, 2)[1:-1], np.repeat(move.u, 2)
    signal = {"kind": "points", "t": t.tolist(), "value": value.tolist()}
    scenario = stribeck.Scenario(
        law=LAW, plant={"mass": MASS}, drive={"kind": "force", "signal": signal},
        solve={"t_end": move.time}, output={"step": move.time / 400},
    )  # fmt: skip
    return stribeck.simulate(scenario)


if __name__ == "__main__":
    move = solve()
    solution = simulate(move)
    print(f"fastest move {move.time:.4f} s; against Coulomb and viscous friction alone {coulomb_time()[0]:.4f} s")
    print(f"simulated with that force: y = {solution['y'][-1]:.6f} rad, v = {solution['v'][-1]:.2e} rad/s at the end")
    if len(sys.argv) > 1:
        from matplotlib import pyplot

        figure, axes = pyplot.subplots(3, 1, figsize=(5.2, 5), sharex=True, layout="constrained")
        axes[0].stairs(move.u, move.t, color="C3", baseline=None, label="torque")
        axes[0].plot(solution.t, solution["F"], color="C0", label="friction")
        axes[0].set_ylabel("torque, friction (N m)", fontsize=9)
        axes[0].legend(frameon=False)
        for axis, name, unit in ((axes[1], "y", "rad"), (axes[2], "v", "rad/s")):
            axis.plot(solution.t, solution[name], label="simulated")
            axis.plot(move.t, getattr(move, name), ".", color="C3", label="optimised")
            axis.set_ylabel(f"{name} ({unit})")
        axes[1].legend(frameon=False)
        axes[2].set_xlabel("t (s)")
        figure.savefig(sys.argv[1])
