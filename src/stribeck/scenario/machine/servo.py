"""A pneumatic piston among the bodies of a machine, and the pressure cascade that moves its valve."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace

from stribeck.constants import show
from stribeck.control.cascade import PressureCascade
from stribeck.laws.base import Law
from stribeck.machine.parts import BodyPart, DrivePart, SignalUse
from stribeck.plants.cylinder import Cylinder
from stribeck.scenario import tables
from stribeck.scenario.cascade import CascadeSettings
from stribeck.scenario.drives import drive_table
from stribeck.scenario.law import unknown
from stribeck.scenario.machine.reading import Reading
from stribeck.scenario.parts import Parts
from stribeck.scenario.tables import Problem
from stribeck.signals import Signal

PISTON = Cylinder.kind
CONTROLLER = "pressure_cascade"
_NOT_OWN = ("on", "kind")  # of the controller's keys, what the cascade of schema 1 does not have


def is_piston(table: object) -> bool:
    """Whether the table of a body is that of a piston."""
    return isinstance(table, Mapping) and table.get("kind") == PISTON


class ServoReader:
    """Reads the tables of one piston and of the cascade on it; ``problems`` bear the machine's paths."""

    def __init__(self, body: str, path: str, folder: Path, executes: bool) -> None:
        self.body, self.path, self.folder, self.executes = f"bodies.{body}", path, folder, executes
        self.problems: list[Problem] = []

    def piston(self, table: Mapping[str, object]) -> tables.StrictTable | None:
        """The constants and the start of the piston."""
        values, found = tables.validate(tables.plant_table(Cylinder, False), table, self.body)
        self.problems += found
        start = table.get("initial")
        if isinstance(start, Mapping) and "z" in start:
            text = "must be left out: the bristles of a contact start at 0"
            self.problems.append((f"{self.body}.initial.z", f"{show(start['z'])}: {text}"))
        if values is not None:
            p, initial = self._numbers(values), dict(dict(values)["initial"])
            self._note([(f"plant.{key}", text) for key, text in Cylinder.problems(p, initial)])
        return values

    @staticmethod
    def _numbers(values: tables.StrictTable) -> SimpleNamespace:
        return SimpleNamespace(**{n: getattr(values, n) for n in Cylinder.constants})

    def cascade(
        self, table: Mapping[str, object], law: Law | None, piston: tables.StrictTable | None
    ) -> tuple[tables.StrictTable, CascadeSettings] | None:
        """The constants of the controller and what it has beside them; None where something is wrong."""
        own = {key: x for key, x in table.items() if key not in _NOT_OWN} | {"kind": PressureCascade.kind}
        model = drive_table(PressureCascade.kind)
        strange = unknown(own, self.path, model.model_fields)
        values, found = tables.validate(model, own, self.path)
        self.problems += strange or found
        settings, more = CascadeSettings.read(values, own, law, piston, self.folder, self.executes)
        self._note(more)
        if values is None or not isinstance(settings, CascadeSettings):
            return None
        return values, settings

    def judge(
        self, settings: CascadeSettings, law: Law, signal: Signal, piston: tables.StrictTable, t_end: float
    ) -> None:
        """What is wrong with the period and the path."""
        solve = tables.Solve.model_validate({"t_end": t_end})
        parts = Parts(law=law, signal=signal, plant_values=vars(self._numbers(piston)), solve=solve)
        self._note(settings.judge(parts))

    def _note(self, problems: list[Problem]) -> None:
        """Keep problems that are told in the words of schema 1."""
        for path, text in problems:
            self.problems.append((self._here(path), self._here(text)))

    def _here(self, text: str) -> str:
        return text.replace("drive.", f"{self.path}.").replace("plant.", f"{self.body}.")


def drive_of(name: str, on: str, settings: CascadeSettings, values: tables.StrictTable, use: SignalUse) -> DrivePart:
    """The controller's structure."""
    given = [n for n in PressureCascade.constants if getattr(values, n) is not None]
    return DrivePart(name, settings.drive(PressureCascade, given), on, use)


def not_a_piston(on: object) -> str:
    """What is wrong with where the controller is."""
    return f"{show(on)}: must be a body with kind = {PISTON!r}, whose valve this controller moves"


class ServoTables(Reading):
    """Reads the tables of pistons and of the cascades on them."""

    def _piston(self, name: str, table: dict[str, object]) -> BodyPart | None:
        reader = ServoReader(name, "", self.folder, self.executes)
        values = reader.piston(table)
        self.problems += reader.problems
        if self.energy:
            self.problems.append(("output.energy", f"true: must be false with bodies.{name}, a pneumatic piston"))
        if values is None:
            return None
        self.pistons[name] = values
        self.values |= {(f"bodies.{name}", n): getattr(values, n) for n in Cylinder.constants}
        self.initial |= {f"{name}.{n}": x for n, x in dict(dict(values)["initial"]).items()}
        return BodyPart(name, False, plant=Cylinder)

    def _servo(self, name: str, path: str, table: dict[str, object]) -> None:
        """A pressure cascade, which moves a piston's valve."""
        on = table.get("on")
        body = self.named["bodies"].get(on) if isinstance(on, str) else None
        if not is_piston(body):
            if isinstance(body, dict) and "kind" in body:
                return  # which is told
            text = "missing: must be given (the piston)" if on is None else not_a_piston(on)
            self.problems.append((f"{path}.on", text))
            return
        assert isinstance(on, str)
        if other := next((drive for drive in self.drives if drive.on == on), None):
            text = f"{show(on)}: must be another body: {other.path} drives it already"
            self.problems.append((f"{path}.on", text))
        reader = ServoReader(on, path, self.folder, self.executes)
        law, piston = self._law_of(on), self.pistons.get(on)
        found = reader.cascade(table, law, piston)
        use = self._signal(table["signal"], f"{path}.signal", name) if isinstance(table.get("signal"), dict) else None
        solve = self.data.get("solve")
        t_end = solve.get("t_end") if isinstance(solve, dict) else None
        if found is not None and use is not None and law is not None and piston is not None and not reader.problems:
            values, settings = found
            drive = drive_of(name, on, settings, values, use)
            if isinstance(t_end, int | float) and t_end > 0:
                reader.judge(settings, law, self.signals[use], piston, float(t_end))
            self.drives.append(drive)
            self.settings[name] = settings
            own = {("drive", n): x for n in PressureCascade.constants if (x := getattr(values, n)) is not None}
            self.values |= {(drive.table(owner), n): x for (owner, n), x in {**own, **settings.values()}.items()}
            self.initial |= {f"{name}.{n}": x for n, x in drive.drive.starts.items()}
        self.problems += reader.problems
        if law is None and not self.problems:
            text = f"{show(on)}: must have a contact with the ground, whose friction the cascade knows"
            self.problems.append((f"{path}.on", text))

    def _law_of(self, body: str) -> Law | None:
        """The law of a body's first contact with the ground."""
        for name, table in self.named["contacts"].items():
            if isinstance(table, dict) and table.get("from") == body and table.get("to", "ground") == "ground":
                return self.laws.get(f"contacts.{name}.law")
        return None
