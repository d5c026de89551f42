"""
From a log to parameters with intervals
=======================================

The log is synthetic, so that the true values are known. Each estimate has a 95 % interval.
"""

import matplotlib.pyplot as plt
import numpy as np

import stribeck

truth = stribeck.law("stribeck_tanh", parameters="canudas1995", k_v=1e4)
rng = np.random.default_rng(3)
t = np.arange(0.0, 20.0, 0.002)
v = 0.05 * np.sin(2 * np.pi * 0.1 * t) * np.sin(2 * np.pi * 0.37 * t)
log = {"t": t, "v": v, "F": truth.steady_force(v) + 0.02 * rng.standard_normal(len(t))}
fit = stribeck.fit(log, "stribeck_tanh", time="t", velocity="v", force="F")
print(fit)
plt.plot(1e3 * v, log["F"], ".", ms=1, label="log")
speeds = np.linspace(v.min(), v.max(), 401)
plt.plot(1e3 * speeds, fit.law(guessing=True).steady_force(speeds), label="fit")
plt.xlabel("velocity (mm/s)")
plt.ylabel("friction (N)")
plt.legend()

# %%
# .. explorer:: hysteresis --law stribeck_tanh --law lugre
