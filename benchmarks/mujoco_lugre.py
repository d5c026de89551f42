"""MuJoCo's LuGre (the friction of its dcmotor) at fixed steps: how far stick-slip is off, and what it costs.

The scenario is stick-slip over 40 s under lugre, which MuJoCo's element has (the smooth laws it has not). The far end of
the spring is a body so heavy that it keeps its speed; sigma_2 is the joint's damping. The error is that of y, against
this project at tight tolerances, whose own time for MuJoCo's error, and for a far smaller one, stands beside.
"""

from __future__ import annotations

import math
import os
import random
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import figures
import numpy as np
from measure import Seconds, machine, options, say, spread, table, timed, version, write
from numpy.typing import NDArray
from problems import F_C, F_S, MASS, PULLING_SPEED, SIGMA_0, SIGMA_1, SIGMA_2, STICK_SLIP, STIFFNESS, V_S

import stribeck

Array = NDArray[np.float64]

STEPS = (4e-3, 1e-3, 1e-4)  # s
INTEGRATORS = ("Euler", "implicitfast", "RK4")  # Euler is MuJoCo's default
ROWS_EVERY = 0.02  # s: a multiple of all steps and of the scenario's rows
OWN_RTOLS = (1e-2, 1e-6)
REFERENCE_RTOL = 1e-11
MODEL = f"""
<mujoco>
  <option timestep="{{step}}" integrator="{{integrator}}" gravity="0 0 0"><flag contact="disable"/></option>
  <worldbody>
    <body><joint name="far_end" type="slide" axis="1 0 0"/><geom size="0.1" mass="1e12"/></body>
    <body>
      <joint name="body" type="slide" axis="1 0 0" damping="{SIGMA_2}"/><geom size="0.1" mass="{MASS}"/>
    </body>
  </worldbody>
  <tendon>
    <fixed name="spring" stiffness="{STIFFNESS}" springlength="0">
      <joint joint="far_end" coef="1"/><joint joint="body" coef="-1"/>
    </fixed>
  </tendon>
  <actuator>
    <dcmotor joint="body" motorconst="1e-9 1e-9" resistance="1" lugre="{SIGMA_0} {SIGMA_1} {F_C} {F_S} {V_S}"/>
  </actuator>
</mujoco>
"""


@dataclass
class Run:
    """One way to run the scenario, what it costs and how far it is off."""

    name: str
    call: Callable[[], Array] = field(repr=False)
    about: dict[str, Any]
    times: list[Seconds] = field(default_factory=list)
    error: float = math.nan

    def once(self, y: Array) -> None:
        """Run, time, and compare."""
        found: list[Array] = []
        self.times.append(timed(lambda: found.append(self.call())))
        self.error = float(np.max(np.abs(found[0] - y)) / np.max(np.abs(y)))

    def entry(self) -> dict[str, Any]:
        """The line of the results."""
        milliseconds = spread([1e3 * t.cpu for t in self.times])
        return {"solver": self.name, **self.about, "max_error": self.error, "milliseconds": milliseconds}


def mujoco_run(integrator: str, step: float) -> Run:
    """MuJoCo with an integrator and a step."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(MODEL.format(step=step, integrator=integrator))
    times, steps = STICK_SLIP.times, round(ROWS_EVERY / step)
    rows = round(times[-1] / ROWS_EVERY) + 1

    def call() -> Array:
        data, y = mujoco.MjData(model), np.zeros(rows)
        data.qvel[0] = PULLING_SPEED
        for i in range(1, rows):
            mujoco.mj_step(model, data, steps)
            y[i] = data.qpos[1]
        return y

    return Run("MuJoCo", call, {"integrator": integrator, "step_s": step, "steps": steps * (rows - 1)})


def own_scenario(rtol: float) -> stribeck.Scenario:
    """The scenario under lugre."""
    data = STICK_SLIP.scenario.data
    law = {"name": "lugre", "parameters": data["law"]["parameters"]}
    return stribeck.Scenario({**data, "law": law, "solve": {**data["solve"], "rtol": rtol}})


def own_run(rtol: float) -> Run:
    """This project at a tolerance."""
    scenario = own_scenario(rtol).with_changes({"output.step": ROWS_EVERY})
    steps = stribeck.simulate(scenario).stats["accepted"]
    return Run("stribeck", lambda: stribeck.simulate(scenario)["y"], {"rtol": rtol, "steps": steps})


def benchmark(repetitions: int) -> dict[str, Any]:
    """Run all in turn."""
    about_machine = machine()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["STRIBECK_CACHE"] = folder
        scenario = own_scenario(REFERENCE_RTOL).with_changes({"output.step": ROWS_EVERY})
        y = stribeck.simulate(scenario)["y"]
        runs, missing = [own_run(rtol) for rtol in OWN_RTOLS], {}
        try:
            runs += [mujoco_run(integrator, step) for integrator in INTEGRATORS for step in STEPS]
        except (ImportError, OSError, ValueError) as error:
            missing["MuJoCo"] = f"not installed, or it has no such element ({error})"
        for repetition in range(repetitions):
            for run in random.sample(runs, len(runs)):
                run.once(y)
            say(f"repetition {repetition + 1} of {repetitions}")
        lines = [run.entry() for run in runs]
    return {
        "benchmark": "stick-slip under lugre, 40 s: MuJoCo's LuGre at fixed steps",
        "machine": about_machine,
        "mujoco": version("mujoco"),
        "reference": {"solver": f"stribeck at rtol {REFERENCE_RTOL:g}", "y_at_the_end_m": float(y[-1])},
        "runs": lines,
        "not_measured": missing,
    }


def report(results: dict[str, Any]) -> str:
    """The results as plain text."""
    rows = []
    for line in results["runs"]:
        how = f"{line['integrator']}, {1e3 * line['step_s']:g} ms" if "integrator" in line else f"rtol {line['rtol']:g}"
        ms = line["milliseconds"]["median"]
        rows.append((line["solver"], how, f"{line['steps']}", f"{ms:.3g}", f"{line['max_error']:.1e}"))
    missing = "".join(f"{name}: not measured: {reason}\n" for name, reason in results["not_measured"].items())
    return f"{results['benchmark']}\n\n{table(('', 'how', 'steps', 'cpu ms', 'error/range'), rows)}\n{missing}"


def main() -> None:
    """Run the benchmark, print the table, write the results."""
    given = options(__doc__, "mujoco", repetitions=5, quick=1)
    results = benchmark(given.repetitions)
    write(given.out, results)
    figures.draw("mujoco", given.out)
    print(report(results))


if __name__ == "__main__":
    main()
