"""What each field of a claim, of its tree and of a theorem's data must be: all are read before anything is confirmed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from stribeck_verify.expressions import CONDITIONS, PI, Json, Refused, U, W, name, rational, read

Check = Callable[[Json], object]  # raises Refused
HIGHEST = 64  # power of u or w
RELATIONS = (">=0", ">0", "!=0", "=0")


class Table(NamedTuple):
    """The fields that a table must have, and those that it may have; it has no others."""

    required: Mapping[str, Check]
    optional: Mapping[str, Check]

    def check(self, what: str, data: Mapping[str, Json]) -> None:
        """Check a table's fields.

        Raises:
            Refused: one is missing, of another type, or unknown.
        """
        known = {**self.required, **self.optional}
        if unknown := [key for key in data if key not in known]:
            raise Refused(f"no {what} has {unknown[0]!r}")
        for key, check in known.items():
            if key not in data and key in self.required:
                raise Refused(f"{what}: {key}: missing")
            if key in data:
                try:
                    check(data[key])
                except Refused as reason:
                    raise Refused(f"{what}: {key}: {reason}") from None


# -- types ----------------------------------------------------------------------------------------------------------------


def _whole(least: int, most: int) -> Check:
    def check(x: Json) -> None:
        if type(x) is not int or not least <= x <= most:
            raise Refused(f"{x!r}: must be a whole number from {least} to {most}")

    return check


def _sign(x: Json) -> None:
    if type(x) is not int or x not in (1, -1):
        raise Refused(f"{x!r}: must be 1 or -1")


def _one_of(*allowed: str) -> Check:
    def check(x: Json) -> None:
        if not isinstance(x, str) or x not in allowed:
            raise Refused(f"{x!r}: must be {' or '.join(allowed)}")

    return check


def _within(x: Json) -> None:
    if x != "Z":
        rational(x)


def _formula(*names: str, condition: bool | None = False) -> Check:
    """An expression of these names; ``condition``: whether it is true or false in place of a number, None: either."""
    known = {n: {"u": U, "w": W}.get(n, name(n)) for n in names} | {"pi": PI}

    def check(x: Json) -> None:
        is_condition = read(x, known).op in CONDITIONS
        if condition is not None and is_condition is not condition:
            raise Refused(f"{str(x)[:80]}: must be {'a condition' if condition else 'a number'}")

    return check


def _list(each: Check) -> Check:
    def check(x: Json) -> None:
        if not isinstance(x, list):
            raise Refused(f"{x!r}: must be a list")
        for part in x:
            each(part)

    return check


def _row(*checks: Check) -> Check:
    """A list with an entry for each check."""

    def check(x: Json) -> None:
        if not isinstance(x, list) or len(x) != len(checks):
            raise Refused(f"{x!r}: must be a list of {len(checks)}")
        for part, each in zip(x, checks, strict=True):
            each(part)

    return check


def _end(x: Json) -> None:
    if x != "inf":
        rational(x)


def ends(x: Json) -> None:
    """A rational number and one that is not below it, or ``inf``.

    Raises:
        Refused: it is something else.
    """
    _row(rational, _end)(x)
    if x[1] != "inf" and rational(x[1]) < rational(x[0]):
        raise Refused(f"no range: {x!r}")


def _range(x: Json) -> None:
    ends(x)
    if rational(x[0]) < 0:
        raise Refused(f"no range of numbers >= 0: {x!r}")


# -- trees ----------------------------------------------------------------------------------------------------------------

_PAIR: tuple[Check, ...] = (rational, rational)
_OF_RULE: dict[str, tuple[Check, ...]] = {
    "range": _PAIR, "pi range": _PAIR, "slope": _PAIR, "chord": _PAIR, "above": (rational,), "below": (rational,),
    "root": (_formula("u", "w"), rational), "far": (), "tangent": (), "either": (),
}  # fmt: skip
_EXPRESSION, _EITHER = _formula("u", "w"), _formula("u", "w", condition=None)


def _atom(x: Json) -> None:
    if not isinstance(x, list) or len(x) < 2 or not isinstance(x[1], str) or x[1] not in _OF_RULE:
        raise Refused(f"no atom: {str(x)[:80]}")
    expression, rule, *rest = x
    (_EITHER if rule == "either" else _EXPRESSION)(expression)
    _row(*_OF_RULE[rule])(rest)


def tree(x: Json) -> None:
    """A tree of a claim: its nodes, and the atoms of its leaves.

    Raises:
        Refused: a part is something else.
    """
    stack = [x]
    while stack:
        at = stack.pop()
        if not isinstance(at, list) or not at:
            raise Refused("a tree is no list")
        kind, *rest = at
        if kind == "leaf" and len(rest) == 1:
            _list(_atom)(rest[0])
        elif kind == "split" and len(rest) == 4:
            _one_of("u", "w", "p", "q")(rest[0])
            rational(rest[1])
            stack += rest[2:]
        elif isinstance(kind, str) and len(rest) == {"polar u": 1, "diagonal": 2}.get(kind):
            stack += rest
        else:
            raise Refused(f"no tree: {str(at)[:60]}")


# -- claims ---------------------------------------------------------------------------------------------------------------

_SLOPE: dict[str, Check] = {"slope": _formula("z")}
_POWERS: dict[str, Check] = {"a": rational, "b": rational, "k": _whole(1, HIGHEST)}
_OF_CLAIM: dict[str, dict[str, Check]] = {
    "inward": {}, "elastic": {}, "decay": {}, "power": _SLOPE, "slope sign": _SLOPE,
    "lipschitz": {**_POWERS, "sign": _sign, "l": rational, "m": _whole(0, HIGHEST)},
    "growth": {**_POWERS, "l": rational}, "finite": {**_POWERS, "sign": _sign},
    "excess": {"k": rational, "above": rational, "N": rational}, "divisor": {"expression": _EXPRESSION}, "switching": {},
}  # fmt: skip
_SWITCHING: dict[str, Check] = {  # of these the checker needs "there" alone: the forms it builds itself
    "a": _EXPRESSION, "b": _EXPRESSION, "condition": _formula("u", "w", condition=True), "axis": _one_of("v", "z"),
    "side": _whole(-1, 1), "order": _whole(0, 1), "there": _list(_row(_EXPRESSION, _EXPRESSION)),
}  # fmt: skip
_ANY: dict[str, Check] = {
    "about": _one_of(*_OF_CLAIM), "v": _whole(-1, 1), "z": _whole(-1, 1), "relation": _one_of(*RELATIONS)
}  # fmt: skip
_TREE: dict[str, Check] = {"tree": tree}
_RANGES: dict[str, Check] = {"u": _range, "w": _range}  # one that is left out is everything
CLAIMS = {
    about: Table({**_ANY, **own, **_TREE}, _RANGES)
    if about != "switching"
    else Table(_ANY, {**_RANGES, **_SWITCHING, **_TREE})
    for about, own in _OF_CLAIM.items()
}


def claim(data: Json) -> None:
    """A claim's fields by what it is about.

    Raises:
        Refused: one is missing, of another type, or unknown.
    """
    if not isinstance(data, dict):
        raise Refused(f"a claim must be a table: {data!r}")
    about = data.get("about")
    if not isinstance(about, str) or about not in CLAIMS:
        raise Refused(f"no claim is about {about!r}")
    CLAIMS[about].check(f"claim {about}", data)


# -- theorems -------------------------------------------------------------------------------------------------------------

_CELL = _row(_sign, rational, rational, rational)
DATA = {  # what each theorem's data may have
    ("bounded", "outside"): Table({}, {}),
    ("bounded", "edge"): Table({}, {}),
    ("unique", "lipschitz"): Table({}, {"within": _within}),
    ("smooth", "switching"): Table({}, {"of": _list(_one_of("dz_dt", "force"))}),
    ("passive", "storage"): Table({}, {**_SLOPE, "own_up_to": rational, "cells": _list(_CELL)}),
    ("passive", "damped"): Table(
        dict.fromkeys(("k", "s", "d", "c", "N", "above"), rational), {"knots": _list(rational)}
    ),
    ("drift_free", "elastic"): Table({"z_0": rational}, {}),
}
HYPOTHESES = {  # properties that it may rest on
    ("bounded", "edge"): ("unique",), ("unique", "lipschitz"): ("bounded",), ("passive", "storage"): ("bounded",)
}  # fmt: skip
