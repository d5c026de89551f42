"""Constants of a law that are given by name in a call."""

from __future__ import annotations

from stribeck.constants import show
from stribeck.errors import InputError, nearest
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law


def checked(law: Law, given: dict[str, Value]) -> dict[str, Value]:
    """The given constants, after a check of their names.

    Raises:
        InputError: the law has no such constant.
    """
    known = list(law.p.numbers)
    if odd := [name for name in given if name not in known]:
        raise InputError(
            [f"{n} = {show(given[n])}: law '{law.name}' has no such constant{nearest(n, known)}" for n in odd]
        )
    return given


def with_load(law: Law, given: dict[str, Value], load: Value) -> dict[str, Value]:
    """The given constants and the law's inputs: the entries of ``load`` along its last axis, or ``load`` itself.

    Raises:
        InputError: the law has no such constant, or it has inputs but no load is given, or the reverse.
    """
    names = law.inputs
    if load is None and not names:
        return checked(law, given)
    if load is None:
        raise InputError(f"load: missing: must be an array whose last axis has {', '.join(names)}")
    if not names:
        raise InputError(f"load: must be left out: law '{law.name}' has no inputs")
    if len(names) > 1 and load.shape[-1] != len(names):
        raise InputError(f"load: {load.shape[-1]} entries along the last axis: must be {', '.join(names)}")
    entries = [load] if len(names) == 1 else [load[..., i] for i in range(len(names))]
    return checked(law, {**given, **dict(zip(names, entries, strict=True))})
