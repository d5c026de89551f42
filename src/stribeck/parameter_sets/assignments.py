"""Assignments ``PATH=VALUE``, as in ``--set``."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from typing import Any

from stribeck.errors import InputError, arg, refuse_twice

Toml = Any  # a value as tomllib gives it
_DECIMAL = re.compile(r"[+-]?(\d+\.|\.\d+)([eE][+-]?\d+)?")  # .5 or 5., where TOML wants digits on both sides


def parse_assignment(text: str) -> tuple[str, Toml]:
    """Read ``PATH=VALUE`` as a path and a TOML value; ``.5`` and ``5.`` are numbers too, anything else is text.

    Raises:
        InputError: if there is no '=' or no path.
    """
    path, sign, value = text.partition("=")
    path = path.strip()
    if not sign or not all(path.split(".")):
        raise InputError(f"{arg('changes')} {text!r}: must be PATH=VALUE, such as law.parameters.F_s=2.0")
    try:
        read = tomllib.loads(f"x = {value}")
    except (ValueError, RecursionError):
        text = value.strip()
        return path, float(text) if _DECIMAL.fullmatch(text) else text
    return path, read["x"] if len(read) == 1 else value.strip()


def parse_assignments(texts: Iterable[str]) -> dict[str, Toml]:
    """The values of several ``PATH=VALUE`` (:func:`parse_assignment`), by path.

    Raises:
        InputError: if one is invalid, or two have the same path.
    """
    pairs = [parse_assignment(text) for text in texts]
    refuse_twice([path for path, _ in pairs], arg("changes"))
    return dict(pairs)
