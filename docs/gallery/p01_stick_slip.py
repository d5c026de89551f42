"""
Stick-slip: a body on a slowly pulled spring
============================================

A soft spring pulls a body at a small, steady speed. The body does not follow steadily: it sticks until the spring reaches the
break-away force F_s, then slips. The explorer below begins with F_s as low as F_c, where the body follows smoothly.
Drag F_s to the right and see stick-slip begin.
"""

import matplotlib.pyplot as plt

import stribeck

scenario = stribeck.Scenario(
    law={"name": "lugre_majorant", "k_v": 1e6, "parameters": "canudas1995"},
    plant={"mass": 1.0},
    drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
    solve={"t_end": 40.0},
    output={"step": 0.01},
)
solution = stribeck.simulate(scenario)

fig, (above, below) = plt.subplots(2, sharex=True)
above.plot(solution["t"], solution["y"])
above.set_ylabel("position (m)")
below.plot(solution["t"], solution["F"])
below.set(xlabel="time (s)", ylabel="friction (N)")
print("slips at", [f"{t:.2f} s" for t in solution.events["slip"]])

# %%
# Here ``F_s`` is as low as ``F_c``: the body slips once, and follows. Drag the slider of ``F_s`` to the right: above about 1.3 N
# the position becomes a staircase, and the line at the top says how often the body sticks and slips.
#
# .. explorer:: stick_slip --law lugre --law lugre_majorant --law coulomb_viscous #law.parameters.F_s=1
