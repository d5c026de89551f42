"""A rig's test programme as a table, a plot and motions to play; and a synthetic rig that plays them."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.expressions.ops import Value
from stribeck.files import write_text
from stribeck.identify.plan import SMALLEST, Limits, Test, motion, programme
from stribeck.identify.synthetic import LABEL, Experiment, Sensors, experiment
from stribeck.mouth import plots
from stribeck.mouth.document import FigureSvg

HEAD = (
    "test",
    "kind",
    "control",
    "amplitude_m",
    "speed_m_per_s",
    "force_rate_N_per_s",
    "duration_s",
    "repeats",
    "identifies",
)
# The files of a synthetic rig, and how each begins.
SYNTHETIC = {"synthetic_log.csv": "time,position,force\n", "synthetic_truth.toml": f'title = "{LABEL}'}
STEP = 1e-3  # s, of the motions to play and of the synthetic log
_FINER = 4  # the synthetic rig moves on a mesh so many times as fine as its sensors'
_NOISE = 0.01  # of F_c


def table(tests: Sequence[Test]) -> list[list[str]]:
    """A row of text a test, under :data:`HEAD`."""

    def show(value: float | None) -> str:
        return "" if value is None else f"{value:.4g}"

    return [
        [
            str(i), t.kind, t.control, show(t.amplitude), show(t.speed), show(t.force_rate), show(t.duration),
            str(t.repeats), t.identifies,
        ]
        for i, t in enumerate(tests, start=1)
    ]  # fmt: skip


def csv(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table as CSV text; cells with commas in quotes."""
    return "".join(",".join(f'"{cell}"' if "," in cell else cell for cell in row) + "\n" for row in (head, *rows))


def write_rig(limits: Limits, folder: Path) -> list[str]:
    """Write programme.csv, motion.csv (what motion-controlled tests play, every ms) and programme.svg; their names."""
    tests = programme(limits)
    t, v = motion(tests, STEP)
    write_text(folder / "programme.csv", csv(HEAD, table(tests)))
    _write_columns(folder / "motion.csv", {"time": t, "position": _position(v), "velocity": v})
    write_text(folder / "programme.svg", figure(limits, tests).svg)
    return ["programme.csv", "motion.csv", "programme.svg"]


def _position(v: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum((v[1:] + v[:-1]) * STEP / 2)])


def _write_columns(path: Path, columns: Mapping[str, Array]) -> None:
    data = np.column_stack(list(columns.values()))
    text = io.StringIO()  # a file by its name would end its lines as the system does
    np.savetxt(text, data, "%.10g", ",", header=",".join(columns), comments="")
    write_text(path, text.getvalue())


def figure(limits: Limits, tests: Sequence[Test]) -> FigureSvg:
    """The motions against time, the tests between the rig's limits, and the force ramps."""
    t, v = motion(tests, STEP)
    moving: list[tuple[Value, Value, Value]] = [
        (x.kind, x.amplitude, x.speed) for x in tests if x.amplitude is not None and x.speed is not None
    ]
    kinds = list(dict.fromkeys(kind for kind, *_ in moving))
    from matplotlib.ticker import SymmetricalLogLocator

    with plots.style():
        made, axes = plots.figure([["v", "v"], ["y", "y"], ["limits", "force"]], 6.6)
        axes["v"].plot(*plots.thin(t, v), color="black", linewidth=0.8)
        for panel, i in (("v", 2), ("y", 1)):  # from the smallest to the largest, both signs
            smallest = 10.0 ** np.floor(np.log10(min(each[i] for each in moving)))
            axes[panel].set_yscale("symlog", linthresh=smallest)
            axes[panel].yaxis.set_major_locator(SymmetricalLogLocator(base=100, linthresh=smallest))
        axes["v"].set(xlabel="t (s)", ylabel="v (m/s)", title="motion-controlled tests, one after the other")
        axes["y"].plot(*plots.thin(t, _position(v)), color="black", linewidth=0.8)
        axes["y"].set(xlabel="t (s)", ylabel="y (m)")
        for i, kind in enumerate(kinds):
            way, speed = zip(*((a, v) for each, a, v in moving if each == kind), strict=True)
            axes["limits"].plot(
                way, speed, "os^"[i], color=plots.COLOURS[i],
                label=kind, markersize=4,
            )  # fmt: skip
        axes["limits"].axvline(limits.stroke, color=plots.GREY, linestyle="--")
        axes["limits"].axhline(limits.speed, color=plots.GREY, linestyle="--")
        axes["limits"].set(xscale="log", yscale="log", xlabel="way there and back (m)", ylabel="largest speed (m/s)")
        axes["limits"].set_title("limits dashed")
        for i, test in enumerate(test for test in tests if test.force_rate is not None):
            rate = test.force_rate or 0.0
            times = np.geomspace(1e-3 * test.duration, test.duration, 50)
            plots.line(axes["force"], i, times, rate * times, f"{rate:.3g} N/s")
        axes["force"].axhline(limits.force, color=plots.GREY, linestyle="--")
        axes["force"].set(xscale="log", xlabel="t (s)", ylabel="force (N)", title="force ramps from rest")
        axes["limits"].legend(loc="upper left", fontsize=7)
        axes["force"].legend(loc="upper left", fontsize=7)
        return plots.finish(made, "programme", "the test programme")


