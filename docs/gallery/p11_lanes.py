"""
Sixty-four machines at once
===========================

Friction is never known exactly. ``simulate`` runs one scenario for many parameter values, in the processor's vector units.
"""

import matplotlib.pyplot as plt
import numpy as np

import stribeck

scenario = stribeck.Scenario(
    law={"name": "lugre_majorant", "k_v": 1e6, "parameters": "canudas1995"},
    plant={"mass": 1.0},
    drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
    solve={"t_end": 40.0},
    output={"step": 0.02},
)
F_s = np.random.default_rng(1).uniform(1.2, 1.8, 64)
lanes = stribeck.simulate(scenario, {"law.parameters.F_s": F_s})
plt.plot(lanes.t, lanes["y"].T, color="C0", alpha=0.2)
plt.xlabel("time (s)")
plt.ylabel("position (m)")
slips, counts = np.unique(lanes.slips, return_counts=True)
print("lanes by their number of slips:", dict(zip(slips.tolist(), counts.tolist(), strict=True)))

# %%
# .. explorer:: stick_slip --law lugre_majorant
