"""
Break-away force against the rate of the force
==============================================

A force ramp pushes a body at rest until it slips. The faster the force rises, the lower is the break-away force,
because the bristles need time to bend.
"""

import matplotlib.pyplot as plt
import numpy as np

import stribeck

scenario = stribeck.Scenario(
    law={"name": "lugre", "parameters": "canudas1995"},
    plant={"mass": 1.0},
    drive={"kind": "force", "signal": {"kind": "ramp", "rate": 1.0}},
    solve={"t_end": 2.0},
    output={"step": 0.001},
)
rates = np.geomspace(1.0, 50.0, 12)
levels = []
for rate in rates:
    changes = {"drive.signal.rate": float(rate), "solve.t_end": 3.0 / float(rate), "output.step": 3e-4 / float(rate)}
    solution = stribeck.simulate(scenario.replace(changes))
    levels.append(rate * solution.events["slip"][0])
plt.semilogx(rates, levels, "o-")
plt.xlabel("rate of the force (N/s)")
plt.ylabel("force at break-away (N)")

# %%
# .. explorer:: break_away --law lugre --law lugre_sobczyk
