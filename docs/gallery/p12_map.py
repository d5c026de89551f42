"""
Where does stick-slip end?
==========================

If the spring is stiff enough or pulls fast enough, the body slides without sticking. A map over both parameters shows where.
"""

import matplotlib.pyplot as plt
import numpy as np

import stribeck

scenario = stribeck.Scenario(
    law={"name": "lugre_majorant", "k_v": 1e6, "parameters": "canudas1995"},
    plant={"mass": 1.0},
    drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
    solve={"t_end": 60.0},
    output={"step": 0.1},
)
speed, stiffness = np.geomspace(0.02, 0.5, 12), np.geomspace(0.5, 50.0, 12)
a, b = (x.ravel() for x in np.meshgrid(speed, stiffness))
lanes = stribeck.simulate(scenario, {"drive.signal.rate": a, "drive.stiffness": b})
slips = np.array(lanes.slips).reshape(len(stiffness), len(speed))
plt.pcolormesh(speed, stiffness, slips, shading="nearest")
plt.xscale("log")
plt.yscale("log")
plt.xlabel("speed (m/s)")
plt.ylabel("stiffness (N/m)")
plt.colorbar(label="slips in 60 s")

# %%
# .. explorer:: stick_slip --law lugre_majorant
