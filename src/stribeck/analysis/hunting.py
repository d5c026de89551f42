"""Describing functions of friction, and the limit cycle that they predict of a PID loop."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import require_positive, show
from stribeck.drives.pid import Pid
from stribeck.errors import InputError, StribeckError, needed
from stribeck.laws import table
from stribeck.laws.base import Law
from stribeck.plants.mass import Mass
from stribeck.scenario import Scenario
from stribeck.simulation import simulate

_ROWS = 1024  # of a cycle
_GRID = 16  # sizes and frequencies tried, each
_BALANCED = 1e-4  # what may be left of a harmonic balance, as a share of its terms


@dataclass(frozen=True)
class Hunting:
    """A limit cycle that describing functions predict: amplitude (m) and period (s) of the position, both nan where
    they predict none; ``mismatch`` is what is left of the harmonic balance, as a share of its terms."""

    amplitude: float
    period: float
    mismatch: float


def describing_function(law: Law, amplitude: float, frequency: float = 1.0) -> complex:
    """First harmonic of F over that of v = amplitude cos(2 pi frequency t), N s/m: the real part dissipates.

    Args:
        law: the law.
        amplitude: of the velocity, m/s.
        frequency: Hz; laws without z do not depend on it.

    Raises:
        InputError: an argument is not a finite number > 0.
        StribeckError: the simulation failed.
    """
    require_positive("amplitude", amplitude, "m/s")
    require_positive("frequency", frequency, "Hz")
    if not law.has_z:
        angle = (np.arange(_ROWS) + 0.5) * 2 * np.pi / _ROWS
        return _harmonic(angle, law.force(amplitude * np.cos(angle))) / amplitude
    return _harmonic(*_last_cycle(law, "velocity", amplitude, frequency, None, "F")) / amplitude


def hunting(scenario: Scenario, of: str = "law") -> Hunting:
    """The limit cycle of a PID loop that first harmonics predict.

    ``of="law"`` takes position and velocity as sinusoidal and the law's first harmonic, as textbooks do.
    ``of="body"`` takes the controller's force as sinusoidal and the first harmonic of the body that it moves, which
    sticks and slips. Friction's cycles are far from sinusoidal: compare with the simulation.

    Raises:
        InputError: the scenario's drive is not a PID controller, its plant not a single mass, or ``of`` is neither.
        StribeckError: a simulation failed.
    """
    if scenario.drive is not Pid:
        raise InputError(f"drive.kind: {scenario.drive.kind!r}: must be 'pid' to hunt")
    if scenario.plant is not Mass:
        raise InputError(f"plant.kind: {scenario.data['plant']['kind']!r}: must be {Mass.kind!r} to hunt")
    if of not in ("law", "body"):
        raise InputError(f"of: {show(of)}: must be 'law' or 'body'")
    with needed("hunting()"):
        from scipy.ndimage import minimum_filter
        from scipy.optimize import least_squares

    loop = _Loop(scenario, of)
    low, high = loop.box()
    shares = (np.stack(np.meshgrid(np.arange(_GRID), np.arange(_GRID), indexing="ij"), -1) + 0.5) / _GRID
    grid = low + (high - low) * shares
    rough = np.apply_along_axis(lambda x: math.hypot(*loop.residual(x)), -1, grid)
    valleys = rough == minimum_filter(rough, size=3)
    best = Hunting(math.nan, math.nan, math.inf)
    for start in grid[valleys]:
        found = least_squares(
            loop.residual, start, bounds=(low, high), diff_step=[1e-4], xtol=1e-12, ftol=1e-12, max_nfev=30
        )
        mismatch = math.hypot(*found.fun)
        if mismatch < best.mismatch:
            cycle = loop.cycle(found.x) if mismatch < _BALANCED else (math.nan, math.nan)
            best = Hunting(*cycle, mismatch)
    return best


@dataclass
class _Loop:
    """The harmonic balance of a PID loop; x holds the logarithms of a size and of the angular frequency.

    The size is the amplitude of the velocity (``of="law"``) or of the force on the body (``of="body"``).
    """

    scenario: Scenario
    of: str
    known: dict[tuple[float, float], complex] = field(default_factory=dict)

    def box(self) -> tuple[Array, Array]:
        """Where a cycle is looked for."""
        law, values = self.scenario.law, self.scenario.values()
        mass = values["plant", "mass"]
        natural = math.sqrt(abs(values["drive", "K_p"]) / mass) or 1.0
        scales = law.scales(law.p)
        sizes = (0.5 * scales.force, 4 * scales.force)
        if self.of == "law":
            sizes = (1e-2 * scales.speed, 30 * scales.force / (mass * natural))
        return np.log([sizes[0], natural / 30]), np.log([sizes[1], natural * 30])

    def residual(self, x: Array) -> list[float]:
        """What is left of controller * body = 1, as a share of the terms."""
        size, omega = (float(a) for a in np.exp(x))
        loop = self.controller(omega) * self.body(size, omega)
        error = (loop - 1) / (abs(loop) + 1)
        return [error.real, error.imag]

    def cycle(self, x: Array) -> tuple[float, float]:
        """Amplitude of the position and period."""
        size, omega = (float(a) for a in np.exp(x))
        speed = size if self.of == "law" else abs(self.body(size, omega)) * size
        return speed / omega, 2 * math.pi / omega

    def controller(self, omega: float) -> complex:
        """Force over velocity: the drive's own equations on phasors."""
        p, y, v = SimpleNamespace(**self.scenario.drive_values), 1 / (1j * omega), 1.0
        own = tuple(rate / (1j * omega) for rate in Pid.rates(p, 0.0, y, v, (0.0,)))
        return complex(Pid.force(p, 0.0, y, v, own))

    def body(self, size: float, omega: float) -> complex:
        """Velocity of the body over the force on it."""
        if (size, omega) not in self.known:
            law, mass, frequency = self.scenario.law, self.scenario.mass, omega / (2 * math.pi)
            if self.of == "law":
                plant, friction = (
                    SimpleNamespace(**self.scenario.plant_values),
                    describing_function(law, size, frequency),
                )
                pushed, held = Mass.acceleration(plant, 1.0, 0.0), Mass.acceleration(plant, 0.0, friction)
                answer = pushed / (1j * omega - held)
            else:
                answer = 1j * omega * _harmonic(*_last_cycle(law, "force", size, frequency, mass, "y")) / size
            self.known[size, omega] = complex(answer)
        return self.known[size, omega]


def _harmonic(angle: Array, x: Array) -> complex:
    return complex(2 * np.mean(x * np.exp(-1j * angle)))


def _last_cycle(
    law: Law, kind: str, amplitude: float, frequency: float, mass: float | None, column: str
) -> tuple[Array, Array]:
    """The phase and a column over the last of the cycles that let transients die out: more of them for a body."""
    cycles = 2 if mass is None else 4
    signal = {"kind": "sine", "amplitude": float(amplitude), "frequency": float(frequency), "phase": math.pi / 2}
    scenario = Scenario(
        law=table(law),
        plant={} if mass is None else {"mass": mass},
        drive={"kind": kind, "signal": signal},
        solve={"t_end": cycles / frequency},
        output={"step": 1 / (frequency * _ROWS)},
    )
    solution = simulate(scenario)
    if solution.status != "done":
        raise StribeckError(f"the describing function cannot be computed: {solution.reason}")
    rows = slice((cycles - 1) * _ROWS, cycles * _ROWS)
    return 2 * np.pi * frequency * solution.t[rows], solution[column][rows]
