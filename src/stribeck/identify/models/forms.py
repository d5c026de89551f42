"""Effects that a friction law may lack: one table of forms, each a force per unit of its coefficient along a motion.

Forms have engineering names. Those of ``OF_RECORD`` belong to one record and are not used for another.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.signal import bilinear, lfilter, lfilter_zi

from stribeck.arrays import Array
from stribeck.identify.core.states import Estimate, EstimateState
from stribeck.identify.data.filters import HIGHEST
from stribeck.identify.features.filtering import smoother_log
from stribeck.identify.log import Log
from stribeck.identify.models.curves import SteadyCurve
from stribeck.identify.models.over_position import direction_along

# Of the fastest speed, or of the travel between reversals, by factors of 2: of a bend between two widths
# these leave 3 %, of a rounded one 7 to 11 %.
WIDTHS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4)
POWERS = (0.5, 1.5, 2.0, 3.0)  # of the speed: thinning grease, turbulence, drag, a saturating drive
LAGS = (2.0, 6.0, 18.0, 54.0)  # samples, by factors of 3: one lag between two of them leaves 4 % of its effect
WAVES = 3  # a line and two cosines over a record's length: of warming up over all of it they leave 4 %
OF_RECORD = ("drift", "level by time", "filter")
BESIDE_FRICTION = ("weight", "spring", "ripple", "coupling")  # first words of forms that are no friction
OF_LEVEL = ("bend", "pointed", "growth", "uneven", "level", "load")  # first words of forms of steady friction
LOADED = "load and weight"  # friction that grows with inertial force, offset and weight
BENDS_BELOW = 0.35  # of v_s: half of such a bend is what the law's own curve cannot do, of a wider one less
_WORDS = {  # by the first words of a form's name; {}: its number
    "bend": "a friction peak below {:.3g} % of the top speed", "pointed": "a Stribeck curve of exponent 1",
    "uneven bend": "a friction peak below {:.3g} % of the top speed that differs by direction",
    "growth": "friction that grows with the speed to the power {:g}",
    "uneven slope": "viscous friction that differs by direction", "delay": "a delay of the force",
    "friction lags": "friction that lags behind the speed", "play": "friction that reverses over {:.3g} % of the stroke",
    "lag": "friction that reverses within {:g} samples", "load": "friction that grows with the inertial force",
    LOADED: "friction that grows with the inertial force and the weight", "drift": "a drift of the offset",
    "level by time": "a friction level that changes with time", "filter": "the cut-off frequency of the filter",
    "level by position": "a friction level that changes with position", "spring": "a spring", "weight": "a weight",
    "ripple": "a force that repeats with position", "level ripple": "a friction level that repeats with position",
    "coupling": "an elastic coupling that swings at {:g} Hz",
    "force filter": "a force measured behind a filter of {:g} ms",
    "level by load column": "friction that grows with the measured load",
    "level by pressure column": "friction that grows with the measured pressure",
}  # fmt: skip
# Where a form, or a term, of friction is 0, so that the friction is that of the law.
_LAW_AT = {
    "load": "inertial force 0", LOADED: "inertial force and weight 0", "level by position": "position {:.4g} {}",
    "level by time": "the middle of the record", "level by load column": "load 0", "F_c_by_load": "load 0",
    "level by pressure column": "pressure 0", "F_c_by_pressure": "pressure 0",
}  # fmt: skip
Key = tuple[str, str]  # form, column
Filter = tuple[Array, Array]  # numerator and denominator in z
Column = Callable[..., Any]  # without arguments


@dataclass(frozen=True)
class Anchor:
    """The constants of the forms' columns, with which another record gets the same forms.

    Attributes:
        curve: the law; ``shape``: its shapes, at which delays and lags are linearized; ``found``: all coefficients.
        fast, way, step: the fastest speed, the travel between reversals, the sampling period.
        turns, placed: whether the body reverses; whether its position was measured.
        speeds: of the levels.
        carried: further parts of the force: an offset, and sine and cosine of the position.
        middle: the mean position, where a level that changes with position is the law's.
        waves, level_waves: ripples of the force and of the friction's level over the position, 1/m.
        swing: the resonance of an elastic coupling, Hz, and its damping ratio.
        late: the time constant of a filter of the force, s.
        plays: short ways over which friction reverses, of ``way``: the one found, its half and its double.
    """

    curve: SteadyCurve
    shape: Mapping[str, float]
    found: Mapping[str, float]
    fast: float
    way: float
    step: float
    turns: bool
    placed: bool
    speeds: tuple[float, ...]
    carried: Mapping[str, float]
    middle: float = 0.0
    waves: tuple[float, ...] = ()
    level_waves: tuple[float, ...] = ()
    swing: tuple[float, float] | None = None
    late: float = 0.0
    plays: tuple[float, ...] = ()

    def friction(self, v: Array) -> Array:
        """The law's friction with the anchor's coefficients."""
        return self.curve.force(v, self.shape, self.found) + self.found.get("sigma_2", 0.0) * v


def forms(log: Log, at: Anchor) -> dict[Key, Column]:
    """Every form's columns along a log, each computed when it is called."""
    v, sign, load = log.velocity, at.curve.sign(log.velocity, at.shape), at.found.get("mass", 0.0) * log.acceleration
    friction, columns = at.friction(v), _of_speed(v, sign, at)
    columns |= {("delay", ""): lambda: _rate(log, load + friction), ("friction lags", ""): lambda: _rate(log, friction)}
    runs = list(log.runs())
    if at.late:
        name = f"force filter {1e3 * at.late:.2f}"
        columns[name, ""] = lambda: behind(load + friction, runs, filtered(at.late, log.step))
    if at.swing:
        of_swing = coupling(*at.swing, log.step)
        columns[f"coupling {at.swing[0]:.1f}", ""] = partial(behind, log.acceleration, runs, of_swing)
    if at.turns:
        widths = (*at.plays, *WIDTHS)
        columns |= {
            (f"play {np.format_float_positional(w)}", ""): lambda w=w: direction_along(log, w * at.way) - np.sign(v)
            for w in widths
        }
        columns |= {(f"lag {n}", ""): partial(behind, sign, runs, lag(n * at.step, log.step)) for n in LAGS}
    columns |= {("load", ""): lambda: sign * abs(load), (LOADED, ""): lambda: sign * abs(load + carried(log, at))}
    columns |= _of_place(log, sign, at)
    for name in ("load", "pressure"):
        if (x := getattr(log, name)) is not None:
            columns[f"level by {name} column", ""] = partial(np.multiply, np.sign(v), x)  # as the term of this column
    t = 2 * (log.time - log.time[0]) / max(float(np.ptp(log.time)), 1e-300) - 1
    for k in range(1, WAVES + 1):  # a straight line over the record, from -1 to 1, then cosines
        after, wave = (" " + str(k), np.cos(np.pi * k * (t + 1) / 2)) if k > 1 else ("", t)
        columns[f"drift{after}", ""] = lambda wave=wave: wave
        columns[f"level by time{after}", ""] = lambda wave=wave: sign * wave
    if log.bandwidth and log.step:
        columns["filter", ""] = lambda: _smoother_force(log, at) - load - friction
    return columns


