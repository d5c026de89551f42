"""A law on a plant under a drive (``schema = 1``) with its values: what the solvers take of it, as of a machine's rig."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace

from stribeck.arrays import Array
from stribeck.drives import Drive
from stribeck.expressions.ops import Value, sqrt
from stribeck.laws.base import Law
from stribeck.scenario.parts import Parts, Settings
from stribeck.signals import Signal
from stribeck.signals.pieces import Pieces, pieces
from stribeck.system import Groups, System


@dataclass(frozen=True)
class Single:
    """The structure of the one body's system with the values of its constants, its signal and its law."""

    parts: Parts

    @cached_property
    def equations(self) -> System:
        """The structure of the equations, without values."""
        return self.parts.system()

    @property
    def law(self) -> Law:
        """The friction law."""
        assert self.parts.law is not None
        return self.parts.law

    @property
    def laws(self) -> dict[str, Law]:
        """The law by the table of its constants."""
        return {"law": self.law}

    @property
    def named_laws(self) -> dict[str, Law]:
        """The law by the name of its element, of which it has none."""
        return {"": self.law}

    @property
    def compared(self) -> tuple[str, ...]:
        """The columns in which laws are compared."""
        return "y", "v", "F"

    @property
    def signal(self) -> Signal:
        """What the drive follows."""
        assert self.parts.signal is not None
        return self.parts.signal

    @property
    def drive(self) -> Drive:
        """The drive's structure."""
        return self.equations.drive

    @property
    def settings(self) -> Settings:
        """What the drive has beside its constants and its signal."""
        return self.parts.settings or Settings()

    @property
    def subject(self) -> str:
        """What it is about, in a few words."""
        return f"law {self.law.name}"

    @property
    def label(self) -> str:
        """What its line in a plot is called."""
        return self.law.name

    @property
    def rotary(self) -> bool:
        """Whether the one body turns."""
        return self.law.rotary

    @property
    def mass(self) -> float | None:
        """The mass that the drive moves without anything between; None where there is none."""
        assert self.parts.plant is not None
        mass: float | None = self.parts.plant.inertia(SimpleNamespace(**self.parts.plant_values or {}))
        return mass

    @property
    def threshold(self) -> float:
        """The speed that slip and stick are told by: v_s, or 0 (none) where the parameters have no v_s."""
        return self.law.machine.get("v_s", 0.0)

    @property
    def groups(self) -> Groups:
        """The constants by owner, for evaluating the system's equations with NumPy."""
        plant, drive = (SimpleNamespace(**x or {}) for x in (self.parts.plant_values, self.parts.drive_values))
        return Groups(self.law.p, plant, drive, SimpleNamespace(**self.signal.values))

    @property
    def values(self) -> dict[tuple[str, str], float]:
        """The run-time constants by (group, name)."""
        found = {("law", n): x for n, x in self.law.p.numbers.items()}
        found |= {("drive", n): x for n, x in (self.parts.drive_values or {}).items()}
        found |= {("signal", n): x for n, x in self.signal.values.items()} if self.signal.smooth else {}
        found |= {("plant", n): x for n, x in (self.parts.plant_values or {}).items()}
        return found | self.settings.values()

    @property
    def longest_step(self) -> float:
        """The longest step that cannot miss a wave of the signal, s."""
        return self.signal.longest_step

    def pieces(self, t_end: float) -> Pieces:
        """The signal as a table."""
        return pieces(self.signal)

    def thresholds(self) -> list[float]:
        """The level of each watched quantity, 0 for none."""
        return [self.threshold] * len(self.equations.watched)

    def sampling(self) -> list[dict[str, float]]:
        """Period, delay, noise and seed of a sampled drive."""
        return self.settings.sampling_of()

    def more_events(self, reached: float) -> list[tuple[float, int]]:
        """Events that no state tells, as far as a run came: where the velocity is the signal, those of the signal."""
        if not self.drive.sets_velocity or not self.threshold > 0:
            return []
        return [(t, int(not rises)) for t, rises in self.signal.crossings(self.threshold, reached)]

    def columns(self, t: Array, states: dict[str, Array], held: dict[str, Array], t_end: float) -> dict[str, Value]:
        """Every column of the output by name, from the states and what a controller held at the times t."""
        system = self.equations
        if not system.drive.differentiates:
            return system.quantities(self.groups, self.signal.at(t), states)
        values, rows = self.values, self.pieces(t_end).at(t)
        inputs: dict[str, Value] = {f"{owner}.{name}": values[owner, name] for owner, name in system.parameters}
        inputs |= {f"segment.{name}": rows[:, i] for i, name in enumerate(system.piece_fields)}
        inputs |= {f"segment.{name}": held[name] for name in system.held}
        inputs |= {f"memory.{name}": held[name] for name in system.shown}
        return system.table({**inputs, "t": t, **states})

    def natural(self, constants: Groups | None = None) -> dict[str, Value]:
        """The natural magnitude of each state, with other constants where they are given."""
        q, plant = self.groups if constants is None else constants, self.parts.plant
        assert plant is not None
        scales = self.law.scales(q.law)
        found = {"y": scales.length, "v": scales.speed, "z": scales.length}
        found |= dict.fromkeys(("E_in", "E_dissipated"), scales.force * scales.length)
        own = plant.state_scales(q.plant, scales.length, scales.speed, scales.force)
        found |= dict(zip((s.name for s in plant.states), own, strict=True))
        found |= self.drive.scales(q.drive, scales.length, scales.force)
        return {s.name: found[s.name] for s in self.equations.states}

    def damping(self, constants: Groups | None = None) -> Value:
        """The damping ratio of the body on its bristles at rest; infinite where there is no such thing."""
        q, plant = self.groups if constants is None else constants, self.parts.plant
        assert plant is not None
        p, mass = q.law, plant.inertia(q.plant)
        sigma_0 = getattr(p, "sigma_0", None)
        if sigma_0 is None or mass is None or self.drive.sets_velocity or not self.law.has_z:
            return float("inf")
        given = [getattr(p, name, None) for name in ("sigma_1", "sigma_2")]
        return (sum(x for x in given if x is not None) + getattr(q.drive, "K_d", 0.0)) / (2 * sqrt(sigma_0 * mass))
