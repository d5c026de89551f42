"""
Frictional lag: the way up is not the way down
==============================================

While the speed varies, friction lags behind the steady curve. The faster the speed varies, the wider is the loop.
"""

import matplotlib.pyplot as plt
import numpy as np

import stribeck

law = stribeck.law("lugre_majorant", parameters="canudas1995", k_v=1e7)
for frequency in (1.0, 5.0, 10.0):
    solution = stribeck.simulate(
        stribeck.Scenario(
            law=law,
            drive={
                "kind": "velocity",
                "signal": {"kind": "sine", "offset": 1e-3, "amplitude": 1e-3, "frequency": frequency},
            },
            solve={"t_end": 3.0 / frequency},
            output={"step": 2e-3 / frequency},
        )
    )
    last = solution["t"] > 2.0 / frequency
    plt.plot(1e3 * solution["v"][last], solution["F"][last], label=f"{frequency:g} Hz")
v = np.linspace(1e-6, 2e-3, 200)
plt.plot(1e3 * v, law.steady_force(v), "k--", label="steady")
plt.xlabel("velocity (mm/s)")
plt.ylabel("friction (N)")
plt.legend()

# %%
# .. explorer:: hysteresis --law lugre --law lugre_majorant
