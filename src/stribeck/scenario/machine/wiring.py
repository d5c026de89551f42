"""What can only be judged with several tables of a machine in hand."""

from __future__ import annotations

from math import inf

import numpy as np

from stribeck.constants import show
from stribeck.laws.base import Law
from stribeck.machine.parts import BodyPart, ContactPart, ControllerPart, LinkPart, LoadPart, MotorPart
from stribeck.scenario.machine.tables import BodyTable
from stribeck.scenario.tables import Problem
from stribeck.signals import PointsSignal, Signal, SineSignal, StepSignal


def of_body(path: str, values: BodyTable) -> list[Problem]:
    """What in the table of a body does not go together."""
    found: list[Problem] = []
    given = [n for n in ("mass", "inertia") if getattr(values, n) is not None]
    if values.velocity is not None:
        why = "must be left out: the velocity of this body is given"
        found += [(f"{path}.{n}", f"{show(getattr(values, n))}: {why}") for n in (*given, "tied_to", "ratio")
                  if getattr(values, n) is not None]  # fmt: skip
        if values.initial is not None and "v" in values.initial.model_fields_set:
            found.append((f"{path}.initial.v", f"{show(values.initial.v)}: {why}"))
        return found
    if len(given) == 2:
        text = "must be left out where mass is given: a body moves straight (mass, kg) or turns (inertia, kg m^2)"
        found.append((f"{path}.inertia", f"{show(values.inertia)}: {text}"))
    if not given:
        found.append(
            (f"{path}.mass", "missing: must be given (mass in kg, or inertia in kg m^2 for a body that turns)")
        )
    if values.tied_to is None and values.ratio is not None:
        found.append(
            (f"{path}.ratio", f"{show(values.ratio)}: needs tied_to: it says how far the body moves by another")
        )
    if values.tied_to is not None and values.initial is not None:
        text = "must be left out: a body that is tied to another has no state of its own"
        found.append((f"{path}.initial", f"{show(dict(values.initial))}: {text}"))
    return found


def problems(
    bodies: tuple[BodyPart, ...], links: tuple[LinkPart, ...], contacts: tuple[ContactPart, ...],
    loads: tuple[LoadPart, ...], motors: tuple[MotorPart, ...], controllers: tuple[ControllerPart, ...],
    named: dict[str, dict[str, object]],
) -> list[Problem]:  # fmt: skip
    """What is wrong with the parts taken together."""
    found = _ties(bodies)
    by_motor: dict[str, str] = {}
    for each in controllers:
        if each.on not in named["motors"]:
            continue
        if each.on in by_motor:
            text = f"{show(each.on)}: must be another motor: controllers.{by_motor[each.on]} drives it already"
            found.append((f"controllers.{each.name}.on", text))
        by_motor.setdefault(each.on, each.name)
    driven = [show(t.get("on")) for t in _tables(named["controllers"])]
    known = {show(n) for n in (*named["bodies"], *named["motors"])}  # a controller on something else is told already
    for motor in motors:
        if motor.signal is None and show(motor.name) not in driven and known.issuperset(driven):
            text = "missing: must be given (the voltage), or a controller must be on the motor"
            found.append((f"motors.{motor.name}.signal", text))
        if motor.signal is not None and motor.name in by_motor:
            text = f"must be left out: controllers.{by_motor[motor.name]} drives the motor"
            found.append((f"motors.{motor.name}.signal", f"a signal: {text}"))
    return found + _fights(bodies, motors, controllers)


def _leader(bodies: tuple[BodyPart, ...], name: str) -> BodyPart | None:
    known, seen = {body.name: body for body in bodies}, set()
    while name in known and name not in seen:
        seen.add(name)
        if (leader := known[name].leader) is None:
            return known[name]
        name = leader
    return None


def _fights(
    bodies: tuple[BodyPart, ...], motors: tuple[MotorPart, ...], controllers: tuple[ControllerPart, ...]
) -> list[Problem]:
    """Two drives on one body: two controllers, or one where the velocity is given."""
    found: list[Problem] = []
    first: dict[str, str] = {}
    names = {body.name for body in bodies}
    driving: tuple[MotorPart | ControllerPart, ...] = (*motors, *controllers)
    for each in driving:
        leader = _leader(bodies, each.on)
        if leader is not None and leader.driven is not None:
            text = (
                f"{show(each.on)}: must be another body: the velocity of {leader.name} is given, and nothing acts on it"
            )
            found.append((f"{each.path}.on", text))
        if isinstance(each, ControllerPart) and each.on in names:
            if each.on in first:
                text = f"{show(each.on)}: must be another body: controllers.{first[each.on]} drives it already"
                found.append((f"{each.path}.on", text))
            first.setdefault(each.on, each.name)
    return found


def that_jump(contacts: tuple[ContactPart, ...], bodies: tuple[BodyPart, ...], laws: dict[str, Law]) -> list[Problem]:
    """Laws whose force jumps at rest, under bodies that obey forces."""
    found: list[Problem] = []
    for contact in contacts:
        ends = [_leader(bodies, name) for name in (contact.span.start, contact.span.end) if isinstance(name, str)]
        law = laws[contact.law_path]
        if law.jumps_at_rest and any(body is not None and body.driven is None for body in ends):
            text = f"the force of law '{law.name}' jumps at v = 0, and a body under it cannot come to rest"
            if "k_v" in law.constants():
                found.append((f"{contact.law_path}.k_v", f"missing: {text}; give k_v > 0 for a smooth sign"))
            else:
                found.append((f"{contact.law_path}.name", f"{show(law.name)}: {text}"))
    return found


