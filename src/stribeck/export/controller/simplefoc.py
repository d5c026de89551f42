"""``--target simplefoc``: the cogging of a motor as a table and a function for SimpleFOC."""

from __future__ import annotations

from stribeck.export.controller.cogging import rows, torque_over_a_turn
from stribeck.export.request import Target, ascii_only, identifier, made_by
from stribeck.scenario import Scenario

TARGET = Target("simplefoc", "controller.simplefoc", "cogging for SimpleFOC 2.4", ("cogging",), folder=False)
POINTS = 512


def files(scenario: Scenario | None) -> dict[str, str | bytes]:
    """A header with the table and the function that interpolates it."""
    motor, K, torque = torque_over_a_turn(scenario, POINTS)
    assert scenario is not None
    name = identifier(scenario.name)
    about = [
        f"{scenario.name}: the current (A) that cancels the cogging of motor {motor}, over one turn from 0; K = {K:g} N m/A.",
        "SimpleFOC 2.4, current control, before motor.move():",
        f"  motor.feed_forward_current.q = {name}_cogging(motor.shaft_angle);",
        "In voltage mode multiply by the phase resistance and write motor.feed_forward_voltage.q. " + made_by(),
    ]
    text = "".join(f"/* {ascii_only(line)} */\n" for line in about)
    return {
        f"{name}_cogging.h": f"""{text}#ifndef {name.upper()}_COGGING_H
#define {name.upper()}_COGGING_H
#include <math.h>

static const float {name}_cogging_table[{POINTS}] = {{
    {rows(torque / K)}
}};

/* The current at an angle in rad, A. */
static inline float {name}_cogging(float angle)
{{
    const float turns = angle * 0.159154943F;
    const float x = (turns - floorf(turns)) * {POINTS}.0F;
    const int i = (int)x % {POINTS};
    const float share = x - floorf(x);
    return {name}_cogging_table[i] + share * ({name}_cogging_table[(i + 1) % {POINTS}] - {name}_cogging_table[i]);
}}
#endif
"""
    }
