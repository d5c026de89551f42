"""Many trajectories by WebAssembly: single runs in threads, in the arrays of the compiled solver of lanes."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import partial
from threading import Event

from stribeck.machine.equations import Equations
from stribeck.simulation import wasm
from stribeck.simulation.lanes import LaneSolver, Outcome, Progress, lane_arrays, outcome
from stribeck.simulation.native import Solving
from stribeck.simulation.promise import Tolerances
from stribeck.simulation.variations import Variations


def lane_solver(equations: Equations, threads: int) -> LaneSolver:
    """The solver that integrates every lane once, each as a single run. The threads take lanes from one queue.

    Raises:
        BuildError: as :func:`stribeck.simulation.wasm.compiled`.
    """
    system = wasm.system_module(equations)
    code, _ = wasm.compiled(system.module)

    def once(lanes: Variations, progress: Progress | None, tolerances: Tolerances | None) -> Outcome:
        arrays, scenario, stopped = lane_arrays(lanes, tolerances), lanes.scenario, Event()

        def check_stopped(share: float) -> None:
            if stopped.is_set():
                raise KeyboardInterrupt

        def run(lane: int, solving: Solving) -> None:
            status = solving.integrate(check_stopped, scenario.solve.max_steps)
            arrays.put(lane, status, solving)

        def start(lane: int) -> None:
            wasm.in_memory(code, system, scenario, arrays.lane(scenario, lane), partial(run, lane))

        with ThreadPoolExecutor(threads) as pool:
            try:
                for done, _ in enumerate(pool.map(start, range(len(lanes)))):
                    if progress is not None:
                        progress((done + 1) / len(lanes))
            except BaseException:
                stopped.set()
                pool.shutdown(cancel_futures=True)
                raise
        return outcome(arrays)

    return once
