"""
The Stribeck curve, law by law
==============================

At constant speed, each law settles to its steady curve. Smooth laws pass through zero with a finite slope, which k_v sets.
"""

import matplotlib.pyplot as plt
import numpy as np

import stribeck

v = np.linspace(-4e-3, 4e-3, 801)
for name, given in {
    "lugre": {},
    "lugre_sobczyk": {"k_v": 1e4},
    "lugre_majorant": {"k_v": 1e4},
    "coulomb_viscous": {"k_v": 1e4},
}.items():
    law = stribeck.law(name, parameters="canudas1995", **given)
    plt.plot(1e3 * v, law.steady_force(v), label=name)
plt.xlabel("velocity (mm/s)")
plt.ylabel("steady friction (N)")
plt.legend()

# %%
# .. explorer:: lugre_sobczyk --law lugre_sobczyk --law lugre_majorant --law coulomb_viscous
