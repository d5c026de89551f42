"""``--target odrive``: the cogging map of ODrive's firmware 0.5."""

from __future__ import annotations

from stribeck.export.controller.cogging import rows, torque_over_a_turn
from stribeck.export.request import Target, ascii_only, identifier, made_by
from stribeck.scenario import Scenario

TARGET = Target("odrive", "controller.odrive", "the cogging map of ODrive's firmware 0.5", ("cogging",), folder=False)
POINTS = 3600  # of ODrive's map


def files(scenario: Scenario | None) -> dict[str, str | bytes]:
    """A header with the map."""
    motor, _, torque = torque_over_a_turn(scenario, POINTS)
    assert scenario is not None
    about = [
        f"{scenario.name}: the torque (N m) that cancels the cogging of motor {motor}, over one turn of its encoder from 0.",
        "ODrive's firmware 0.5.1 to 0.5.6 adds config.anticogging.cogging_map[3600] to its torque. Its protocol has no way to",
        "write the map: copy it there in the firmware's source, and set anticogging_valid_; calibrating overwrites it.",
        "The encoder's 0 must be the machine's: calibrate its index, or turn the table by the offset. " + made_by(),
    ]
    text = "".join(f"/* {ascii_only(line)} */\n" for line in about)
    text += f"static const float {identifier(scenario.name)}_cogging_map[{POINTS}] = {{\n    {rows(torque)}\n}};\n"
    return {f"{identifier(scenario.name)}_cogging.h": text}
