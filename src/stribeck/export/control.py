"""python-control: a law as a nonlinear I/O system, its describing function, and the hunting that this predicts."""

from __future__ import annotations

import inspect
import math
from dataclasses import dataclass
from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import minimum_filter
from scipy.optimize import least_squares

from stribeck.constants import kind_of, show
from stribeck.errors import InputError, StribeckError
from stribeck.export.optional import package
from stribeck.laws import builtin
from stribeck.laws.base import Law
from stribeck.plants.mass import Mass
from stribeck.scenario import Scenario
from stribeck.simulation import simulate

if TYPE_CHECKING:
    import control

_RTOL = 1e-8
_ROWS = 1024  # of a cycle
_GRID = 16  # sizes and frequencies tried, each
_BALANCED = 1e-4  # what may be left of a harmonic balance, as a share of its terms


def to_control(law: Law, mass: float | None = None) -> control.NonlinearIOSystem:
    """See :meth:`stribeck.laws.Law.to_control`."""
    ct: Any = package("control", "tools")
    if mass is not None and (text := Mass.constants["mass"].problem(mass)):
        raise InputError(f"mass: {show(mass)}: {text}")
    plant = SimpleNamespace(mass=mass)

    def quantities(x: Any, u: Any, params: dict[str, Any]) -> tuple[Any, ...]:
        p = SimpleNamespace(**{**law.values, **{n: a for n, a in params.items() if n in law.values}})
        v = u[0] if mass is None else x[1]
        z = x[-1] if law.has_z else 0.0
        rate = law.dz_dt(p, v, z)
        return v, rate, law.friction(p, v, z, rate)

    def derivatives(t: float, x: Any, u: Any, params: dict[str, Any]) -> Any:
        v, rate, force = quantities(x, u, params)
        body = [] if mass is None else [v, Mass.acceleration(plant, u[0], force)]
        return np.array([*body, *([rate] if law.has_z else [])], float)

    def outputs(t: float, x: Any, u: Any, params: dict[str, Any]) -> Any:
        v, _, force = quantities(x, u, params)
        return np.array([force] if mass is None else [x[0], v, force], float)

    body, bristle = ([] if mass is None else ["y", "v"]), (["z"] if law.has_z else [])
    system = ct.nlsys(
        derivatives if body or bristle else None, outputs, name=law.name, inputs=["v" if mass is None else "u"],
        outputs=[*body, "F"], **({"states": [*body, *bristle]} if body or bristle else {}),
        params={n: a for n, a in law.values.items() if a is not None},
    )  # fmt: skip
    system.friction = law
    return system


def response(system: Any, T: ArrayLike, U: ArrayLike = 0.0, X0: ArrayLike = 0.0, **options: Any) -> Any:
    """``control.input_output_response`` with a solver that suits friction.

    LSODA, which turns implicit where the contact is stiff, with a relative tolerance of 1e-8 and an absolute one of
    1e-9 of the smallest deflection F_s/sigma_0 in the system (1e-6, SciPy's own, is of the size of z itself), and steps
    of at most 1/100 of the time span, so that no corner of the input is passed over.

    Args:
        system: what :meth:`stribeck.laws.Law.to_control` gives, or a system interconnected from such.
        T, U, X0: times, inputs and initial states, as python-control takes them.
        **options: further arguments of ``control.input_output_response``; ``solve_ivp_kwargs`` are merged.
    """
    ct: Any = package("control", "tools")
    T = np.asarray(T, float)
    lengths = [law.scales(law.p).length for law in _laws(system)]
    chosen = {"rtol": _RTOL, "atol": 0.1 * _RTOL * min(lengths, default=1.0), "max_step": float(np.ptp(T)) / 100}
    chosen |= {"method": options.pop("solve_ivp_method", "LSODA"), **options.pop("solve_ivp_kwargs", {})}
    return ct.input_output_response(system, T, U, X0, solve_ivp_kwargs=chosen, **options)


def _laws(system: Any) -> list[Law]:
    own = [system.friction] if hasattr(system, "friction") else []
    return own + [law for part in getattr(system, "syslist", ()) for law in _laws(part)]


def describing_function(law: Law, amplitude: float, frequency: float = 1.0) -> complex:
    """First harmonic of F over that of v = amplitude cos(2 pi frequency t), N s/m: the real part dissipates.

    Args:
        law: the law.
        amplitude: of the velocity, m/s.
        frequency: Hz; laws without z do not depend on it.

    Raises:
        InputError: an argument is not a finite number > 0.
    """
    for name, value in (("amplitude", amplitude), ("frequency", frequency)):
        if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not 0 < value < math.inf:
            given = show(value) if isinstance(value, int | float | np.number) else kind_of(value)
            raise InputError(f"{name}: {given}: must be a finite number > 0")
    if not law.has_z:
        angle = (np.arange(_ROWS) + 0.5) * 2 * np.pi / _ROWS
        return _harmonic(angle, law.force(amplitude * np.cos(angle))) / amplitude
    signal = {"kind": "sine", "amplitude": float(amplitude), "frequency": float(frequency), "phase": math.pi / 2}
    angle, columns = _last_cycle(law, {"kind": "velocity", "signal": signal}, frequency, None, 2)
    return _harmonic(angle, columns["F"]) / amplitude