def _tables(section: dict[str, object]) -> list[dict[str, object]]:
    return [table for table in section.values() if isinstance(table, dict)]


def _ties(bodies: tuple[BodyPart, ...]) -> list[Problem]:
    """Bodies that are tied in a ring."""
    leader = {body.name: body.leader for body in bodies}
    found: list[Problem] = []
    told: set[str] = set()
    for body in bodies:
        ring, at = [body.name], body.leader
        while at is not None and at in leader and at not in ring:
            ring.append(at)
            at = leader[at]
        if at == body.name and body.name not in told:
            told |= set(ring)
            text = (
                "a body cannot be tied to itself" if len(ring) == 1 else f"tied in a ring: {' -> '.join([*ring, at])}"
            )
            found.append((f"bodies.{body.name}.tied_to", f"{show(body.leader)}: {text}"))
    return found


def carrier(on: str, named: dict[str, dict[str, object]]) -> str | None:
    """The body that `on` names, or that its motor is on."""
    if on in named["bodies"]:
        return on
    motor = named["motors"].get(on)
    body = motor.get("on") if isinstance(motor, dict) else None
    return body if isinstance(body, str) and body in named["bodies"] else None


def level_problems(table: dict[str, object], where: str, contact: str, law: Law | None) -> list[Problem]:
    """What is wrong with an entry of a contact's loads before its names are looked up."""
    force = table.get("force")
    names = [force] if isinstance(force, str) else list(force) if isinstance(force, dict) else []
    if contact in names:
        return [(f"{where}.force", f"{show(contact)}: names itself: must be a link, a motor or a load")]
    if not any(n in table for n in ("F_c", "F_s")):
        return [(f"{where}.F_c", "missing: must be given (the rise of the level by the force; F_s likewise)")]
    if law is not None and not any(n in law.constants() for n in ("F_c", "F_s")):
        return [(where, f"{show(table)}: law '{law.name}' has no level F_c or F_s to raise")]
    return []


def not_to_multiply(of: str, law: Law) -> str | None:
    """Why a factor cannot be on a parameter, or None."""
    if of == "sigma_0":
        why = "a stiffness that changes stores energy at no cost; use level, or F_c and F_s"
        return f"must be left out: sigma_0 is not a thing to multiply ({why})"
    known = [n for n in law.numbers(law.form) if n != "sigma_0"]
    if of == "level":
        return None if "F_c" in known or "F_s" in known else f"law '{law.name}' has no level F_c or F_s"
    if of not in known:
        from stribeck.errors import nearest

        guess = nearest(of, (*known, "level")) or f" (it has {', '.join(known)}, and level)"
        return f"unknown key: law '{law.name}' has no such number{guess}"
    return None


def extremes(signal: Signal) -> tuple[float, float] | None:
    """The least and the largest value of a signal; None where it begins at 0."""
    if isinstance(signal, PointsSignal):
        return float(np.min(signal.value)), float(np.max(signal.value))
    if isinstance(signal, SineSignal):
        middle, size = signal.values["offset"], abs(signal.values["amplitude"])
        return middle - size, middle + size
    if isinstance(signal, StepSignal) or not signal.smooth:
        return None
    values = signal.at(np.linspace(signal.pieces[0][0], signal.pieces[-1][0], 4001))
    return float(np.min(values)), float(np.max(values))


def not_positive(signal: Signal) -> str | None:
    """Why a signal cannot be a factor, or None."""
    if (found := extremes(signal)) is None:
        return f"{show(signal.kind)}: begins at 0: a factor must be > 0 at all times"
    return None if found[0] > 0 else f"reaches {found[0]:g}: a factor must be > 0 at all times"


def beyond(path: str, law: Law, by: dict[str, tuple[float, float]]) -> list[Problem]:
    """What a law does not allow any more where factors are at their least and largest."""
    found: list[Problem] = []
    for name, (low, _) in by.items():
        constant, value = law.constants().get(name), law.values.get(name)
        if constant is None or value is None or constant.at_least is None or low * value >= constant.at_least:
            continue
        text = f"brings {name} down to {low * value:g}: it must stay {constant.allowed}"
        found.append((f"{path}.factors.{name}", text))
    z_ba, sigma_0 = law.values.get("z_ba"), law.values.get("sigma_0")
    if z_ba is None or sigma_0 is None:
        return found
    largest = z_ba * by.get("z_ba", (1.0, 1.0))[1]
    told: dict[str, str] = {}
    for name in ("F_c", "F_s"):  # sigma_0 g is between them, whichever is the larger
        least = (law.values.get(name) or inf) / sigma_0 * by.get(name, (1.0, 1.0))[0] * by.get("level", (1.0, 1.0))[0]
        blamed = min((n for n in ("level", name, "z_ba") if n in by), key=lambda n: by[n][0], default=None)
        if largest >= least and blamed is not None:
            text = f"z_ba (up to {largest:g}) must stay below {name}/sigma_0, which factors bring down to {least:g}"
            told.setdefault(f"{path}.factors.{blamed}", text)
    return [*found, *told.items()]


def no_second_derivative(signal: Signal) -> str | None:
    """Why a signal cannot be fed forward, or None."""
    if signal.smooth or signal.kind == "ramp":
        return None
    return f"{show(signal.kind)}: has no second derivative, which feedforward needs: must be sine, point_to_point or spline"
