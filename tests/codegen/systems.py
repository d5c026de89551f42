"""Every structure that the built-in laws, drives and signals can form, and values to try them with."""

from dataclasses import replace
from functools import cache
from itertools import product

from stribeck import Scenario, laws
from stribeck.expressions.graph import symbol
from stribeck.machine.law import Friction
from stribeck.machine.table import Frozen

VARIANTS = [(law, form) for law in laws.builtin().values() for form in law.forms()]
IDS = ["_".join((law.name, *form.words)) for law, form in VARIANTS]


STRAIGHT = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 1.0]}
SINE = {"kind": "sine", "amplitude": 1.2, "frequency": 0.3, "offset": 0.4, "phase": 0.5}
SIGNALS = (STRAIGHT, SINE)
DRIVES = {
    "force": {}, "spring": {"stiffness": 2.1}, "pid": {"K_p": 2.0, "K_i": 0.7, "K_d": 0.5}, "velocity": {},
}  # fmt: skip


@cache
def _under(kind, smooth, energy):
    """The machine of some law on a body under a drive."""
    return Scenario(
        law={"name": "lugre", "parameters": "canudas1995"}, plant={} if kind == "velocity" else {"mass": 1.4},
        drive={"kind": kind, **DRIVES[kind], "signal": SIGNALS[smooth]}, solve={"t_end": 1.0},
        output={"step": 0.1, "energy": energy},
    ).system  # fmt: skip


def one_body(law, form, kind, smooth, energy=False):
    """The same of a law in one of its forms, with a signal of straight pieces or a smooth one."""
    system = _under(kind, smooth, energy)
    contact = system.elements.contacts[""]
    friction = Friction(law, form, law.symbolic(lambda name: symbol(f"{contact.law_path}.{name}"), form))
    contacts = Frozen({"": contact.model_copy(update={"law": friction})})
    return replace(system, elements=replace(system.elements, contacts=contacts))


def systems(law, form, energy=(False, True)):
    """The machines of a law: under each drive, with both sorts of signal, without and with energy."""
    return [one_body(law, form, kind, signal, on) for kind, signal, on in product(DRIVES, (False, True), energy)]