def _harmonic(angle: NDArray[np.float64], x: NDArray[np.float64]) -> complex:
    return complex(2 * np.mean(x * np.exp(-1j * angle)))


def _last_cycle(law: Law, drive: dict[str, Any], frequency: float, mass: float | None, cycles: int) -> tuple[Any, Any]:
    """The phase and the columns over the last of some cycles."""
    step = 1 / (frequency * _ROWS)
    scenario = Scenario(
        law=_law(law),
        plant={"mass": mass} if mass is not None else {},
        drive=drive,
        solve={"t_end": cycles / frequency},
        output={"step": step},
    )
    solution = simulate(scenario)
    if solution.status != "done":
        raise StribeckError(f"the describing function cannot be computed: {solution.reason}")
    rows = slice((cycles - 1) * _ROWS, cycles * _ROWS)
    return 2 * np.pi * frequency * solution.t[rows], {n: solution[n][rows] for n in ("y", "F")}


def _law(law: Law) -> dict[str, Any]:
    """The law as a scenario names it."""
    own = {n: x for n, x in law.values.items() if n not in law.machine and x is not None}
    name = law.name
    if builtin().get(name) is not type(law):
        name = f"{inspect.getfile(type(law))}:{type(law).__name__}"
    return {"name": name, **own, **({"parameters": law.machine} if law.machine else {})}


@dataclass(frozen=True)
class Hunting:
    """A limit cycle that describing functions predict: amplitude (m) and period (s) of the position, both nan where
    they predict none; ``mismatch`` is what is left of the harmonic balance, as a share of its terms."""

    amplitude: float
    period: float
    mismatch: float


def hunting(scenario: Scenario, of: str = "law") -> Hunting:
    """The limit cycle of a PID loop that the first harmonics predict.

    ``of="law"`` takes position and velocity as sinusoidal and the law's first harmonic, as textbooks do.
    ``of="body"`` takes the controller's force as sinusoidal and the first harmonic of the body that it moves, which
    sticks and slips. Friction's cycles are far from sinusoidal: compare with the simulation.

    Raises:
        InputError: the scenario's drive is not a PID controller, or ``of`` is neither.
    """
    if scenario.drive.kind != "pid":
        raise InputError(f"drive.kind: {scenario.drive.kind!r}: must be 'pid' to hunt")
    if of not in ("law", "body"):
        raise InputError(f"of: {show(of)}: must be 'law' or 'body'")
    groups, law = scenario.groups(), scenario.law
    natural = math.sqrt(abs(groups.drive.K_p) / scenario.mass) or 1.0

    def controller(omega: float) -> complex:
        """Force over velocity, from the drive's own equations on phasors."""
        y, v, drive, p = 1 / (1j * omega), 1.0, scenario.drive, groups.drive
        own = tuple(rate / (1j * omega) for rate in drive.rates(p, 0.0, y, v, (0.0,)))
        return complex(drive.force(p, 0.0, y, v, own))

    @lru_cache(maxsize=4096)
    def body(size: float, omega: float) -> complex:
        """Velocity of the body over the force on it."""
        frequency = omega / (2 * math.pi)
        if of == "law":  # 1/(j omega mass + N)
            friction = describing_function(law, size, frequency)
            pushed, held = (Mass.acceleration(groups.plant, *forces) for forces in ((1.0, 0.0), (0.0, friction)))
            return complex(pushed / (1j * omega - held))
        signal = {"kind": "sine", "amplitude": size, "frequency": frequency, "phase": math.pi / 2}
        angle, columns = _last_cycle(law, {"kind": "force", "signal": signal}, frequency, scenario.mass, 4)
        return 1j * omega * _harmonic(angle, columns["y"]) / size

    def residual(x: Any) -> list[float]:
        size, omega = (float(np.exp(a)) for a in x)
        loop = controller(omega) * body(size, omega)
        error = (loop - 1) / (abs(loop) + 1)
        return [error.real, error.imag]

    scales = law.scales(law.p)
    fastest = scales.force / (scenario.mass * natural)
    low, high = (1e-2 * scales.speed, 30 * fastest) if of == "law" else (0.5 * scales.force, 4 * scales.force)
    box = np.log([[low, natural / 30], [high, natural * 30]])
    grid = (
        box[0] + (box[1] - box[0]) * (np.stack(np.meshgrid(*[np.arange(_GRID)] * 2, indexing="ij"), -1) + 0.5) / _GRID
    )
    rough = np.apply_along_axis(lambda x: math.hypot(*residual(x)), -1, grid)
    valleys = rough == minimum_filter(rough, size=3)
    best = Hunting(math.nan, math.nan, math.inf)
    for start in grid[valleys][np.argsort(rough[valleys])][:_GRID]:
        found = least_squares(residual, start, bounds=tuple(box), diff_step=[1e-4], xtol=1e-12, ftol=1e-12, max_nfev=30)
        mismatch = math.hypot(*found.fun)
        if mismatch < best.mismatch:
            size, omega = (float(np.exp(a)) for a in found.x)
            speed = size if of == "law" else abs(body(size, omega)) * size
            balanced = mismatch < _BALANCED
            best = Hunting(
                speed / omega if balanced else math.nan, 2 * math.pi / omega if balanced else math.nan, mismatch
            )
    return best
