"""Effects that a friction law may lack: one table, each a force per unit of its coefficient along a motion.

A form is an effect with its number, such as "play 0.02". Forms of the record itself are not used for another record.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.core.states import Estimate, EstimateState
from stribeck.identify.features.filtering import smoother_log
from stribeck.identify.log import Log
from stribeck.identify.models.curves import SteadyCurve
from stribeck.identify.models.over_position import direction_along
from stribeck.identify.models.transmission import behind, coupling, filtered, lag

# Of the fastest speed, or of the travel between reversals, by factors of 2: of a bend between two widths
# these leave 3 %, of a rounded one 7 to 11 %.
WIDTHS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4)
POWERS = (0.5, 1.5, 2.0, 3.0)  # of the speed: thinning grease, turbulence, drag, a saturating drive
LAGS = (2.0, 6.0, 18.0, 54.0)  # samples, by factors of 3: one lag between two of them leaves 4 % of its effect
WAVES = 3  # a line and two cosines over a record's length: of warming up over all of it they leave 4 %
BENDS_BELOW = 0.35  # of v_s: half of such a bend is what the law's own curve cannot do, of a wider one less
SHOWN = 0.05  # of a bend's height: the least that must occur in the record
Key = tuple[str, str]  # form, column
Column = Callable[[], Array]
Wave = Callable[[Array], Array]
BEND, DRIFT = "a friction peak below {:.3g} % of the top speed", "a drift of the offset"
BY_TIME, MIDDLE = "a friction level that changes with time", "the middle of the record"


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
    swing: tuple[float, ...] = ()
    late: float = 0.0
    plays: tuple[float, ...] = ()

    def friction(self, v: Array) -> Array:
        """The law's friction with the anchor's coefficients."""
        return self.curve.force(v, self.shape, self.found) + self.found.get("sigma_2", 0.0) * v


@dataclass(frozen=True)
class Motion:
    """A log with an anchor's model along it: what the columns of effects are made of."""

    log: Log
    at: Anchor

    @cached_property
    def sign(self) -> Array:
        """The direction of the friction."""
        return self.at.curve.sign(self.log.velocity, self.at.shape)

    @cached_property
    def inertial(self) -> Array:
        """The inertial force."""
        return self.at.found.get("mass", 0.0) * self.log.acceleration

    @cached_property
    def friction(self) -> Array:
        """The law's friction."""
        return self.at.friction(self.log.velocity)

    @cached_property
    def carried(self) -> Array:
        """The force of offset and weight."""
        y, c = self.log.position, self.at.carried
        return np.asarray(c[""] + c.get("sin", 0.0) * np.sin(y) + c.get("cos", 0.0) * np.cos(y))

    def wave(self, number: float) -> Array:
        """A straight line over the record, from -1 to 1, then cosines."""
        time = self.log.time
        t = 2 * (time - time[0]) / max(float(np.ptp(time)), 1e-300) - 1
        return t if number <= 1 else np.asarray(np.cos(np.pi * number * (t + 1) / 2))


OfMotion = Callable[[Motion, float], Array]  # its number
Columns = Mapping[str, OfMotion]
AtSpeed = Callable[[Anchor, Array, float], Array]


@dataclass(frozen=True)
class Effect:
    """A row of the table.

    Attributes:
        words: what it is, for a reader; {}: its number, times ``scale``.
        columns: the force along a motion for a number, by the names of its columns.
        numbers: texts of the numbers that are tried in a record; none if the record cannot show the effect.
        at_speed: the part of the friction at a speed >= 0, if it acts in steady motion.
        peak: whether it vanishes at high speed. In steady motion it then contributes to the static friction.
        level: whether it belongs to steady friction.
        beside: whether it is no friction; ``of_record``: whether it is not used for another record.
        slides: the part of the friction that has the direction of the motion.
        terms: the terms of a fit that describe the same.
        law_at: where it is 0, so that the friction is the law's; {}: the mean position.
    """

    words: str
    columns: Columns
    numbers: Callable[[Motion], Iterable[str]] = lambda _: ("",)
    scale: float = 1.0
    at_speed: AtSpeed | None = None
    peak: bool = False
    level: bool = False
    beside: bool = False
    of_record: bool = False
    slides: OfMotion | None = None
    terms: tuple[str, ...] = ()
    law_at: str = ""


