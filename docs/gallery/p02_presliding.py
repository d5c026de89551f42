"""
Presliding: a contact is a spring before it slides
==================================================

Below break-away the bristles bend. Friction then depends on position and not on speed, and its loop is a hysteresis.
"""

import matplotlib.pyplot as plt

import stribeck

for amplitude in (0.8, 1.2, 1.425):
    solution = stribeck.simulate(
        stribeck.Scenario(
            law={"name": "lugre_majorant", "k_v": 1e7, "parameters": "canudas1995"},
            plant={"mass": 1.0},
            drive={"kind": "force", "signal": {"kind": "sine", "amplitude": amplitude, "frequency": 0.05}},
            solve={"t_end": 60.0},
            output={"step": 0.01},
        )
    )
    plt.plot(1e6 * solution["y"], solution["F"], label=f"{amplitude} N")
plt.xlabel("position (µm)")
plt.ylabel("friction (N)")
plt.legend(title="amplitude")

# %%
# .. explorer:: presliding --law lugre --law elastoplastic_majorant
