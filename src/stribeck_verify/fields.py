"""Fields of a certificate by their type, before anything is made of them; and text for a terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import fmpq

from stribeck_verify.expressions import Json, Refused, rational

_LONGEST = 200  # characters of what a file says that are printed


def escaped(text: object, longest: int = _LONGEST) -> str:
    """Text of a file as one line of printable ASCII; what is not that is escaped, what is long is cut."""
    words = str(text)
    cut = words if len(words) <= longest else words[:longest] + "..."
    return "".join(c if c.isascii() and c.isprintable() else ascii(c)[1:-1] for c in cut)


def text(data: Mapping[str, Json], key: str, allowed: Sequence[str] | None = None) -> str:
    """A field that is text, one of those allowed where these are given.

    Raises:
        Refused: it is missing, or something else.
    """
    value = data.get(key)
    if not isinstance(value, str) or (allowed is not None and value not in allowed):
        words = "text" if allowed is None else " or ".join(allowed)
        raise Refused(f"{key}: {_shown(data, key)}: must be {words}")
    return value


def table(data: Mapping[str, Json], key: str) -> dict[str, Json]:
    """A field that is a table; an empty one where it is missing.

    Raises:
        Refused: it is something else.
    """
    value = data.get(key, {})
    if not isinstance(value, dict):
        raise Refused(f"{key}: {_shown(data, key)}: must be a table")
    return value


def items(data: Mapping[str, Json], key: str) -> list[Json]:
    """A field that is a list; an empty one where it is missing.

    Raises:
        Refused: it is something else.
    """
    value = data.get(key, [])
    if not isinstance(value, list):
        raise Refused(f"{key}: {_shown(data, key)}: must be a list")
    return value


def whole(data: Mapping[str, Json], key: str, least: int, most: int) -> int:
    """A field that is a whole number.

    Raises:
        Refused: it is missing, something else, or beyond its limits.
    """
    value = data.get(key)
    if type(value) is not int or not least <= value <= most:
        raise Refused(f"{key}: {_shown(data, key)}: must be a whole number from {least} to {most}")
    return value


def limit(data: Mapping[str, Json], key: str) -> fmpq | None:
    """A field that is a rational number > 0, or "inf" (None), which it is where it is missing.

    Raises:
        Refused: it is something else.
    """
    stated = data.get(key, "inf")
    if stated == "inf":
        return None
    try:
        value = rational(stated)
    except Refused:
        value = fmpq(0)
    if value <= 0:
        raise Refused(f'{key}: {_shown(data, key)}: must be "inf" or a rational number > 0, as text')
    return value


def _shown(data: Mapping[str, Json], key: str) -> str:
    return repr(data[key]) if key in data else "missing"
