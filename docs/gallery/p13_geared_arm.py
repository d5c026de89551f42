"""
A geared arm with backlash
==========================

A motor drives an arm through a gear with backlash. The encoder of the cascade controller is on the motor, so it does not
measure the backlash and the twist of the gear.
"""

import matplotlib.pyplot as plt

import stribeck as st

seal = st.law(
    "lugre_majorant", {"sigma_0": 1.2e3, "sigma_1": 4.0, "sigma_2": 0.05, "F_c": 0.3, "F_s": 0.42, "v_s": 0.03}, k_v=1e5
)
rig = st.Machine(
    st.Body("rotor", inertia=6e-5),
    st.Body("arm", inertia=0.12),
    st.Link("gear", "rotor", "arm", ratio=0.02, stiffness=4e3, damping=5.0, gap=1e-3),
    st.Contact("seal", "arm", seal),
    st.Load.pendulum("gravity", "arm", 4.0),
    st.Controller.cascade(
        "axis", on="rotor", signal=st.signals.PointToPoint([0.1, 0.7], [0.0, 50.0]), K_p=20, K_v=0.02, T_i=0.04
    ),
)
solution = st.simulate(rig, t_end=1.5, step=2e-3)
fig, (above, below) = plt.subplots(2, sharex=True)
above.plot(solution["t"], 0.02 * solution["rotor.y"], label="motor, behind the ratio")
above.plot(solution["t"], solution["arm.y"], label="arm")
above.set_ylabel("angle (rad)")
above.legend()
below.plot(solution["t"], 1e3 * (solution["arm.y"] - 0.02 * solution["rotor.y"]))
below.set(xlabel="time (s)", ylabel="difference (mrad)")
for event, times in solution.events["gear"].items():  # the teeth meet and part
    print(f"{event}: {len(times)} times")

# %%
# An arm with a sampled controller, live (``stribeck new arm``):
#
# .. explorer:: arm
