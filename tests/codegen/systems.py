"""Every structure that the built-in laws, drives and signals can form, and values to try them with."""

from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np

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


def one_signal_each(law, form):
    """A system with energy under each drive, the sorts of signal in turn: neighboring variants have the other one."""
    turn = IDS.index("_".join((law.name, *form.words)))
    return [one_body(law, form, kind, bool((turn + i) % 2), True) for i, kind in enumerate(DRIVES)]


# of the order of 1, so that finite differences are exact to many digits
VALUES = {
    "sigma_0": 3.0, "sigma_1": 0.7, "sigma_2": 0.4, "F_c": 1.1, "F_s": 1.7, "v_s": 0.9, "k_v": 1.3, "z_ba": 0.2,
    "delta": 1.7, "g1": 0.25, "g2": 2.0, "g3": 0.5, "g4": 0.1, "g5": 1.5, "g6": 0.01, "v_d": 1.6, "mass": 1.4, "stiffness": 2.1,
    "K_p": 2.0, "K_i": 0.7, "K_d": 0.5, "amplitude": 1.2, "frequency": 0.3, "offset": 0.4, "phase": 0.5,
}  # fmt: skip


def parameters(system):
    """Values for the run-time constants, in order."""
    return np.array([VALUES[name] for _, name in system.parameters])


def states(system, count=6):
    """Random states on both sides of v = 0, the bristles elastic, sliding and in between."""
    random = np.random.default_rng(5)
    return random.uniform(-1, 1, (count, len(system.states)))
