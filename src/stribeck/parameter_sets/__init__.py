"""Friction parameters of known machines, in data files with their sources."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from stribeck.constants import show
from stribeck.errors import InputError, nearest, note
from stribeck.files import read_file

_FOLDER = Path(__file__).parent
_MOTIONS = ("linear", "rotary")


def _number(x: object) -> bool:
    return isinstance(x, int | float) and not isinstance(x, bool)


# The keys beside the value in a number's table: a check, and the allowed type in words.
_ENTRY_KEYS: dict[str, tuple[Callable[[object], bool], str]] = {
    "determined": (lambda x: isinstance(x, bool), "true or false"), "unit": (lambda x: isinstance(x, str), "text"),
    "low": (_number, "a number"), "high": (_number, "a number"),
}  # fmt: skip


@dataclass(frozen=True)
class ParameterSet:
    """A machine's friction parameters in SI units (N, m; for a rotary machine N m, rad), with their source."""

    name: str
    title: str
    source: str
    motion: str  # "linear" or "rotary"
    values: dict[str, float] = field(hash=False)
    undetermined: tuple[str, ...] = ()  # values of a fit that its data do not determine
    units: dict[str, str] = field(default_factory=dict, hash=False)  # those in the file
    words: tuple[str, ...] = ()  # keys with text in a file without [parameters]
    left_out: tuple[str, ...] = ()  # friction that a fit found and that its law has no constant for

    @property
    def rotary(self) -> bool:
        """Whether the machine is rotary: N m instead of N, rad instead of m."""
        return self.motion == "rotary"


@lru_cache(maxsize=1)
def _built_in() -> dict[str, ParameterSet]:
    return {path.stem: _read(path) for path in sorted(_FOLDER.glob("*.toml"))}


def parameters() -> dict[str, ParameterSet]:
    """A copy of every built-in parameter set, by name."""
    return {name: replace(each, values=dict(each.values)) for name, each in _built_in().items()}


_allowed = [False]  # for all threads: the lanes of a sweep read what the command allows


def allow_undetermined(allowed: bool = True) -> None:
    """Allow sets with numbers that the data behind them do not determine, from here on.

    Args:
        allowed: False, the initial setting, makes :func:`load` raise an error for them.
    """
    _allowed[0] = allowed


def load(name: str, folder: Path | None = None, needs: Container[str] | None = None) -> ParameterSet:
    """A built-in set by name, or the set in a TOML file, its path relative to ``folder``.

    A file has its numbers in ``[parameters]`` or at the top. A number may also be a table with a ``value``, and with
    ``determined = false`` if a fit could not identify it (:func:`allow_undetermined`).

    Args:
        name: the set's name, or a file NAME.toml.
        folder: the folder of the file.
        needs: the parameters in use, such as the constants of a law; all unless given.

    Raises:
        InputError: if there is no such set, its file cannot be read, or parameters in use are not determined.
    """
    if name in parameters():
        return parameters()[name]
    if name.endswith(".toml"):
        parameter_set = _read((folder or Path()) / name)
        undetermined = [n for n in parameter_set.undetermined if needs is None or n in needs]
        if undetermined and not _allowed[0]:
            raise InputError(
                f"{name!r}: the data of this fit do not determine {', '.join(undetermined)}: give values of your own with "
                "--set, allow the best ones with --allow-undetermined (stribeck.parameter_sets.allow_undetermined()), or measure "
                "the experiment that the file names"
            )
        if parameter_set.left_out and needs != ():
            note(
                f"{name!r}: the fit found friction that these constants leave out: {', '.join(parameter_set.left_out)}"
            )
        return parameter_set
    guess = nearest(name, parameters()) or f" (known: {', '.join(parameters())}; or a file NAME.toml)"
    raise InputError(f"{name!r}: no such parameter set{guess}")


def read_toml(path: Path) -> dict[str, Any]:
    """The content of a TOML file.

    Raises:
        InputError: if the file cannot be read, or is not TOML.
    """
    try:
        return tomllib.loads(read_file(path).decode("utf-8-sig"))  # some editors write a byte order mark
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
    left_out = data.pop("left_out", None)
    table = data.get("parameters", {k: v for k, v in data.items() if k not in ("schema", "name")})
    if not isinstance(table, dict):
        raise InputError(f"{path}: parameters must be a table of numbers")
    problems = [text for k, v in table.items() if isinstance(v, dict) and (text := _entry_problem(k, v))]
    if words["motion"] not in ("", *_MOTIONS):
        problems.append(f"motion: {show(words['motion'])}: must be {' or '.join(_MOTIONS)}")
    if problems:
        raise InputError([f"{path}: {text}" for text in problems])
    values = {k: v["value"] if isinstance(v, dict) else v for k, v in table.items()}
    unknown = tuple(k for k, v in table.items() if isinstance(v, dict) and v.get("determined") is False)
    units = {k: v["unit"] for k, v in table.items() if isinstance(v, dict) and "unit" in v}
    beside = () if "parameters" in data else tuple(k for k, x in values.items() if isinstance(x, str))
    return ParameterSet(
        path.stem, words["title"], words["source"], words["motion"] or "linear", values, unknown, units, beside,
        tuple(map(str, left_out)) if isinstance(left_out, list) else (),
    )  # fmt: skip


def _entry_problem(name: str, entry: Mapping[str, object]) -> str | None:
    """The mistake in the table of one number, apart from the number itself."""
    if "value" not in entry:
        return f"{name}: {show(entry)}: must be a number, or a table with its value"
    for key, (holds, must) in _ENTRY_KEYS.items():
        if key in entry and not holds(entry[key]):
            return f"{name}.{key}: {show(entry[key])}: must be {must}"
    low, value, high = (entry.get(key, end) for key, end in (("low", -math.inf), ("value", None), ("high", math.inf)))
    if isinstance(low, int | float) and isinstance(high, int | float):
        if low > high:
            return f"{name}: low = {show(low)} must not be above high = {show(high)}"
        if isinstance(value, int | float) and not low <= value <= high:
            return f"{name}.value: {show(value)}: must lie in its interval, {show(low)} to {show(high)}"
    return None
