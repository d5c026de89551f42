"""An axis with friction compensation: errors after reversals, and what too large a compensation does."""

from __future__ import annotations

import numpy as np

from examples.paper.common import Chapter, Done, Printed, finish
from stribeck.errors import StribeckError
from stribeck.loops.compensation import with_compensation
from stribeck.loops.excess import Excess, excess
from stribeck.loops.uncertainty import friction_intervals, friction_samples
from stribeck.mouth import plots
from stribeck.mouth.document import Table
from stribeck.scenario import Scenario
from stribeck.simulation import Solution, simulate

_LAW = {
    "name": "lugre",
    "parameters": {"sigma_0": 8e5, "sigma_1": 2500.0, "sigma_2": 40.0, "F_c": 14.0, "F_s": 20.0, "v_s": 5e-3},
}
_WORDS = {
    "none": "none",
    "reference": "feedforward at the reference's speed",
    "measured": "the law at the measured speed",
}
_FREQUENCY, _WAVES = 1.0, 2
_SHARE = 0.8


def _machine() -> dict[str, object]:
    """A slide of 8 kg on a guide, under a sampled controller with an encoder of a micrometer."""
    return {
        "schema": 2, "name": "slide",
        "bodies": {"slide": {"mass": 8.0}},
        "contacts": {"guide": {"from": "slide", "law": _LAW}},
        "controllers": {"axis": {
            "kind": "cascade", "on": "slide", "measures": "slide", "K_p": 40.0, "K_v": 1200.0, "limit": 400.0,
            "signal": {"kind": "sine", "amplitude": 0.02, "frequency": _FREQUENCY}, "feedforward": {"inertia": 8.0},
            "sampling": {"period": 5e-4, "delay": 2.5e-4, "resolution": 1e-6},
        }},
        "solve": {"t_end": _WAVES / _FREQUENCY, "rtol": 1e-6}, "output": {"step": 1e-3},
    }  # fmt: skip


def chapter(done: Done) -> Chapter:
    """The same axis without compensation and with two kinds of it."""
    scenario = Scenario(_machine())
    runs = {kind: _run(with_compensation(scenario, "axis", "guide", kind, _SHARE)) for kind in _WORDS}
    worst = {kind: _worst(run) for kind, run in runs.items()}
    over = excess(scenario, "axis", friction_samples(friction_intervals(scenario, None)))
    um = {kind: f"{1e6 * x:.3g} µm" for kind, x in worst.items()}
    text = (
        "A slide of 8 kg on a guide follows a sine under a sampled controller. Friction changes its sign at each reversal, and "
        f"the error reaches {um['none']} within an eighth of a period. Feedforward of {100 * _SHARE:g} % of the law's steady "
        f"curve at the reference's speed reduces it to {um['reference']}. The law as an observer at the measured speed reduces "
        f"it to {um['measured']}.",
        "A compensation that exceeds the friction drives the slide. If every friction parameter may be wrong by a tenth, this "
        f"begins at a share of {over.worst_share:.3g} at the measured speed. With a share 5 % larger and the controller off, "
        f"the slide accelerates from {1e3 * over.speed:.3g} to {1e3 * over.ends:.3g} mm/s.",
    )
    rows = [[_WORDS[kind], f"{1e6 * x:.3g}", f"{worst['none'] / x:.2f}"] for kind, x in worst.items()]
    table = Table(["compensation", "largest error after a reversal (µm)", "reduced by a factor of"], rows)
    numbers = {"worst": worst, "over_compensation": over.row()}
    return Chapter("axis", "An axis with friction compensation", text, [table], [_figure(runs, over)], numbers)


def _run(scenario: Scenario) -> Solution:
    solution = simulate(scenario)
    if solution.reason:
        raise StribeckError(f"the axis failed: {solution.reason}")
    return solution


def _worst(run: Solution) -> float:
    """The largest error within an eighth of a period after a reversal, from the first on."""
    phase = (run.t * _FREQUENCY - 0.25) % 0.5
    after = (phase <= 0.125) & (run.t * _FREQUENCY >= 0.25)
    return float(np.abs(run["axis.r"] - run["slide.y"])[after].max())


def _figure(runs: dict[str, Solution], over: Excess) -> Printed:
    with plots.style():
        built, axes = plots.figure([["error", "over"]], 3.0)
        for i, (kind, run) in enumerate(runs.items(), start=1):
            plots.line(axes["error"], i, run.t, 1e6 * (run["axis.r"] - run["slide.y"]), _WORDS[kind])
        axes["error"].set(xlabel="t (s)", ylabel="error (µm)", title="tracking error")
        axes["error"].legend(fontsize=7)
        if over.counterexample is not None:
            run = _run(over.counterexample)
            plots.line(axes["over"], 1, run.t, 1e3 * run["slide.v"], "")
        axes["over"].set(xlabel="t (s)", ylabel="speed (mm/s)", title="over-compensation, controller off")
        return finish(
            built,
            "axis",
            "Left: the error without and with compensation. Right: a share 5 % above the largest safe one.",
        )
