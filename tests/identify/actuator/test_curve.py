"""A Stribeck curve that nobody has seen: fast motion alone, beside noise. Records by SciPy."""

import numpy as np
import pytest
from scipy.integrate import odeint

from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from tests.identify.actuator.recorded import body, logs, record

T, STEEP = 0.005 * np.arange(301), 1e3
LAW = "contacts.guide.law.parameters."
TRUTH = {"bodies.a.mass": 1.0, f"{LAW}F_c": 1.0, f"{LAW}sigma_2": 4.0, f"{LAW}F_s": 1.5, f"{LAW}v_s": 0.004}


def recording(seed, size, noise):
    """A mass that a force moves to and fro, through the curve in some milliseconds."""
    mass, F_c, viscous, F_s, v_s = TRUTH.values()
    push = size * (np.sin(9 * T) + 0.8 * np.sin(5.1 * T + 1) - 0.8 * np.sin(1))

    def rates(x, s):
        v = x[1]
        level = F_c + (F_s - F_c) * np.exp(-min((v / v_s) ** 2, 700.0))
        return [v, (np.interp(s, T, push) - level * 2 / np.pi * np.arctan(STEEP * v) - viscous * v) / mass]

    y = odeint(rates, [0.0, 0.0], T, rtol=1e-9, atol=1e-11, hmax=1e-3)[:, 0]
    y = y + noise * np.random.default_rng(seed).standard_normal(len(T))
    channels = {"a.y": Channel("y", T, y)}, {"loads.push.signal": Channel("u", T, push)}
    return Recording("run", T, *channels, {"bodies.a.initial.y": 0.0, "bodies.a.initial.v": 0.0})


def slide():
    law = {"name": "stribeck", "k_v": STEEP, "parameters": {"F_c": 0.9, "F_s": 1.3, "v_s": 0.02, "sigma_2": 3.5}}
    still = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}
    return {
        "schema": 2, "name": "slide", "bodies": {"a": {"mass": 1.2}}, "contacts": {"guide": {"from": "a", "law": law}},
        "loads": {"push": {"on": "a", "kind": "signal", "signal": still}},
        "solve": {"t_end": float(T[-1])}, "output": {"step": 0.005},
    }  # fmt: skip


def fitted(seed, size, noise):
    sought = tuple(Sought(n, x / 10, 10 * x) for n, x in TRUTH.items())
    return fit_machine(slide(), Logs((recording(seed, size, noise),), sought), starts=1, seed=seed, baselines=False)


@pytest.mark.share(3)
@pytest.mark.parametrize("noise", [1e-3, 1e-5])
def test_a_curve_that_nobody_has_seen_tells_no_F_s(noise):
    """Where F_s reaches F_c and any v_s fits as well, the other valley may not have been visited."""
    result = fitted(2, 8.0, noise)
    F_s, v_s = result["F_s"], result["v_s"]
    assert F_s.state in ("not identifiable", "at least")
    assert v_s.state in ("not identifiable", "at most")
    for name in ("F_c", "F_s", "v_s", "mass"):
        low, high = result[name].interval
        assert low < next(x for n, x in TRUTH.items() if n.endswith(name)) < high
    if F_s.state == "at least":
        assert (F_s.high, v_s.low) == (None, 0.0)


@pytest.mark.thorough
def test_a_machine_that_never_slides_far_shows_one_level(tmp_path):
    """Which of F_c and F_s it is stays open, since v_s does; the reasons say so."""
    law = "contacts.guide.law.parameters."
    bounds = {"F_c": (0.1, 10.0), "F_s": (0.1, 10.0), "v_s": (1e-4, 1.0), "sigma_0": (1e3, 1e6)}
    record(tmp_path / "run.csv", body(amplitude=0.5), noise=3e-7)
    wanted = {f"{law}{name}": {"low": low, "high": high} for name, (low, high) in bounds.items()}
    result = fit_machine(body(amplitude=0.5, F_c=0.7), logs(tmp_path, ["run.csv"], wanted), starts=4, baselines=False)
    reported = {name: result.estimates[f"{law}{name}"] for name in bounds}
    assert {name for name, e in reported.items() if e.identifiable} == {"sigma_0"}
    assert reported["sigma_0"].low < 2e4 < reported["sigma_0"].high
    assert reported["F_c"].why.startswith("no stroke is long or fast enough")
    assert reported["F_s"].why == "v_s is not identifiable: the friction level of slow motion may be F_c"