def _one(column: OfMotion) -> Columns:
    return {"": column}


def _along(at_speed: AtSpeed) -> Columns:
    """The column of an effect that depends on the speed and has the direction of the friction."""
    return {"": lambda m, n: m.sign * at_speed(m.at, abs(m.log.velocity), n)}


def _waves(column: Callable[[Motion, float, Wave], Array]) -> Columns:
    """The columns of what repeats with position."""
    return {"sin": lambda m, k: column(m, k, np.sin), "cos": lambda m, k: column(m, k, np.cos)}


def _if(has: Callable[[Motion], object]) -> Callable[[Motion], Iterable[str]]:
    """One form without a number, in records that can show it."""
    return lambda m: ("",) if has(m) else ()


def _bend(at: Anchor, v: Array, width: float) -> Array:
    return np.asarray(np.exp(-v / at.fast / width))


def _round_bend(at: Anchor, v: Array, width: float) -> Array:
    return np.asarray(np.exp(-((v / at.fast / width) ** 2)))


def _pointed(at: Anchor, v: Array, _: float) -> Array:
    """The difference between a Stribeck curve of exponent 1 and of exponent 2."""
    share = v / at.shape["v_s"]
    return np.asarray(np.exp(-share) - np.exp(-(share**2)))


def _growth(at: Anchor, v: Array, power: float) -> Array:
    return np.asarray((v / at.fast) ** power)


def _rate(m: Motion, x: Array) -> Array:
    """The difference of a force from row to row."""
    out = np.empty(len(x))
    for run in m.log.runs():
        out[run] = np.gradient(x[run]) if run.stop - run.start > 1 else 0.0
    return out


def _play(m: Motion, width: float) -> Array:
    """The direction of friction that reverses over a part of the stroke."""
    return direction_along(m.log, width * m.at.way)


def _lagging(m: Motion, samples: float) -> Array:
    """What a lag adds to the direction of the friction."""
    return behind(m.sign, m.log.runs(), lag(samples * m.at.step, m.log.step))


def _by_column(m: Motion, x: Array | None) -> Array:
    """As the term of this column."""
    return np.sign(m.log.velocity) * x


def _smoother_force(m: Motion) -> Array:
    """The inertia and the friction of the motion behind a lower cut-off, in the direction of the recorded motion.

    Rows whose direction differs keep the recorded speed: they show where a cut-off puts a reversal, which rounding may decide.
    """
    smooth = smoother_log(m.log)
    speed = np.where(smooth.velocity * m.log.velocity > 0, smooth.velocity, m.log.velocity)
    return np.asarray(m.at.found.get("mass", 0.0) * smooth.acceleration + m.at.friction(speed))


def _widths(_: Motion) -> Iterable[str]:
    return map(str, WIDTHS)


def _cosines(_: Motion) -> Iterable[str]:
    return map(str, range(2, WAVES + 1))


