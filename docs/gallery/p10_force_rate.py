"""
dF/dt through a reversal
========================

A controller that compensates friction through an inner loop needs dF/dt. LuGre has none at v = 0; the smooth laws have.
"""

import textwrap

import matplotlib.pyplot as plt
import numpy as np

import stribeck
from stribeck.errors import NotDifferentiable

v = np.linspace(-3e-6, 3e-6, 601)
for k_v in (1e6, 1e7):
    law = stribeck.law("lugre_majorant", parameters="canudas1995", k_v=k_v)
    plt.plot(1e6 * v, law.force_rate(v=v, z=1e-5, dv_dt=0.01), label=f"k_v = {k_v:g} s/m")
plt.xlabel("velocity (µm/s)")
plt.ylabel("dF/dt in N/s at z = 10 um, dv/dt = 10 mm/s^2")
plt.legend()
try:
    stribeck.law("lugre", parameters="canudas1995").force_rate(v=0.0, z=1e-5, dv_dt=0.01)
except NotDifferentiable as error:
    print(textwrap.fill(f"lugre: {error}", 88))

# %%
# .. explorer:: sine_force --law lugre_majorant --law lugre_sobczyk
