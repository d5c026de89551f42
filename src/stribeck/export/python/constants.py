"""Constants of a law that are given by name in a call."""

from __future__ import annotations

from stribeck.constants import show
from stribeck.errors import InputError, nearest
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law


def checked(law: Law, given: dict[str, Value]) -> dict[str, Value]:
    """The constants given, each of which the law has.

    Raises:
        InputError: it has no such constant.
    """
    known = list(law.p.numbers)
    if odd := [name for name in given if name not in known]:
        raise InputError(
            [f"{n} = {show(given[n])}: law '{law.name}' has no such constant{nearest(n, known)}" for n in odd]
        )
    return given
