"""Every structure that the built-in laws, drives and signals can form, and values to try them with."""

from itertools import product

import numpy as np

from stribeck import laws
from stribeck.drives import KINDS
from stribeck.scenario.single import one_body
from stribeck.signals import SineSignal

VARIANTS = [(law, form) for law in laws.builtin().values() for form in law.forms()]
IDS = ["_".join((law.name, *form.words)) for law, form in VARIANTS]


def systems(law, form, energy=(False, True)):
    """The machines of a law: under each drive, with both sorts of signal, without and with energy."""
    return [
        one_body(law, form, drive(), signal, on)
        for drive, signal, on in product(KINDS.values(), (None, SineSignal), energy)
    ]


def one_signal_each(law, form):
    """A system with energy under each drive, the sorts of signal in turn: neighbouring variants have the other one."""
    turn = IDS.index("_".join((law.name, *form.words)))
    sorts = (None, SineSignal)
    return [one_body(law, form, drive(), sorts[(turn + i) % 2], True) for i, drive in enumerate(KINDS.values())]


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
