"""A controller that samples at 4 kHz against the same machine under the continuous controller: the ratio of their runs."""

from __future__ import annotations

import tomllib
from copy import deepcopy
from functools import partial
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from measure import Given, in_turn, run, spread

from stribeck import Scenario, simulate
from stribeck.examples import path

PERIOD, DELAY = 2.5e-4, 1e-4  # s: 4 kHz
ENCODERS = {"ideal": None, "2^17 counts a turn": 2 * pi / 2**17, "2^12 counts a turn": 2 * pi / 2**12}
MACHINES = Path(__file__).parents[2] / "shared" / "scenarios" / "machines"  # more of them, where they are


def files() -> dict[str, dict[str, Any]]:
    """Machines that turn and have a motor with an encoder."""
    more = [MACHINES / f"{name}.toml" for name in ("servo_sampled", "servo_cascade")]
    return {p.stem: tomllib.loads(p.read_text()) for p in (path("arm"), *more) if p.is_file()}


def ways(data: dict[str, Any]) -> dict[str, Scenario]:
    """The machine under its controller as if it never sampled, and at 4 kHz with each encoder."""
    result = {}
    for name, counts in {"continuous": None, **ENCODERS}.items():
        given = deepcopy(data)
        sampling = {"period": PERIOD, "delay": DELAY} | ({} if counts is None else {"resolution": counts})
        for controller in given["controllers"].values():
            controller.pop("sampling", None)
            if name != "continuous":
                controller["sampling"] = sampling
        result[name] = Scenario(given)
    return result


def servo() -> dict[str, Scenario]:
    """The pneumatic servo, whose cascade knows no encoder."""
    plain = Scenario.load(path("servo"))
    return {"continuous": plain, "ideal": plain.with_changes({"drive.sample_time": PERIOD})}


def measured(name: str, scenarios: dict[str, Scenario], repetitions: int) -> list[dict[str, Any]]:
    """Each way in its turn; ratios to the continuous one are taken within a repetition."""
    steps = {way: simulate(scenario).stats["accepted"] for way, scenario in scenarios.items()}
    taken = in_turn({way: partial(simulate, scenario) for way, scenario in scenarios.items()}, repetitions)
    seconds = {way: np.array([s.cpu for s in x]) for way, x in taken.items()}
    return [
        {"machine": name, "encoder": way, "steps": steps[way], "seconds": spread(x.tolist()),
         "ratio": spread((x / seconds["continuous"]).tolist())}
        for way, x in seconds.items()
    ]  # fmt: skip


def benchmark(given: Given) -> dict[str, Any]:
    """Every machine."""
    rows = [row for name, data in files().items() for row in measured(name, ways(data), given.repetitions)]
    rows += measured("servo", servo(), given.repetitions)
    return {"rows": rows}


if __name__ == "__main__":
    run(benchmark, __doc__, "sampled", repetitions=(31, 3))
