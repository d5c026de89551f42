"""The paths of a file that name a number, and the constant that each stands for."""

from __future__ import annotations

from stribeck.scenario import Scenario

Place = tuple[str, str]  # owner and name of a constant; the owner "initial" has the states at t = 0

_IN_PIECES = ("ramp", "step")  # signals whose constants make pieces


def machine_places(scenario: Scenario) -> dict[str, Place]:
    """Every path that can be varied in lanes, and the constant it stands for."""
    rig, called = scenario.rig, scenario.called
    found: dict[str, Place] = {leaf.path: leaf.key for leaf, _ in scenario.elements.leaves}
    for body in scenario.elements.bodies.values():
        if body.tied_to is None:
            found[f"{body.path}.initial.y"] = ("initial", body.of("y"))
            if body.free:
                found |= {
                    f"{body.path}.initial.{n}": ("initial", body.of(n)) for n in ("v", *(s.name for s in body.states))
                }
    for contact in scenario.elements.contacts.values():
        if contact.has_z:
            found[f"{contact.path}.initial.z"] = ("initial", contact.of("z"))
    for use, signal in rig.signals.items():
        if signal.kind in _IN_PIECES:
            found |= {f"{use.path}.{name}": (use.path, name) for name in signal.constants}
    return {called.to_file(path): place for path, place in found.items()}
