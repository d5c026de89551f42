"""
A friction law that returns more energy than it took
====================================================

The paper's law is bounded and smooth, but not passive. ``check`` finds a motion that returns the bristles to their initial
deflection, while the contact has given more work than it took. Interval arithmetic proves the sign of this energy.
"""

import matplotlib.pyplot as plt

import stribeck

law = stribeck.law("lugre_sobczyk", parameters="canudas1995", k_v=1e7)
verdict = stribeck.check(law).properties["passive"]
print("passive:", verdict.holds)
print(f"energy drawn: {1e6 * verdict.evidence['energy_drawn']:.0f} uJ in {verdict.evidence['time']:.2f} s")
solution = stribeck.simulate(verdict.scenario)

fig, (above, below) = plt.subplots(2, sharex=True)
above.plot(solution["t"], 1e6 * solution["z"])
above.set_ylabel("deflection (µm)")
below.plot(solution["t"], 1e6 * solution["E_in"])
below.set(xlabel="time (s)", ylabel="work put in (µJ)")

# %%
# The law under a sine of velocity, and ``lugre_majorant`` beside it, live:
#
# .. explorer:: hysteresis --law lugre_sobczyk --law lugre_majorant