EFFECTS: dict[str, Effect] = {  # by name; {}: its number
    "bend {}": Effect(BEND, _along(_bend), _widths, 100, at_speed=_bend, peak=True, level=True),
    "bend {} square": Effect(BEND, _along(_round_bend), _widths, 100, at_speed=_round_bend, peak=True, level=True),
    "uneven bend {}": Effect(
        BEND + " that differs by direction", _one(lambda m, w: abs(m.sign) * _bend(m.at, abs(m.log.velocity), w)),
        _widths, 100, peak=True, level=True,
    ),
    "pointed": Effect(
        "a Stribeck curve of exponent 1", _along(_pointed), _if(lambda m: "v_s" in m.at.shape), at_speed=_pointed,
        peak=True, level=True,
    ),
    "growth {}": Effect(
        "friction that grows with the speed to the power {:g}", _along(_growth), lambda _: map(str, POWERS),
        at_speed=_growth, level=True,
    ),
    "uneven slope": Effect(
        "viscous friction that differs by direction", _one(lambda m, _: abs(m.log.velocity)), level=True
    ),
    "delay": Effect("a delay of the force", _one(lambda m, _: _rate(m, m.inertial + m.friction))),
    "friction lags": Effect("friction that lags behind the speed", _one(lambda m, _: _rate(m, m.friction))),
    "force filter {}": Effect(
        "a force measured behind a filter of {:g} ms",
        _one(lambda m, _: behind(m.inertial + m.friction, m.log.runs(), filtered(m.at.late, m.log.step))),
        lambda m: (f"{1e3 * m.at.late:.2f}",) if m.at.late else (),
    ),
    "coupling {}": Effect(
        "an elastic coupling that swings at {:g} Hz",
        _one(lambda m, _: behind(m.log.acceleration, m.log.runs(), coupling(m.at.swing[0], m.at.swing[1], m.log.step))),
        lambda m: (f"{m.at.swing[0]:.1f}",) if m.at.swing else (), beside=True,
    ),
    "play {}": Effect(
        "friction that reverses over {:.3g} % of the stroke", _one(lambda m, w: _play(m, w) - np.sign(m.log.velocity)),
        lambda m: map(np.format_float_positional, (*m.at.plays, *WIDTHS)) if m.at.turns else (), 100,
        slides=lambda m, w: np.floor(abs(_play(m, w))),
    ),
    "lag {}": Effect(
        "friction that reverses within {:g} samples", _one(_lagging), lambda m: map(str, LAGS) if m.at.turns else (),
        slides=lambda m, n: 1 - abs(_lagging(m, n)) / 2,
    ),
    "load": Effect(
        "friction that grows with the inertial force", _one(lambda m, _: m.sign * abs(m.inertial)), level=True,
        law_at="inertial force 0",
    ),
    "load and weight": Effect(
        "friction that grows with the inertial force and the weight",
        _one(lambda m, _: m.sign * abs(m.inertial + m.carried)), level=True, law_at="inertial force and weight 0",
    ),
    "weight": Effect(
        "a weight", _waves(lambda m, _, wave: wave(m.log.position)), _if(lambda m: m.at.placed), beside=True,
        terms=("gravity_sin", "gravity_cos"),
    ),
    "spring": Effect(
        "a spring", _one(lambda m, _: m.log.position), _if(lambda m: m.at.placed), beside=True, terms=("stiffness",)
    ),
    "level by position": Effect(
        "a friction level that changes with position", _one(lambda m, _: m.sign * (m.log.position - m.at.middle)),
        _if(lambda m: m.at.placed), level=True, law_at="position {:.4g} {}",
    ),
    "ripple {}": Effect(
        "a force that repeats with position", _waves(lambda m, k, wave: wave(m.at.waves[int(k)] * m.log.position)),
        lambda m: map(str, range(len(m.at.waves))), beside=True,
    ),
    "level ripple {}": Effect(
        "a friction level that repeats with position",
        _waves(lambda m, k, wave: m.sign * wave(m.at.level_waves[int(k)] * m.log.position)),
        lambda m: map(str, range(len(m.at.level_waves))), level=True,
    ),
    "level by load column": Effect(
        "friction that grows with the measured load", _one(lambda m, _: _by_column(m, m.log.load)),
        _if(lambda m: m.log.load is not None), level=True, law_at="load 0",
    ),
    "level by pressure column": Effect(
        "friction that grows with the measured pressure", _one(lambda m, _: _by_column(m, m.log.pressure)),
        _if(lambda m: m.log.pressure is not None), level=True, law_at="pressure 0",
    ),
    "drift": Effect(DRIFT, _one(lambda m, _: m.wave(1)), of_record=True),
    "drift {}": Effect(DRIFT, _one(Motion.wave), _cosines, of_record=True),
    "level by time": Effect(
        BY_TIME, _one(lambda m, _: m.sign * m.wave(1)), level=True, of_record=True, law_at=MIDDLE
    ),
    "level by time {}": Effect(
        BY_TIME, _one(lambda m, n: m.sign * m.wave(n)), _cosines, level=True, of_record=True, law_at=MIDDLE
    ),
    "filter": Effect(
        "the cut-off frequency of the filter", _one(lambda m, _: _smoother_force(m) - m.inertial - m.friction),
        _if(lambda m: m.log.bandwidth), of_record=True,
    ),
}  # fmt: skip


