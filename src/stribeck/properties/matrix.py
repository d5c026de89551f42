"""Every law with one parameter set, and every parameter set with every law."""

from __future__ import annotations

from collections.abc import Mapping

from stribeck import laws
from stribeck.laws.base import Law
from stribeck.properties import WORK, check
from stribeck.properties.checked import Checked
from stribeck.properties.storage import Storage, reach_of
from stribeck.properties.verdicts import Verdicts

_STEEP = 1e4  # k_v v_s where k_v is not given
_ELASTIC = 0.7  # sigma_0 z_ba / F_c where z_ba is not given


def every_law(values: Mapping[str, float | str]) -> list[Law]:
    """Every law of the package with a z that the values suffice for.

    The laws' own constants that are missing are chosen: k_v = 1e4/v_s, z_ba = 0.7 F_c/sigma_0. Constants that a law
    does not have are left out.
    """
    chosen = dict(values)
    if "v_s" in values:
        chosen.setdefault("k_v", _STEEP / float(values["v_s"]))
    if {"F_c", "sigma_0"} <= set(values):
        chosen.setdefault("z_ba", _ELASTIC * float(values["F_c"]) / float(values["sigma_0"]))
    found = []
    for cls in laws.builtin().values():
        known = cls.constants()
        own = {n: x for n, x in chosen.items() if n in known}
        if cls.has_z and all(n in own for n, c in known.items() if c.required):
            found.append(cls(own))
    return found


def check_all(values: Mapping[str, float | str], v_max: float | None = None) -> dict[str, Verdicts]:
    """The verdicts of :func:`stribeck.check` on every law that a machine's constants allow, by the law's name.

    Args:
        values: the machine's parameters and the laws' own constants, by name.
        v_max: passivity is asked for speeds up to this, m/s; for every speed unless given.

    Raises:
        InputError: a value is bad.
    """
    return {law.name: check(law, v_max) for law in every_law(values)}


def passive_with(values: Mapping[str, float | str]) -> dict[str, bool | None]:
    """By law: True where the set is proved passive with the law's own stored energy, False where sampling leaves no
    room for any, None where neither. Quick, for listings; :func:`check` proves more, and gives a counterexample."""
    found: dict[str, bool | None] = {}
    for law in every_law(values):
        reach = reach_of(law, law.guarantees()["bounded"])
        if not Storage(law, None, reach).exists:
            found[law.name] = False
        else:
            found[law.name] = Checked(law, None, WORK).passive_with_own_energy()
    return found
