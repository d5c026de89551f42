"""Machines with their parameters, published or fitted from public records, each with its source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

from stribeck.parameter_sets import read_toml

_FOLDER = Path(__file__).parent / "machines"
_WORDS = ("title", "source", "license", "date", "record", "origin", "command", "holds")


@dataclass(frozen=True)
class MachineSet:
    """A machine of the library.

    Attributes:
        source, license, record: who measured (and, if published, fitted) it, the record's license and its address.
        origin: "published", or "fitted" by ``command`` from the record.
        date: of the fit, or of the publication.
        holds: the speeds and loads for which it is valid, in words.
        parameters: the fitted values by path: value, unit, verdict and, if available, low and high.
        machine: the machine's tables (``schema = 2``), for :class:`stribeck.Scenario`.
    """

    name: str
    title: str
    source: str
    license: str
    date: str
    record: str
    origin: str
    command: str
    holds: str
    parameters: Mapping[str, Mapping[str, object]]
    machine: Mapping[str, object]

    def to_dict(self) -> dict[str, object]:
        """The set as ``stribeck library --json`` prints it."""
        return asdict(self)


@lru_cache(maxsize=1)
def machine_sets() -> dict[str, MachineSet]:
    """Every machine of the library by name."""
    sets = {}
    for path in sorted(_FOLDER.glob("*.toml")):
        data = read_toml(path)
        words = {key: str(data.get(key, "")) for key in _WORDS}
        sets[path.stem] = MachineSet(path.stem, **words, parameters=data["parameters"], machine=data["machine"])
    return sets