def effect(form: str) -> tuple[Effect, float]:
    """The effect and the number of a form."""
    number = re.search(r"\d[\d.]*", form)
    return EFFECTS[form if number is None else form.replace(number[0], "{}")], float(number[0]) if number else 0.0


def forms(log: Log, at: Anchor) -> dict[Key, Column]:
    """Every form's columns along a log, each computed when it is called."""
    m, columns = Motion(log, at), dict[Key, Column]()
    for name, each in EFFECTS.items():
        for number in each.numbers(m):
            for part, column in each.columns.items():
                columns[name.format(number), part] = partial(column, m, float(number or 0))
    return columns


def in_words(form: str) -> str:
    """What a form is, for a reader; a text that names no form is returned as it is."""
    try:
        of, number = effect(form)
    except KeyError:
        return form
    return of.words.format(of.scale * number)


def sizes_in_words(sizes: Mapping[str, float], unit: str) -> str:
    """The effects of forms with their sizes; effects of one kind share their words."""
    kinds = dict[str, list[str]]()
    for form, size in sizes.items():
        kinds.setdefault(in_words(form), []).append(f"{size:.2g}")
    return ", ".join(f"{words} ({', '.join(several)} {unit})" for words, several in kinds.items())


def law_at(forms: Iterable[str], middle: float, unit: str) -> list[str]:
    """Where friction that depends on more than speed is the law's, of a model with these forms.

    Args:
        middle: the mean position, in ``unit``.
    """
    places = (effect(form)[0].law_at for form in forms)
    return list(dict.fromkeys(text.format(middle, unit) for text in places if text))


def dependences(estimates: Mapping[str, Estimate]) -> list[str]:
    """The estimates whose range depends on an effect that the model may lack, a sentence for each effect."""
    causes = dict[str, list[str]]()
    for name, e in estimates.items():
        if e.state is EstimateState.MODEL_DEPENDENT and e.depends_on:
            causes.setdefault(e.depends_on, []).append(name)
    return [f"{', '.join(names)}: the range covers {in_words(cause)}." for cause, names in causes.items()]


def sliding(log: Log, at: Anchor, names: Sequence[str]) -> Array:
    """The part of the friction at each row that has the direction of the motion, with some forms.

    Within a play a speed shows what follows the reversal, and nothing of the friction at this speed.
    """
    m = Motion(log, at)
    part = abs(m.sign)
    for of, number in map(effect, names):
        if of.slides:
            part = part * of.slides(m, number)
    return np.asarray(part)


def steady(form: str, v: Array, at: Anchor, rigid: bool = False) -> Array:
    """A form at steady speeds ``v`` > 0; 0 for forms that act only in unsteady motion.

    Args:
        rigid: whether the sign is exact, for F_s as the limit of zero speed.
    """
    of, number = effect(form)
    if of.at_speed is None:
        return np.zeros(len(v))
    return np.asarray((1.0 if rigid else at.curve.sign(v, at.shape)) * of.at_speed(at, v, number))


def fits(form: str, nodes: Sequence[Mapping[str, float]], fast: float) -> Array:
    """The nodes of the shapes at which a form differs from the law's own curve. A bend must be narrower than v_s."""
    of, width = effect(form)
    if not (of.peak and of.at_speed):
        return np.ones(len(nodes), bool)
    return np.asarray(width * fast < BENDS_BELOW * np.array([s.get("v_s", np.inf) for s in nodes]))
