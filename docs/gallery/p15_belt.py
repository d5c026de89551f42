"""
A belt: friction that drives
============================

A mass on a moving belt is held by a spring: friction carries it along until the spring pulls it back.
The belt accelerates slowly. Above some speed, stick-slip ends and the mass stays at one place.
"""

import matplotlib.pyplot as plt

import stribeck as st

rub = st.law("lugre_majorant", parameters="canudas1995", k_v=1e6)
rig = st.Machine(
    st.Body("belt", velocity=st.signals.Ramp(0.002)),
    st.Body("mass", mass=1.0),
    st.Contact("rub", "mass", rub, end="belt"),
    st.Link("spring", "mass", stiffness=2.0),
)
solution = st.simulate(rig, t_end=120.0, step=0.01)
plt.plot(solution["mass.y"], solution["mass.v"])
plt.xlabel("position (m)")
plt.ylabel("velocity (m/s)")
print(len(solution.events["rub"]["slip"]), "slips")

# %%
# Live (``stribeck new belt``):
#
# .. explorer:: belt
