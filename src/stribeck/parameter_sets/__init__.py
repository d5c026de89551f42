"""Parameters of known machines: data files, each with its source."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from stribeck.constants import show
from stribeck.errors import InputError, nearest
from stribeck.files import read_file

_FOLDER = Path(__file__).parent
_MOTIONS = ("linear", "rotary")


def _number(x: object) -> bool:
    return isinstance(x, int | float) and not isinstance(x, bool)


# What may stand beside a number in its table, and that in words.
_BESIDE: dict[str, tuple[Callable[[object], bool], str]] = {
    "determined": (lambda x: isinstance(x, bool), "true or false"), "unit": (lambda x: isinstance(x, str), "text"),
    "low": (_number, "a number"), "high": (_number, "a number"),
}  # fmt: skip


@dataclass(frozen=True)
class ParameterSet:
    """A machine's friction parameters in SI units (N, m; for a rotary machine N m, rad) and where they are from."""

    name: str
    title: str
    source: str
    motion: str  # "linear" or "rotary"
    values: dict[str, float] = field(hash=False)
    undetermined: tuple[str, ...] = ()  # values that a fit wrote, and that its data do not determine
    units: dict[str, str] = field(default_factory=dict, hash=False)  # where the file tells them
    words: tuple[str, ...] = ()  # text that stands beside the numbers of a file without [parameters]

    @property
    def rotary(self) -> bool:
        """Whether the machine turns: N m in the place of N, rad in that of m."""
        return self.motion == "rotary"


@lru_cache(maxsize=1)
def _built_in() -> dict[str, ParameterSet]:
    return {path.stem: _read(path) for path in sorted(_FOLDER.glob("*.toml"))}


def parameters() -> dict[str, ParameterSet]:
    """Every built-in parameter set by name; a copy, to be changed at will."""
    return {name: replace(each, values=dict(each.values)) for name, each in _built_in().items()}


_allowed = [False]  # for every thread: a sweep's lanes read what the command allowed


def allow_undetermined(allowed: bool = True) -> None:
    """Whether sets may be used that hold numbers which the data behind them do not determine, from here on.

    Args:
        allowed: False refuses them, as at first.
    """
    _allowed[0] = allowed


def load(name: str, folder: Path | None = None, needs: Container[str] | None = None) -> ParameterSet:
    """A built-in set by name, or the set in a TOML file, its path relative to ``folder``.

    A file holds its numbers in ``[parameters]`` or at the top; a number may also be a table with a ``value``, and with
    ``determined = false`` where a fit could not tell it (:func:`allow_undetermined`).

    Args:
        needs: what is taken from it, such as the constants of a law; all unless given.

    Raises:
        InputError: there is no such set, its file cannot be read, or numbers that are taken are not determined.
    """
    if name in parameters():
        return parameters()[name]
    if name.endswith(".toml"):
        found = _read((folder or Path()) / name)
        open_ones = ", ".join(n for n in found.undetermined if needs is None or n in needs)
        if open_ones and not _allowed[0]:
            raise InputError(
                f"{name!r}: the data of this fit do not determine {open_ones}: allow their best values with "
                "--allow-undetermined (stribeck.parameter_sets.allow_undetermined()), or measure what [unknown] in it says"
            )
        return found
    guess = nearest(name, parameters()) or f" (known: {', '.join(parameters())}; or a file NAME.toml)"
    raise InputError(f"{name!r}: no such parameter set{guess}")


def read_toml(path: Path) -> dict[str, Any]:
    """The content of a TOML file.

    Raises:
        InputError: the file cannot be read, or is not TOML.
    """
    try:
        return tomllib.loads(read_file(path).decode("utf-8-sig"))  # some editors begin a file with a mark
    except OSError as error:
        text = f"cannot be read: {error.strerror}"
    except MemoryError:
        text = "cannot be read: it does not fit into memory"
    except UnicodeDecodeError:
        text = "is not text in UTF-8"
    except tomllib.TOMLDecodeError as error:
        text = f"is not TOML: {error}"
    except ValueError:
        text = "cannot be read: the path or a number in it is impossible"
    except RecursionError:
        text = "cannot be read: its lists or tables are nested too deeply"
    raise InputError(f"{path}: {text}")


def _read(path: Path) -> ParameterSet:
    data = read_toml(path)
    words = {key: str(data.pop(key, "")) for key in ("title", "source", "motion")}
    table = data.get("parameters", {k: v for k, v in data.items() if k not in ("schema", "name")})
    if not isinstance(table, dict):
        raise InputError(f"{path}: parameters must be a table of numbers")
    problems = [text for k, v in table.items() if isinstance(v, dict) and (text := _wrong(k, v))]
    if words["motion"] not in ("", *_MOTIONS):
        problems.append(f"motion: {show(words['motion'])}: must be {' or '.join(_MOTIONS)}")
    if problems:
        raise InputError([f"{path}: {text}" for text in problems])
    values = {k: v["value"] if isinstance(v, dict) else v for k, v in table.items()}
    unknown = tuple(k for k, v in table.items() if isinstance(v, dict) and v.get("determined") is False)
    units = {k: v["unit"] for k, v in table.items() if isinstance(v, dict) and "unit" in v}
    beside = () if "parameters" in data else tuple(k for k, x in values.items() if isinstance(x, str))
    return ParameterSet(
        path.stem, words["title"], words["source"], words["motion"] or "linear", values, unknown, units, beside
    )


def _wrong(name: str, told: Mapping[str, object]) -> str | None:
    """What is wrong with the table of one number, but for the number."""
    if "value" not in told:
        return f"{name}: {show(told)}: must be a number, or a table with its value"
    for key, (holds, must) in _BESIDE.items():
        if key in told and not holds(told[key]):
            return f"{name}.{key}: {show(told[key])}: must be {must}"
    return None
