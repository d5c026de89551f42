"""
A mesh whose friction grows with the torque it carries
======================================================

The friction in a gear's mesh grows with its load: friction is larger while the joint lifts than while it hangs.
"""

import matplotlib.pyplot as plt

import stribeck as st

mesh = st.law(
    "lugre_majorant", {"sigma_0": 400.0, "sigma_1": 1.0, "sigma_2": 0.03, "F_c": 0.4, "F_s": 0.6, "v_s": 0.3}, k_v=1e3
)
for share in (0.0, 0.1):
    loads = [{"force": "gear", "F_c": share, "F_s": 1.5 * share}] if share else []
    rig = st.Machine(
        st.Body("rotor", inertia=0.02),
        st.Body("arm", inertia=0.08),
        st.Link("gear", "rotor", "arm", stiffness=60.0, damping=0.1),
        st.Contact("mesh", "rotor", mesh, loads=loads),
        st.Load.follow("push", "rotor", st.signals.Sine(4.0, 0.5)),
        st.Load.pendulum("gravity", "arm", 2.0),
    )
    solution = st.simulate(rig, t_end=4.0, step=2e-3)
    plt.plot(solution["rotor.v"], solution["mesh.F"], label=f"{share:g} N m for each N m carried")
plt.xlabel("velocity (rad/s)")
plt.ylabel("friction (N m)")
plt.legend()

# %%
# A gear whose mesh friction depends on the load, live (``stribeck new gear``):
#
# .. explorer:: gear
