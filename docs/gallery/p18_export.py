"""
To the drive: C99, and how many instructions a step costs
=========================================================

The law as C99, with a self-test that compares it with the simulated equations.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stribeck

law = stribeck.law("lugre_majorant", parameters="canudas1995", k_v=1e6)
with tempfile.TemporaryDirectory() as folder:
    made = stribeck.export(law, "c", folder)
    header = next(Path(folder).glob("*.h")).read_text()
print("\n".join(header.splitlines()[:30]))
v = np.linspace(-2e-3, 2e-3, 401)
plt.plot(1e3 * v, law.steady_force(v))
plt.xlabel("velocity in mm/s")
plt.ylabel("what the drive should compensate, in N")

# %%
# .. explorer:: lugre_majorant --law lugre_majorant
