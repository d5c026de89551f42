"""From a log to the controller's C, for three axes: log, fit, design, export, and the closed loop before and after.

    python docs/axes/axes.py [NAME ...] [--out DIR]

The logs are simulated: the machine moves to and fro under its controller, and position, speed and force are kept with
noise. The fit sees nothing else; the design starts from what was fitted; the loops before and after are of the machine with
its true friction.
"""

from __future__ import annotations

import argparse
import json
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
from machines import MACHINES

import stribeck
from stribeck.loops.written import best

FITTED = ("F_c", "F_s", "v_s", "sigma_2")


def log(machine: dict[str, Any], seed: int = 1) -> dict[str, np.ndarray]:
    """What is recorded while the axis goes to and fro, slowly and fast: time, position, speed, force."""
    data, (name, each) = deepcopy(machine), next(iter(machine["controllers"].items()))
    body, signal = each["measures"], each["signal"]
    reach = max(map(abs, signal["value"]))
    fast = reach / (signal["t"][1] - signal["t"][0])
    t, value, at = [0.0], [0.0], 0.0
    for speed in fast * np.array([0.003, 0.006, 0.012, 0.025, 0.05, 0.1, 0.2, 0.4, 0.8, 1.2]):
        for direction in (1, -1):
            length = min(0.5 * reach, speed * 0.6)
            at += direction * length
            t.append(t[-1] + length / speed)
            value.append(at)
    control = data["controllers"][name]
    control["signal"] = {"kind": "points", "t": t, "value": value}
    control.pop("feedforward", None)
    data["solve"]["t_end"], data["output"]["step"] = t[-1], 1e-3
    run, noise = stribeck.simulate(stribeck.Scenario(data)), np.random.default_rng(seed)
    v, u = np.asarray(run[f"{body}.v"]), np.asarray(run[f"{name}.u"])
    return {
        "t": np.asarray(run.t), "y": np.asarray(run[f"{body}.y"]), "v": v + 1e-4 * fast * noise.standard_normal(len(v)),
        "u": u + 2e-3 * np.abs(u).max() * noise.standard_normal(len(u)),
    }  # fmt: skip


def fitted(machine: dict[str, Any], recorded: dict[str, np.ndarray], out: Path) -> tuple[dict[str, Any], Path]:
    """The machine with the friction that the log tells, and the file of its intervals."""
    contact = next(iter(machine["contacts"]))
    found = stribeck.fit(recorded, "stribeck", time="t", position="y", velocity="v", force="u", mass=_inertia(machine))
    told = {n: found.estimates[n].to_dict() for n in FITTED if found.estimates[n].identifiable}
    data = deepcopy(machine)
    numbers = data["contacts"][contact]["law"]["parameters"]
    numbers |= {n: float(found.values[n]) for n in FITTED}  # the fitted curve's, where the log leaves one open
    numbers["F_s"] = max(numbers["F_s"], numbers["F_c"])
    numbers["sigma_0"], numbers["sigma_1"] = 0.7 * numbers["sigma_0"], 0.7 * numbers["sigma_1"]  # not measured: a guess
    file = out / "parameters.toml"
    rows = [
        f'[parameters."contacts.{contact}.law.parameters.{n}"]\nlow = {max(x["low"] or 0.0, 1e-12)!r}\nhigh = {x["high"]!r}\n'
        for n, x in told.items() if x["low"] is not None and x["high"] is not None
    ]  # fmt: skip
    file.write_text("\n".join(rows))
    return data, file


def _inertia(machine: dict[str, Any]) -> float:
    """Of all bodies as the first one feels it."""
    bodies, ratio = machine["bodies"], next(iter(machine["links"].values())).get("ratio", 1.0)
    first, second = (body.get("mass", body.get("inertia")) for body in bodies.values())
    return float(first + second * ratio**2)


def loop(machine: dict[str, Any], compensation: dict[str, Any] | None) -> tuple[np.ndarray, np.ndarray]:
    """Time and error of the machine's own move."""
    data, name = deepcopy(machine), next(iter(machine["controllers"]))
    if compensation is not None:
        data["controllers"][name]["compensation"] = compensation
    run = stribeck.simulate(stribeck.Scenario(data))
    body = data["controllers"][name]["measures"]
    return np.asarray(run.t), np.asarray(run[f"{name}.r"]) - np.asarray(run[f"{body}.y"])


def show(name: str, out: Path, quick: bool = False) -> dict[str, float]:
    """All of it for one axis; what came of it."""
    out.mkdir(parents=True, exist_ok=True)
    machine = MACHINES[name]()
    known, intervals = fitted(machine, log(machine), out)
    controller, contact = next(iter(known["controllers"])), next(iter(known["contacts"]))
    compensation: dict[str, Any] = {"speed": "reference", "law": known["contacts"][contact]["law"], "share": 1.0}
    verdict = ""
    if not quick:
        found = stribeck.design(stribeck.Scenario(known), compensate=True, uncertainty=intervals)
        chosen, verdict = best(found), found.verdict
        if chosen is not None and chosen.kind != "none":
            compensation = chosen.loop.scenario.data["controllers"][controller]["compensation"] | {
                "share": chosen.share
            }
    known["controllers"][controller]["compensation"] = compensation
    stribeck.export(None, "c", out / "c", part="controller", scenario=stribeck.Scenario(known), self_test=True)
    (t, before), (_, after) = loop(machine, None), loop(machine, compensation)
    picture(name, t, before, after, out / f"{name}.svg")
    rms = [float(np.sqrt(np.mean(e**2))) for e in (before, after)]
    result = {
        "rms_before": rms[0],
        "rms_after": rms[1],
        "peak_before": float(abs(before).max()),
        "peak_after": float(abs(after).max()),
    }
    (out / "result.json").write_text(
        json.dumps({**result, "verdict": verdict, "compensation": compensation}, indent=1) + "\n"
    )
    print(f"{name}: rms error {rms[0]:.3g} before, {rms[1]:.3g} after ({rms[0] / rms[1]:.1f} times less)")
    return result


def picture(name: str, t: np.ndarray, before: np.ndarray, after: np.ndarray, file: Path) -> None:
    """The errors of both loops."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axis = plt.subplots(figsize=(6.4, 3.0), layout="constrained")
    axis.plot(t, before, color="#D55E00", label="before")
    axis.plot(t, after, color="#0072B2", label="after")
    rotary = name == "joint"
    axis.set(
        xlabel="t in s", ylabel=f"error in {'rad' if rotary else 'm'}", title=f"{name}: the same move, before and after"
    )
    axis.legend(frameon=False)
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def main() -> None:
    """All of them, or those named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=list(MACHINES))
    parser.add_argument("--out", type=Path, default=Path("axes"))
    parser.add_argument("--quick", action="store_true", help="take the feedforward without comparing")
    options = parser.parse_args()
    for name in options.names:
        show(name, options.out / name, options.quick)


if __name__ == "__main__":
    main()
