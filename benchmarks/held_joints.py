"""A joint held at 0.9 F_s in PyTorch, JAX and Warp at steps of 2 to 20 ms: how far it creeps in the last half of the time, the
bound, and each package's gradients against central differences.

    python benchmarks/held_joints.py [--seconds 100] [--turns 100]
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import numpy as np
import torch
import warp as wp
from measure import RESULTS, machine, say

import stribeck
from stribeck.exports.python import to_jax, to_torch, to_warp

jax.config.update("jax_enable_x64", True)
SET = {"sigma_0": 1e5, "sigma_1": 316.0, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3, "k_v": 1e7}
STEPS = (2e-3, 5e-3, 1e-2, 2e-2)
SHARE = 0.9
LAWS = {
    "elastoplastic": ({**SET, "z_ba": 9.5e-6}, 0.0),
    "elastoplastic_majorant": ({**SET, "z_ba": 9.5e-6}, 2 / np.pi / SET["k_v"] * SHARE / (1 - SHARE)),  # m(0) r/(1 - r)
}
Step = Callable[..., tuple[Any, Any]]  # z, v, effort, dt, one number a joint -> z, friction


def in_jax(law: Any, dt: float, count: int) -> list[float]:
    """Positions after half of the steps and after all."""
    tool = to_jax(law)

    def advance(k: Any, state: tuple[Any, Any, Any]) -> tuple[Any, Any, Any]:
        z, v, q = state
        effort = SHARE * SET["F_s"] * jax.numpy.minimum(k * dt, 1.0)
        z, friction = tool.step(z, v, effort, 1.0, dt)
        v = v + dt * (effort - friction)
        return z, v, q + dt * v

    run = jax.jit(lambda first, last, state: jax.lax.fori_loop(first, last, advance, state))
    half = run(0, count // 2, (0.0, 0.0, 0.0))
    return [float(half[2]), float(run(count // 2, count, half)[2])]


def in_turns(step: Step, seconds: float) -> list[list[float]]:
    """The same for every length of a step at once, a step after the other."""
    z = v = q = np.zeros(len(STEPS))
    dt, counts, found = np.array(STEPS), [round(seconds / dt) for dt in STEPS], [[0.0, 0.0] for _ in STEPS]
    for k in range(max(counts)):
        effort = SHARE * SET["F_s"] * np.minimum(k * dt, 1.0)
        z, friction = step(z, v, effort, dt)
        v = v + dt * (effort - friction)
        q = q + dt * v
        for i, count in enumerate(counts):
            if k + 1 in (count // 2, count):
                found[i][k + 1 == count] = float(q[i])
    return found


def torch_step(law: Any) -> Step:
    """PyTorch's step on numbers of NumPy."""
    tool = to_torch(law)

    def step(*given: Any) -> tuple[Any, Any]:
        z, v, effort, dt = map(torch.from_numpy, given)
        z_, friction = tool.step(z, v, effort, 1.0, dt)
        return z_.numpy(), friction.numpy()

    return step


def warp_step(law: Any) -> Step:
    """Warp's kernel on numbers of NumPy."""
    tool = to_warp(law, "double")

    def step(*given: Any) -> tuple[Any, Any]:
        z, v, effort, dt = (wp.array(x, dtype=tool.real) for x in given)
        z_, friction = tool.step(z, v, effort, wp.array(np.ones(len(dt)), dtype=tool.real), dt)
        return z_.numpy(), friction.numpy()

    return step


def gradients(law: Any, dt: float) -> dict[str, float]:
    """The largest difference of d(z + friction) by z, v and effort from central differences, as parts of the largest slope."""
    random = np.random.default_rng(1)
    z = random.uniform(-0.5, 0.5, 64) * SET["F_s"] / SET["sigma_0"]
    given = [z, random.uniform(-5, 5, 64) * SET["v_s"], random.uniform(-1.2, 1.2, 64) * SET["F_s"]]
    tools = {"torch": to_torch(law), "jax": to_jax(law), "warp": to_warp(law, "double")}
    jax_tool, found = tools["jax"], {}
    sizes = (1e-4 * SET["F_s"] / SET["sigma_0"], 1e-4 * SET["v_s"], 1e-4 * SET["F_s"])
    ones = np.ones(64)

    def total(*x: Any) -> Any:
        z_, friction = jax_tool.step(*x, ones, dt * ones)
        return z_ + friction

    wanted = []
    for i, size in enumerate(sizes):
        ends = [[x + sign * size * (i == j) for j, x in enumerate(given)] for sign in (1, -1, 2, -2)]
        a, b, c, d = (np.asarray(total(*end)) for end in ends)
        wanted.append((8 * (a - b) - (c - d)) / (12 * size))  # of fourth order
    for name, tool in tools.items():
        if name == "torch":
            x = [torch.tensor(g, requires_grad=True) for g in given]
            z_t, friction_t = tool.step(*x, 1.0, dt)
            (z_t + friction_t).sum().backward()
            slopes = [np.asarray(y.grad) for y in x]
        elif name == "jax":
            slopes = list(map(np.asarray, jax.grad(lambda *y: total(*y).sum(), (0, 1, 2))(*given)))
        else:
            x = [wp.array(g, dtype=tool.real, requires_grad=True) for g in (*given, ones, dt * ones)]
            with wp.Tape() as tape:
                z_w, friction_w = tool.step(*x)
            tape.backward(grads={z_w: wp.array(ones, dtype=tool.real), friction_w: wp.array(ones, dtype=tool.real)})
            slopes = [y.grad.numpy() for y in x[:3]]
        off = [np.sort(abs(s - w) / np.max(abs(w))) for s, w in zip(slopes, wanted, strict=True)]
        found[name] = {
            "all_finite": all(np.all(np.isfinite(s)) for s in slopes),
            "median": float(max(map(np.median, off))),
        }
        found[name]["largest"] = float(max(o[-1] for o in off))
    return found


def main() -> None:
    """Print a line a law and step, and write the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=100.0)
    parser.add_argument("--turns", type=float, default=100.0, help="s, in PyTorch and Warp, a step after the other")
    parser.add_argument("--out", type=Path, default=RESULTS / "held_joints.json")
    given = parser.parse_args()
    wp.config.quiet = True
    torch.set_num_threads(1)
    rows = []
    for name, (constants, bound) in LAWS.items():
        law = stribeck.law(name, {n: x for n, x in constants.items() if n in stribeck.laws.builtin()[name].constants()})
        held = {way: in_turns(step(law), given.turns) for way, step in (("torch", torch_step), ("warp", warp_step))}
        held["jax"] = [in_jax(law, dt, round(given.seconds / dt)) for dt in STEPS]
        for i, dt in enumerate(STEPS):
            row: dict[str, Any] = {"law": name, "step": dt, "bound": bound, "gradients": gradients(law, dt)}
            for way, found in held.items():
                seconds = given.seconds if way == "jax" else given.turns
                row[way] = {"creep": (found[i][1] - found[i][0]) / (seconds / 2), "seconds": seconds}
            rows.append(row)
            say(json.dumps(row))
    given.out.write_text(json.dumps({"machine": machine(), "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
