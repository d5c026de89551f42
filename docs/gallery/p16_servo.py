"""
The paper's pneumatic servo
===========================

A cascade controller on a pneumatic cylinder, with and without a friction observer. Without it, friction
remains in the tracking error, mostly at reversals.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import stribeck
import stribeck.examples

servo = stribeck.Scenario.load(Path(stribeck.examples.__file__).parent / "servo.toml")
fig, (above, below) = plt.subplots(2, sharex=True)
for words, changes in {"with the observer": {}, "without": {"drive.observer": {"name": "none"}}}.items():
    solution = stribeck.simulate(servo.replace(changes))
    last = solution["t"] > 5
    above.plot(solution["t"][last], 1e3 * solution["e"][last], label=words)
    below.plot(solution["t"][last], solution["F"][last])
above.set_ylabel("position error (mm)")
above.legend()
below.set(xlabel="time (s)", ylabel="friction (N)")

# %%
# The law of the observer in the built-in stick-slip run, live:
#
# .. explorer:: lugre_sobczyk --law lugre_sobczyk
