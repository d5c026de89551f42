"""
To the drive: a law as C99
==========================

``export`` writes the simulated equations as C. The figure shows the steady friction that a drive can compensate with them.
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
plt.xlabel("velocity (mm/s)")
plt.ylabel("steady friction (N)")

# %%
# .. explorer:: lugre_majorant --law lugre_majorant
