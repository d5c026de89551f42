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

jax.config.update("jax_enable_x64", True)
SET = {"sigma_0": 1e5, "sigma_1": 316.0, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3, "k_v": 1e7}
STEPS = (2e-3, 5e-3, 1e-2, 2e-2)
SHARE = 0.9
LAWS = {
    "elastoplastic": ({**SET, "z_ba": 9.5e-6}, 0.0),
    "elastoplastic_majorant": ({**SET, "z_ba": 9.5e-6}, 2 / np.pi / SET["k_v"] * SHARE / (1 - SHARE)),  # m(0) r/(1 - r)
}
Step = Callable[[Any, Any, float, float], tuple[Any, Any]]  # z, v, effort, dt -> z, friction


def load(k: int, dt: float) -> float:
    """The effort: put on within a second."""
    return SHARE * SET["F_s"] * min(k * dt, 1.0)


def in_jax(law: Any, dt: float, count: int) -> list[float]:
    """Positions after half of the steps and after all."""
    tool = law.to_jax()

    def advance(k: Any, state: tuple[Any, Any, Any]) -> tuple[Any, Any, Any]:
        z, v, q = state
        effort = SHARE * SET["F_s"] * jax.numpy.minimum(k * dt, 1.0)
        z, friction = tool.step(z, v, effort, 1.0, dt)
        v = v + dt * (effort - friction)
        return z, v, q + dt * v

    run = jax.jit(lambda first, last, state: jax.lax.fori_loop(first, last, advance, state))
    half = run(0, count // 2, (0.0, 0.0, 0.0))
    return [float(half[2]), float(run(count // 2, count, half)[2])]


def in_turns(step: Step, zero: Any, dt: float, count: int) -> list[float]:
    """The same, a step after the other."""
    z, v, q, found = zero, zero, 0.0, []
    for k in range(count):
        effort = load(k, dt)
        z, friction = step(z, v, effort, dt)
        v = v + dt * (effort - friction)
        q += dt * float(v[0])
        if k + 1 in (count // 2, count):
            found.append(q)
    return found


def warp_step(law: Any) -> Step:
    """Warp's kernel on numbers of NumPy."""
    tool = law.to_warp("double")

    def step(z: Any, v: Any, effort: float, dt: float) -> tuple[Any, Any]:
        given = [wp.array(np.broadcast_to(x, (1,)).astype(float), dtype=tool.real) for x in (z, v, effort, 1.0, dt)]
        z_, friction = tool.step(*given)
        return z_.numpy(), friction.numpy()

    return step


def gradients(law: Any, dt: float) -> dict[str, float]:
    """The largest difference of d(z + friction) by z, v and effort from central differences, as parts of the largest slope."""
    random = np.random.default_rng(1)
    z = random.uniform(-0.5, 0.5, 64) * SET["F_s"] / SET["sigma_0"]
    given = [z, random.uniform(-5, 5, 64) * SET["v_s"], random.uniform(-1.2, 1.2, 64) * SET["F_s"]]
    tools = {"torch": law.to_torch(), "jax": law.to_jax(), "warp": law.to_warp("double")}
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
    parser.add_argument(
        "--turns", type=float, help="how long in PyTorch and Warp, which take a step after the other, s"
    )
    parser.add_argument("--out", type=Path, default=RESULTS / "held_joints.json")
    given = parser.parse_args()
    wp.config.quiet = True
    rows = []
    for name, (constants, bound) in LAWS.items():
        law = stribeck.law(name, {n: x for n, x in constants.items() if n in stribeck.laws.builtin()[name].constants()})
        tool = law.to_torch()
        ways: dict[str, Callable[[float, int], list[float]]] = {
            "jax": lambda dt, n, law=law: in_jax(law, dt, n),
            "torch": lambda dt, n, tool=tool: in_turns(
                lambda z, v, e, h: tool.step(z, v, e, 1.0, h), torch.zeros(1, dtype=torch.float64), dt, n
            ),
            "warp": lambda dt, n, law=law: in_turns(warp_step(law), np.zeros(1), dt, n),
        }
        for dt in reversed(STEPS):
            row: dict[str, Any] = {"law": name, "step": dt, "bound": bound, "gradients": gradients(law, dt)}
            for way, held in ways.items():
                seconds = given.seconds if way == "jax" else given.turns or given.seconds
                half, whole = held(dt, round(seconds / dt))
                row[way] = {"creep": (whole - half) / (seconds / 2), "seconds": seconds}
                say(f"{name}, {dt:g} s, {way}: {row[way]}")
            rows.append(row)
            say(json.dumps(row))
    given.out.write_text(json.dumps({"machine": machine(), "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
