"""Many trajectories by WebAssembly: single runs in threads, in the arrays of the compiled solver of lanes."""

from __future__ import annotations

from stribeck.machine.system import MachineSystem
from stribeck.simulation import wasm
from stribeck.simulation.lanes import LaneSolver, Outcome, Progress, lane_arrays, one_by_one, outcome
from stribeck.simulation.native import Solving
from stribeck.simulation.promise import Tolerances
from stribeck.simulation.variations import Variations


def lane_solver(equations: MachineSystem, threads: int) -> LaneSolver:
    """The solver that integrates every lane once, each as a single run. The threads take lanes from one queue.

    Raises:
        BuildError: as :func:`stribeck.simulation.wasm.compiled`.
    """
    system = wasm.system_module(equations)
    code, _ = wasm.compiled(system.module)

    def once(lanes: Variations, progress: Progress | None, tolerances: Tolerances | None) -> Outcome:
        arrays, scenario = lane_arrays(lanes, tolerances), lanes.scenario

        def run(lane: int, check_stopped: Progress) -> None:
            def store(solving: Solving) -> None:
                arrays.put(lane, solving.integrate(check_stopped, scenario.solve.max_steps), solving)

            wasm.in_memory(code, system, scenario, arrays.lane(scenario, lane), store)

        one_by_one(run, range(len(lanes)), threads, progress)
        return outcome(arrays)

    return once
