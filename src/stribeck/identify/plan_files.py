"""A rig's test program as a table and as motions to play; and a synthetic rig that plays them."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import tomli_w
from scipy.integrate import cumulative_trapezoid

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.expressions.ops import Value
from stribeck.files import write_text
from stribeck.identify.plan import SMALLEST, Limits, Test, motion, program
from stribeck.identify.synthetic import LABEL, Experiment, Sensors, experiment

# The files of a synthetic rig, and how each begins.
SYNTHETIC = {"synthetic_log.csv": "time,position,force\n", "synthetic_truth.toml": f'title = "{LABEL}'}
STEP = 1e-3  # s, of the motions to play and of the synthetic log
_FINER = 4  # the synthetic rig moves on a mesh so many times as fine as its sensors'
_NOISE = 0.01  # of F_c


def table(tests: Sequence[Test]) -> str:
    """The tests as CSV text, a row each."""
    text, rows = io.StringIO(), list[dict[str, object]]()
    for i, test in enumerate(tests, start=1):
        numbers = {
            "amplitude_m": test.amplitude, "speed_m_per_s": test.speed, "force_rate_N_per_s": test.force_rate,
            "duration_s": test.duration,
        }  # fmt: skip
        cells = {name: "" if x is None else f"{x:.4g}" for name, x in numbers.items()}
        about = {"test": i, "kind": test.kind, "control": test.control}
        rows.append({**about, **cells, "repeats": test.repeats, "identifies": test.identifies})
    file = csv.DictWriter(text, rows[0], lineterminator="\n")
    file.writeheader()
    file.writerows(rows)
    return text.getvalue()


def write_rig(limits: Limits, folder: Path) -> list[str]:
    """Write program.csv and motion.csv (what motion-controlled tests play, every ms); their names."""
    tests = program(limits)
    t, v = motion(tests, STEP)
    write_text(folder / "program.csv", table(tests))
    position = cumulative_trapezoid(v, dx=STEP, initial=0)
    _write_columns(folder / "motion.csv", {"time": t, "position": position, "velocity": v})
    return ["program.csv", "motion.csv"]


def _write_columns(path: Path, columns: Mapping[str, Array]) -> None:
    data = np.column_stack(list(columns.values()))
    text = io.StringIO()  # a file by its name would end its lines as the system does
    np.savetxt(text, data, "%.10g", ",", header=",".join(columns), comments="")
    write_text(path, text.getvalue())


# -- the synthetic rig -----------------------------------------------------------------------------------------------


def simulated(limits: Limits, law: str, given: Mapping[str, float], seed: int) -> Experiment:
    """The synthetic log of a rig with these limits and a law, labeled as synthetic.

    Constants not given are made to suit the rig: a fifth of its force as Coulomb friction, and so on.

    Raises:
        InputError: the law is unknown, or its constants are not allowed.
    """
    kind = laws.find(law)
    values = {n: v for n, v in {**_suiting(limits), **given}.items() if n in kind.constants() or n in given}
    examples = {n: c.example for n, c in kind.own_constants().items() if c.required and n not in values}
    if "z_ba" in examples:
        examples["z_ba"] = 0.5 * values["F_c"] / values["sigma_0"]  # below F_c/sigma_0
    friction = kind({**examples, **values})
    scales = friction.scales(friction.p)
    length = scales.length
    if limits.deflection is None and not SMALLEST <= length <= 0.1 * limits.stroke:
        text = f"the law's friction breaks away at {length:.3g} m, which must be from {SMALLEST:g} to a tenth of the stroke"
        raise InputError(f"{arg('plan.stroke')}: {limits.stroke:g}: {text}")
    sensors = Sensors(position_resolution=1e-3 * length, force_noise=_NOISE * scales.force)
    tests = program(Limits(limits.stroke, limits.speed, limits.force, limits.deflection or length))
    return experiment(friction, motion(tests, STEP / _FINER), sensors, seed=seed, every=_FINER)


def _suiting(limits: Limits) -> dict[str, float]:
    level, speed = 0.2 * limits.force, 0.05 * limits.speed
    stiffness = level / (limits.deflection or 1e-4 * limits.stroke)
    return {
        "F_c": level, "F_s": 1.4 * level, "v_s": speed, "sigma_0": stiffness, "sigma_1": 0.3 * level / speed,
        "sigma_2": 0.3 * level / limits.speed,
    }  # fmt: skip


def write_simulated(synthetic: Experiment, folder: Path) -> list[str]:
    """Write synthetic_log.csv (time, position, force) and synthetic_truth.toml, a parameter set; their names."""
    log, names = synthetic.log, [*SYNTHETIC]
    _write_columns(folder / names[0], {"time": log.time, "position": log.position, "force": log.force})
    truth = {
        "title": f"{LABEL}: the truth behind synthetic_log.csv",
        "source": f"stribeck fit --plan --simulate, law {type(synthetic.law).name}, seed {synthetic.seed}",
        "parameters": synthetic.law.p.numbers,
    }
    write_text(folder / names[1], tomli_w.dumps(truth))
    return names


def numbers(assignments: Sequence[tuple[str, Value]]) -> dict[str, float]:
    """``--set NAME=VALUE`` as numbers.

    Raises:
        InputError: a value is no number.
    """
    wrong = [
        f"{arg(f'set.{n}')}: {v!r}: must be a number" for n, v in assignments if isinstance(v, bool | str | list | dict)
    ]
    if wrong:
        raise InputError(wrong)
    return {name: float(value) for name, value in assignments}
