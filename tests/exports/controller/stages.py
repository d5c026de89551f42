"""Machines with sampled controllers, as small as they can be."""

from stribeck import Scenario
from tests.machine.machines import law, machine

MOVE = {"kind": "point_to_point", "t": [0.05, 0.2, 0.35], "value": [0.0, 0.02, 0.005]}
SAMPLING = {"period": 1e-3, "delay": 5e-4, "resolution": 1e-6}
WAVE = {"kind": "sine", "amplitude": 0.004, "frequency": 4.0}
RUB = law(sigma_0=1e5, sigma_1=300.0, sigma_2=20.0, F_c=6.0, F_s=9.0, v_s=5e-3, k_v=1e5)
ELASTIC = {
    "name": "elastoplastic_majorant", "k_v": 5e3, "z_ba": 4e-5,
    "parameters": {"sigma_0": 1e5, "sigma_1": 300.0, "sigma_2": 20.0, "F_c": 6.0, "F_s": 9.0, "v_s": 5e-3},
}  # fmt: skip
CASCADE = {"kind": "cascade", "K_p": 30.0, "K_v": 150.0, "T_i": 0.05, "limit": 14.0, "feedforward": {"inertia": 2.0}}
CASES = {
    "measured": {**CASCADE, "compensation": {"contact": "guide", "speed": "measured", "share": 0.8}},
    "led": {**CASCADE, "compensation": {"contact": "guide", "speed": "measured", "share": 0.8, "lead": 1e-3}},
    "reference": {**CASCADE, "compensation": {"contact": "guide", "speed": "reference"}, "signal": WAVE},
    "elastic": {**CASCADE, "compensation": {"speed": "reference", "law": ELASTIC}, "signal": WAVE},
    "dithered": {**CASCADE, "dither": {"amplitude": 5.0, "frequency": 73.0}},
    "square": {
        "kind": "pid", "K_p": 9e3, "K_d": 200.0, "dither": {"kind": "square", "amplitude": 5.0, "frequency": 125.0},
    },
    "filtered": {"kind": "pid", "K_p": 9e3, "K_d": 200.0, "K_i": 2e4, "sampling": {**SAMPLING, "bandwidth": 800.0}},
}  # fmt: skip


def stage(case="measured", **changes):
    """A mass on a guide, with a controller ``axis``; rows at the samples."""
    own = {"on": "a", "measures": "a", "signal": MOVE, "sampling": SAMPLING, **CASES[case], **changes}
    sections = {"contacts": {"guide": {"from": "a", "law": RUB}}, "controllers": {"axis": own}}
    data = machine({"a": {"mass": 2.0}}, 0.4, energy=False, **sections)
    data["name"] = "stage"
    data["output"]["step"] = 1e-3
    return Scenario(data)
