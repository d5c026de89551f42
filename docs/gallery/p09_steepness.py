"""
How steep must k_v be?
======================

A smooth law approaches LuGre as k_v grows, and its force changes faster near rest. ``check`` finds the smallest k_v that
meets a tolerance: here a body under a load just below break-away may creep by one micrometer per second.
"""

import matplotlib.pyplot as plt
import numpy as np

import stribeck

law = stribeck.law("lugre_majorant", parameters="canudas1995", k_v=1e5)
found = stribeck.check(law, creep=1e-6).steepness["lugre_majorant"]
print(f"k_v = {found.k_v:.3g} s/m keeps", found.requirements[0].name, "below 1 um/s")
v = np.linspace(-2e-3, 2e-3, 801)
for k_v in (1e3, 1e4, 1e5):
    law = stribeck.law("lugre_majorant", parameters="canudas1995", k_v=k_v)
    plt.plot(1e3 * v, law.steady_force(v), label=f"k_v = {k_v:g} s/m")
plt.xlabel("velocity (mm/s)")
plt.ylabel("steady friction (N)")
plt.legend()

# %%
# .. explorer:: stick_slip --law lugre_majorant
