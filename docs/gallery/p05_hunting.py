"""
Hunting: a loop that never settles
==================================

A PID position loop on a body with static friction above Coulomb friction hunts around its setpoint. The integrator winds up
while the body sticks. At break-away the body overshoots the setpoint.
"""

import matplotlib.pyplot as plt

import stribeck

scenario = stribeck.Scenario(
    law={"name": "lugre_majorant", "k_v": 1e7, "parameters": "canudas1995"},
    plant={"mass": 1.0},
    drive={"kind": "pid", "K_p": 3.0, "K_i": 4.0, "K_d": 6.0, "signal": {"kind": "step", "value": 1.0, "time": 10.0}},
    solve={"t_end": 250.0},
    output={"step": 0.05},
)
for K_i in (4.0, 1.0):
    solution = stribeck.simulate(scenario.replace({"drive.K_i": K_i}))
    plt.plot(solution["t"], solution["y"], label=f"K_i = {K_i:g} N/(m s)")
plt.xlabel("time (s)")
plt.ylabel("position (m)")
plt.legend()

# %%
# .. explorer:: limit_cycle --law lugre_sobczyk --law lugre_majorant
