"""Assignments ``PATH=VALUE``, as in ``--set``."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from typing import Any

from stribeck.errors import InputError, arg, read_pairs

Toml = Any  # a value as tomllib gives it
_DECIMAL = re.compile(r"[+-]?(\d+\.|\.\d+)([eE][+-]?\d+)?")  # .5 or 5., where TOML wants digits on both sides


def parse_assignment(text: str) -> tuple[str, Toml]:
    """Read ``PATH=VALUE`` as a path and a value (:func:`value_of`).

    Raises:
        InputError: if there is no '=' or no path.
    """
    path, sign, value = text.partition("=")
    path = path.strip()
    if not sign or not all(path.split(".")):
        raise InputError(f"{arg('set')} {text!r}: must be PATH=VALUE, such as law.parameters.F_s=2.0")
    return path, value_of(value)


def value_of(text: str) -> Toml:
    """The TOML value that a text is; ``.5`` and ``5.`` are numbers too, anything else is text."""
    text = text.strip()
    try:
        read = tomllib.loads(f"x = {text}")
    except (ValueError, RecursionError):
        return float(text) if _DECIMAL.fullmatch(text) else text
    return read["x"] if len(read) == 1 else text


def parse_assignments(texts: Iterable[str]) -> dict[str, Toml]:
    """The values of several ``PATH=VALUE`` (:func:`parse_assignment`), by path.

    Raises:
        InputError: a line for each that is invalid, and for each path that several have.
    """
    return read_pairs(parse_assignment, texts, arg("set"))