def in_words(form: str) -> str:
    """What a form is, for a reader; a text that names no form is returned as it is."""
    named = re.fullmatch(r"(.*?)(?: (\d[\d.]*))?(?: square)?", form)
    if named is None or named[1] not in _WORDS:
        return form
    percent = 100 if named[1] in ("bend", "uneven bend", "play") else 1
    return _WORDS[named[1]].format(percent * float(named[2] or 0))


def sizes_in_words(sizes: Mapping[str, float], unit: str) -> str:
    """The effects of forms with their sizes; effects of one kind share their words."""
    kinds = dict[str, list[str]]()
    for form, size in sizes.items():
        kinds.setdefault(in_words(form), []).append(f"{size:.2g}")
    return ", ".join(f"{words} ({', '.join(several)} {unit})" for words, several in kinds.items())


def law_at(names: Iterable[str], middle: float, unit: str) -> list[str]:
    """Where friction that depends on more than speed is the law's, of a model with these forms and terms.

    Args:
        middle: the mean position, in ``unit``.
    """
    kinds = dict.fromkeys(re.sub(r" \d+$", "", n) for n in names)
    return list(dict.fromkeys(_LAW_AT[n].format(middle, unit) for n in kinds if n in _LAW_AT))


def dependences(estimates: Mapping[str, Estimate]) -> list[str]:
    """The estimates whose range depends on an effect that the model may lack, a sentence for each effect."""
    causes = dict[str, list[str]]()
    for name, e in estimates.items():
        if e.state is EstimateState.MODEL_DEPENDENT and e.depends_on:
            causes.setdefault(e.depends_on, []).append(name)
    return [f"{', '.join(names)}: the range covers {in_words(cause)}." for cause, names in causes.items()]


def filtered(time: float, step: float) -> Filter:
    """A filter of first order."""
    return bilinear([1.0], [time, 1.0], 1 / step)


def lag(time: float, step: float) -> Filter:
    """A filter of first order whose input is constant within a step, as a sign is."""
    keep = float(np.exp(-step / time))
    return np.array([1 - keep]), np.array([1.0, -keep])


def coupling(hertz: float, damping: float, step: float) -> Filter:
    """The acceleration of a mass behind that of the drive which carries it along.

    Args:
        hertz: the resonance of the mass on the coupling; ``damping``: its ratio.
    """
    w = 2 / step * np.tan(np.pi * min(hertz * step, HIGHEST))  # prewarped for the bilinear transform
    return bilinear([2 * damping * w, w * w], [1.0, 2 * damping * w, w * w], 1 / step)


def behind(x: Array, runs: Iterable[slice], of_filter: Filter) -> Array:
    """What a filter adds to a series (rows first); each run begins in the steady state of its first row."""
    out, still = np.empty(x.shape), lfilter_zi(*of_filter)
    for run in runs:
        out[run] = lfilter(*of_filter, x[run], axis=0, zi=np.multiply.outer(still, x[run][0]))[0]
    return out - x


