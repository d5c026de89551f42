"""Properties of a machine's contacts, and of the whole machine, whose storage function is their sum."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from stribeck.constants import Constant, show
from stribeck.errors import InputError, arg, nearest
from stribeck.laws.base import Law
from stribeck.machine.elements.bodies import Body
from stribeck.machine.elements.bodies.cylinder import Piston
from stribeck.machine.elements.links import Link
from stribeck.machine.elements.loads import Pendulum
from stribeck.mouth.document import Document
from stribeck.mouth.terminal import Told
from stribeck.properties.checked import check_law, check_varied
from stribeck.properties.plain import Json
from stribeck.properties.ranges import of_contact
from stribeck.properties.verdicts import Verdicts
from stribeck.properties.worst import Varied
from stribeck.scenario import Scenario
from stribeck.scenario.objects import Machine, scenario_of
from stribeck.scenario.schema1 import SIGNALS

ONLY = "contact"  # the name of the contact of a single body
_SUM = (
    "the stored energy (kinetic, and of contacts, links and pendulums) never rises by more than the energy supplied by loads, "
    "motors, controllers and driven ends (theory.md; Coq: machine_passive)"
)


@dataclass(repr=False)
class MachineVerdicts(Told):
    """The verdicts on a machine.

    Attributes:
        name: of the machine.
        contacts: verdicts on each contact's law, for every history of its constants that the file allows.
        passive: whether the machine is proved passive from its ports to the velocities there (True), refuted (False), or
            neither (None).
        why: the reason, in words.
        spoiled_by: the contacts that are not passive.
        undecided: contacts and elements without a verdict.
        ports: loads, motors, cylinders, controllers and moved bodies and ends, which supply energy.
    """

    name: str
    contacts: dict[str, Verdicts]
    passive: bool | None = None
    why: str = ""
    spoiled_by: list[str] = field(default_factory=list)
    undecided: list[str] = field(default_factory=list)
    ports: dict[str, str] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Verdicts:
        return self.contacts[name]

    @property
    def answer(self) -> str:
        """The verdict on the machine and its reason, in one sentence."""
        if self.passive:
            return "passive at its ports (proved)"
        return f"{'passivity not proved' if self.passive is None else 'not passive'}: {self.why}"

    def document(self) -> Document:
        """The verdicts as a document, for the terminal and for a page."""
        from stribeck.properties import said

        return said.machine(self)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} on {self.name}: {self.answer}>"

    def verify(self) -> bool:
        """Check every proof and replay every counterexample; True where all agree."""
        agreed = [verdicts.verify() for verdicts in self.contacts.values()]  # all of them, also after a failure
        return all(agreed)

    @property
    def unverified(self) -> list[str]:
        """The decided properties of all contacts that :meth:`verify` cannot check."""
        return [f"{contact}.{name}" for contact, verdicts in self.contacts.items() for name in verdicts.unverified]

    @property
    def proved(self) -> bool:
        """Whether there is a proof with a certificate."""
        return any(verdicts.proved for verdicts in self.contacts.values())

    def certificates(self) -> dict[str, Json]:
        """The certificates of all contacts, as plain data."""
        return {"contacts": {name: verdicts.certificates() for name, verdicts in self.contacts.items()}}

    def to_dict(self) -> dict[str, Json]:
        """Plain data."""
        machine = {
            "passive": self.passive, "why": self.why, "spoiled_by": self.spoiled_by, "undecided": self.undecided,
            "ports": self.ports,
        }  # fmt: skip
        contacts = {name: {**verdicts.to_dict(), "ranges": verdicts.level} for name, verdicts in self.contacts.items()}
        return {"scenario": self.name, "contacts": contacts, "machine": machine}


def check_machine(
    scenario: Scenario | Machine | str | Path | Mapping[str, object],
    v_max: float | None,
    forces: Mapping[str, float] | None,
    t_end: float | None,
    work: float,
) -> MachineVerdicts:
    """Check each contact of a machine for every history of its constants that the file allows, and the whole machine.

    Signals of factors are bounded over the whole run, and waves of factors over all positions. Loads are bounded for every
    history. The force of a link or a motor has no bound unless ``forces`` states one.

    The arguments are those of :func:`stribeck.check`; a law on a single body is a machine of one contact.

    Raises:
        InputError: the scenario is not valid, or there is no such force.
    """
    source = scenario_of(scenario, t_end, None)
    stated = dict(forces or {})
    _refuse(source, stated)
    if source.elements.unnamed:
        return _single(source, v_max, work)
    verdicts = MachineVerdicts(source.name, {})
    for contact in source.system.contacts:
        varied = of_contact(source.elements, contact, source.end, stated)
        verdicts.contacts[contact.name] = _of_law(varied, v_max, work)
    _decide_machine(source, verdicts)
    return verdicts


def _refuse(scenario: Scenario, stated: Mapping[str, float]) -> None:
    machine = scenario.system
    known = [part.name for part in (*machine.links, *machine.loads, *machine.motors)]
    problems = []
    for name, size in stated.items():
        if name not in known:
            has = nearest(name, known) or f" (it has {', '.join(known) or 'none'})"
            problems.append(f"{arg('force')}: {name!r}: {scenario.name} has no such link, load or motor{has}")
        elif text := Constant("N", "", at_least=0).problem(size):
            problems.append(f"force.{name}: {show(size)}: {text}")
    if problems:
        raise InputError(problems)


def _of_law(varied: Varied, v_max: float | None, work: float) -> Verdicts:
    return check_varied(varied, v_max, work) if varied.ranges else check_law(varied.law, v_max, work)


def _single(scenario: Scenario, v_max: float | None, work: float) -> MachineVerdicts:
    """A law on a single body, or on the piston of a servo."""
    law: Law = scenario.law
    kind = scenario.called.drive
    verdicts = MachineVerdicts(scenario.name, {ONLY: _of_law(Varied(law, {}), v_max, work)})
    verdicts.ports = {"drive": f"{kind}: the signal is the {SIGNALS[kind]}"}
    _judge(verdicts, alone=type(scenario.elements.bodies[""]) is Body)
    return verdicts


def _decide_machine(scenario: Scenario, verdicts: MachineVerdicts) -> None:
    machine = scenario.system
    verdicts.ports |= {f"bodies.{b.name}": "its velocity is given" for b in machine.bodies if b.velocity is not None}
    verdicts.ports |= {x.path: "its far end is moved" for x in machine.links if x.far is not None}
    verdicts.ports |= {x.path: f"a force on {x.on} ({x.kind})" for x in machine.loads if type(x) is not Pendulum}
    verdicts.ports |= {x.path: f"a motor on {x.on}" for x in machine.motors}
    gas = "a cylinder: its gas is an energy of its own"
    verdicts.ports |= {b.path: gas for b in machine.bodies if isinstance(b, Piston)}
    verdicts.ports |= {x.path: f"a controller on {x.on}: active" for x in machine.elements.controllers.values()}
    verdicts.undecided += [x.path for x in machine.links if type(x) is not Link]
    verdicts.undecided += [b.path for b in machine.bodies if type(b) not in (Body, Piston)]
    bodies = {c.ends for c in machine.contacts}
    alone = len(machine.bodies) == 1 and len(machine.contacts) == 1 == len(bodies) and not machine.links
    _judge(verdicts, alone and not verdicts[machine.contacts[0].name].level)


def _judge(whole: MachineVerdicts, alone: bool) -> None:
    """Decide about the whole machine; a machine of a single contact at a constant level is as passive as the contact."""
    passive = {name: verdicts["passive"].holds for name, verdicts in whole.contacts.items()}
    whole.spoiled_by = [name for name, holds in passive.items() if holds is False]
    whole.undecided = [*(name for name, holds in passive.items() if holds is None), *whole.undecided]
    if not whole.spoiled_by and not whole.undecided:
        limits = [v.v_max for v in whole.contacts.values() if v.v_max is not None]
        within = f", while |w| <= {min(limits):g} at every contact" if limits else ""
        whole.passive, whole.why = True, _SUM + within
    elif whole.spoiled_by:
        names = ", ".join(whole.spoiled_by)
        whole.passive = False if alone else None
        whole.why = f"energy can be drawn from {names}"
        whole.why += "" if alone else "; other elements may not dissipate all of it"
    else:
        whole.why = f"undecided for {', '.join(whole.undecided)}"