# -- the synthetic rig -----------------------------------------------------------------------------------------------


def simulated(limits: Limits, law: str, given: Mapping[str, float], seed: int) -> Experiment:
    """What a synthetic rig with these limits measures of a law when it plays the motions; made up, and labelled so.

    Constants not given are made to suit the rig: a fifth of its force as Coulomb friction, and so on.

    Raises:
        InputError: the law is unknown, or its constants are not allowed.
    """
    found = laws.find(law)
    values = {n: v for n, v in {**_suiting(limits), **given}.items() if n in found.constants() or n in given}
    own = {n: c.example for n, c in found.own_constants().items() if c.required and n not in values}
    # a law's own constants have examples of their own; z_ba must stay below F_c/sigma_0
    if "z_ba" in own:
        own["z_ba"] = 0.5 * values["F_c"] / values["sigma_0"]
    made = found({**own, **values})
    length = made.scales(made.p).length
    if limits.deflection is None and not SMALLEST <= length <= 0.1 * limits.stroke:
        text = f"the law's friction breaks away at {length:.3g} m, which must be from {SMALLEST:g} to a tenth of the stroke"
        raise InputError(f"{arg('plan.stroke')}: {limits.stroke:g}: {text}")
    sensors = Sensors(position_resolution=1e-3 * length, force_noise=_NOISE * made.scales(made.p).force)
    tests = programme(Limits(limits.stroke, limits.speed, limits.force, limits.deflection or length))
    return experiment(made, motion(tests, STEP / _FINER), sensors, seed=seed, every=_FINER)


def _suiting(limits: Limits) -> dict[str, float]:
    level, speed = 0.2 * limits.force, 0.05 * limits.speed
    stiffness = level / (limits.deflection or 1e-4 * limits.stroke)
    return {
        "F_c": level, "F_s": 1.4 * level, "v_s": speed, "sigma_0": stiffness, "sigma_1": 0.3 * level / speed,
        "sigma_2": 0.3 * level / limits.speed,
    }  # fmt: skip


def write_simulated(made: Experiment, folder: Path) -> list[str]:
    """Write synthetic_log.csv (time, position, force) and synthetic_truth.toml, a parameter set; their names."""
    log, name = made.log, type(made.law).name
    names = [*SYNTHETIC]
    _write_columns(folder / names[0], {"time": log.time, "position": log.position, "force": log.force})
    truth = made.law.p.numbers
    lines = [
        f'title = "{LABEL}: the truth behind synthetic_log.csv"',
        f'source = "stribeck fit --plan --simulate, law {name}, seed {made.seed}"',
        "[parameters]",
        *(f"{n} = {v!r}" for n, v in truth.items()),
    ]
    write_text(folder / names[1], "\n".join(lines) + "\n")
    return names


def numbers(assignments: Sequence[tuple[str, Value]]) -> dict[str, float]:
    """``--set NAME=VALUE`` as numbers.

    Raises:
        InputError: a value is no number.
    """
    wrong = [
        f"{arg(f'constants.{n}')}: {v!r}: must be a number"
        for n, v in assignments
        if isinstance(v, bool | str | list | dict)
    ]
    if wrong:
        raise InputError(wrong)
    return {name: float(value) for name, value in assignments}