def _smoother_force(log: Log, at: Anchor) -> Array:
    """The inertia and the friction of the motion behind a lower cut-off, in the direction of the recorded motion.

    Rows whose direction differs keep the recorded speed: they show where a cut-off puts a reversal, which rounding may decide.
    """
    smooth = smoother_log(log)
    speed = np.where(smooth.velocity * log.velocity > 0, smooth.velocity, log.velocity)
    return np.asarray(at.found.get("mass", 0.0) * smooth.acceleration + at.friction(speed))


def _of_speed(v: Array, sign: Array, at: Anchor) -> dict[Key, Column]:
    """Other dependences of friction on speed."""
    share, columns = abs(v) / at.fast, dict[Key, Column]()
    for w in WIDTHS:
        columns[f"bend {w}", ""] = lambda w=w: sign * np.exp(-share / w)
        columns[f"bend {w} square", ""] = lambda w=w: sign * np.exp(-((share / w) ** 2))
        columns[f"uneven bend {w}", ""] = lambda w=w: abs(sign) * np.exp(-share / w)
    if "v_s" in at.shape:
        columns["pointed", ""] = lambda: sign * _pointed(abs(v) / at.shape["v_s"])
    columns |= {(f"growth {p}", ""): lambda p=p: sign * share**p for p in POWERS}
    return columns | {("uneven slope", ""): lambda: abs(v)}


def _pointed(share: Array) -> Array:
    """The difference between a Stribeck curve of exponent 1 and of exponent 2."""
    return np.asarray(np.exp(-share) - np.exp(-(share**2)))


def _of_place(log: Log, sign: Array, at: Anchor) -> dict[Key, Column]:
    """Weight, spring, cogging, and a friction level that depends on position."""
    y, columns = log.position, dict[Key, Column]()
    if at.placed:
        columns = {("weight", "sin"): lambda: np.sin(y), ("weight", "cos"): lambda: np.cos(y)}
        columns |= {("spring", ""): lambda: y, ("level by position", ""): lambda: sign * (y - at.middle)}
    for name, waves, height in (("ripple", at.waves, 1.0), ("level ripple", at.level_waves, sign)):
        for k, w in enumerate(waves):
            for wave in (np.sin, np.cos):
                columns[f"{name} {k}", wave.__name__] = lambda wave=wave, w=w, height=height: height * wave(w * y)
    return columns


def carried(log: Log, at: Anchor) -> Array:
    """The force of offset and weight."""
    y, c = log.position, at.carried
    return np.asarray(c[""] + c.get("sin", 0.0) * np.sin(y) + c.get("cos", 0.0) * np.cos(y))


def sliding(log: Log, at: Anchor, names: Sequence[str]) -> Array:
    """The part of the friction at each row that has the direction of the motion, with some forms.

    Within a play a speed shows what follows the reversal, and nothing of the friction at this speed.
    """
    part, sign = np.ones(len(log)), at.curve.sign(log.velocity, at.shape)
    for name in names:
        kind, *width = name.split()
        if kind == "play":
            part = part * (abs(direction_along(log, float(width[0]) * at.way)) >= 1)
        elif kind == "lag":
            behind_sign = behind(sign, log.runs(), lag(float(width[0]) * at.step, log.step))
            part = part * (1 - abs(behind_sign) / 2)
    return np.asarray(part)


def steady(name: str, v: Array, at: Anchor, rigid: bool = False) -> Array:
    """A form at steady speeds ``v`` > 0; 0 for forms that act only in unsteady motion.

    Args:
        rigid: whether the sign is exact, for F_s as the limit of zero speed.
    """
    kind, *rest = name.split()
    share = v / at.fast
    at_speed: dict[str, Callable[[], Array]] = {
        "bend": lambda: np.exp(-((share / float(rest[0])) ** len(rest))),
        "pointed": lambda: _pointed(v / at.shape["v_s"]),
        "growth": lambda: share ** float(rest[0]),
    }
    if kind not in at_speed:
        return np.zeros(len(v))
    return np.asarray((1.0 if rigid else at.curve.sign(v, at.shape)) * at_speed[kind]())


def is_bend(name: str) -> bool:
    """Whether a form is a Stribeck curve that vanishes at high speed, and so contributes to the static friction."""
    return name.startswith(("bend", "pointed"))


def fits(name: str, nodes: Sequence[Mapping[str, float]], fast: float) -> Array:
    """The nodes of the shapes at which a form differs from the law's own curve. A bend must be narrower than v_s."""
    bends = BENDS_BELOW * np.array([s.get("v_s", np.inf) for s in nodes])
    return np.asarray(float(name.split()[1]) * fast < bends if name.startswith("bend") else np.ones(len(nodes), bool))


def _rate(log: Log, x: Array) -> Array:
    out = np.empty(len(x))
    for run in log.runs():
        out[run] = np.gradient(x[run]) if run.stop - run.start > 1 else 0.0
    return out
