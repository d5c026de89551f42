"""
Drift: held by friction, and yet it creeps
==========================================

The load is below F_s and has a small vibration. With LuGre the body drifts without end. With an elasto-plastic law it returns.
"""

import matplotlib.pyplot as plt

import stribeck

for name, given in {"lugre": {}, "elastoplastic_majorant": {"k_v": 1e7, "z_ba": 9e-6}}.items():
    solution = stribeck.simulate(
        stribeck.Scenario(
            law={"name": name, "parameters": "canudas1995", **given},
            plant={"mass": 1.0},
            drive={"kind": "force", "signal": {"kind": "sine", "offset": 0.5, "amplitude": 0.3, "frequency": 1.0}},
            solve={"t_end": 60.0},
            output={"step": 0.01},
        )
    )
    plt.plot(solution["t"], 1e6 * solution["y"], label=name)
plt.xlabel("time (s)")
plt.ylabel("position (µm)")
plt.legend()

# %%
# .. explorer:: sine_force --law lugre --law elastoplastic_majorant
