"""What a static fit of a law is made of: which constants it is linear in, which shape its curve, which it cannot see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.identify.features.guess import Sizes, ranges, sizes_of
from stribeck.identify.features.sliding import Sliding
from stribeck.identify.log import thinned
from stribeck.identify.models import delay, play, ripple
from stribeck.identify.models.dynamic_problem import free_constants
from stribeck.identify.models.separable import Separable, Shape
from stribeck.identify.models.static_problem import Rows
from stribeck.identify.models.terms import TERMS, complete
from stribeck.laws.base import Law

_STEEP = 10.0  # over the Stribeck velocity: a sign that is steep beside it, whatever the unit of the speed
_SHARP = 1e9  # s/m
_SHARPEST = 1e6  # over the largest speed: for motion of micrometres per second
_SLOW = 0.05  # of the largest speed
_CHANGED = 30.0  # of the argument of a smooth sign at the slowest rows: it is one at a tenth of their speed too
_SMOOTH = 1.5  # times the squares: what a sign that still bends at the slowest rows of one direction must take away
_SHOWN, _SHOWN_SHARE = 10, 0.05  # rows that a bend of the curve needs at least; of few rows


@dataclass(frozen=True)
class StaticModel:
    """A law and the terms of the body against a record.

    Attributes:
        whole: the model.
        free: the law's constants that were to be fitted; ``given``: those that were not.
        unseen: those that the data show nothing of, and why.
        notes: for the reader.
    """

    law: type[Law]
    whole: Separable
    free: tuple[str, ...]
    given: dict[str, float]
    unseen: dict[str, str]
    notes: list[str] = field(default_factory=list)


def model(
    rows: Rows,
    law: type[Law],
    fixed: Mapping[str, float],
    free: Sequence[str] | None,
    mass: float | None,
    body: Sequence[str],
) -> StaticModel:
    """The model of a static fit.

    Args:
        rows: of the record.
        law, fixed, free, mass: as in :class:`stribeck.identify.methods.static.Setting`.
        body: the terms beside mass.

    Raises:
        InputError: a constant is unknown or missing.
    """
    notes: list[str] = []
    held_terms = {n: v for n, v in fixed.items() if n in TERMS}
    given = {n: v for n, v in fixed.items() if n not in TERMS}
    free = _with_steepness(law, given, free, body, held_terms, notes)
    wanted = free_constants(law, given, {}, free)
    if "k_v" in given and "k_v" not in fixed:  # a default: the force changes sign at once then, as in the literature
        given["k_v"] = _sharp(rows)
    sizes = sizes_of(thinned(rows.log), mass or 0.0)
    sliding = Sliding(law, given, _typical(law, sizes, given))
    own = law.own_constants()
    unseen = {
        n: "a static fit sees sliding at held speeds only, and there this constant plays no part"
        for n in wanted
        if n not in sliding.seen and n not in own
    }
    terms = [n for n in complete([*(["mass"] if mass is None else []), *body], held_terms) if n not in held_terms]
    if any(TERMS[n].level for n in terms) and "F_c" not in sliding.linear:
        raise InputError(
            f"{arg('terms')}: in law '{law.name}' no friction level F_c multiplies the force, so none can vary"
        )
    terms = _told_apart(rows, terms, unseen, notes)
    if "k_v" in given and "k_v" not in fixed and "F_c_by_direction" in terms:
        unseen["F_c_by_direction"] = "where the sign changes at once it is an offset: k_v must be fitted too"
        terms.remove("F_c_by_direction")
    linear = [n for n in wanted if n in sliding.linear and n not in unseen]
    shapes = [_shape(n, law, sizes, rows) for n in wanted if n not in sliding.linear and n not in unseen]
    if "delay" in terms:
        longest = delay.longest(rows.log.step)
        shapes.append(Shape("delay", -longest, longest, log=False))
    if "ripple_waves" in terms:
        shapes.append(_ripple(rows))
    if "play" in terms:
        shapes.append(_play(rows))
    held = {**{n: sliding.base[n] for n in unseen if n in sliding.base}, **given, "delay": 0.0, **held_terms}
    if "delay" in terms:
        del held["delay"]
    if mass is not None:
        held["mass"] = mass
    whole = Separable(rows.columns(sliding), held, linear, terms, shapes, rows.weight)
    return StaticModel(law, whole, tuple(wanted), dict(fixed), unseen, notes)


def _with_steepness(
    law: type[Law], given: Mapping[str, float], free: Sequence[str] | None, body: Sequence[str],
    held: Mapping[str, float], notes: list[str],
) -> Sequence[str] | None:  # fmt: skip
    """k_v too, where a static law needs it, and where a delay does: with an exact sign it finds nothing."""
    own = law.own_constants()
    if law.has_z or "k_v" not in own or "k_v" in given or "k_v" in (free or ()):
        return free
    late = "delay" in body and "delay" not in held
    if not (own["k_v"].required or late):
        return free
    if late and not own["k_v"].required:
        notes.append("k_v is fitted too: a delay cannot be told with a sign that jumps")
    usual = free if free is not None else [n for n in law.uses if n not in given]
    return [*usual, "k_v"]


def _sharp(rows: Rows) -> float:
    """The steepness of a sign that changes at once, s/m."""
    return max(_SHARP, _SHARPEST / float(np.max(abs(rows.log.velocity))))


def _told_apart(rows: Rows, terms: Sequence[str], unseen: dict[str, str], notes: list[str]) -> list[str]:
    """The terms without an offset where all motion is one way."""
    v = rows.log.velocity
    if "offset" not in terms or not _one_way(v):
        return list(terms)
    why = "all motion is in one direction: friction and an offset (gravity, a sensor's zero) cannot be told apart there"
    unseen["offset"] = why
    notes.append(f"{why}; the offset is taken as 0, so that the levels hold both")
    return [n for n in terms if n != "offset"]


def _one_way(v: Array) -> bool:
    """Whether all motion is in one direction."""
    return min(-float(v.min()), float(v.max())) <= 0.02 * float(np.max(abs(v)))


def _typical(law: type[Law], sizes: Sizes, given: Mapping[str, float]) -> dict[str, float]:
    """Rough values that the law allows."""
    found = {n: r.value for n, r in ranges(law, sizes).items()}
    found |= {n: _STEEP / found["v_s"] for n, c in law.constants().items() if c.unit == "s/m" and n in found}
    if "F_c" in given or "F_s" in given:
        level = given.get("F_c", 0.8 * given.get("F_s", 1.0))
        found |= {"F_c": level, "F_s": given.get("F_s", 1.5 * level)}
    z_ba = given.get("z_ba", found.get("z_ba"))
    if z_ba is not None and "sigma_0" in found:
        found["sigma_0"] = min(found["sigma_0"], 0.5 * found["F_c"] / z_ba)
    return found


def _shape(name: str, law: type[Law], sizes: Sizes, rows: Rows) -> Shape:
    """Where a constant that shapes the curve is looked for."""
    constant, v = law.constants()[name], rows.log.velocity
    if constant.unit == "s/m":
        slowest = float(np.quantile(abs(v), 0.01))
        if (
            _one_way(v) and slowest > _SLOW * sizes.fast
        ):  # no row shows the sign change: a curve that fits would be guessed
            return Shape(name, 0.3 / slowest, 1e4 / sizes.fast, seen=_CHANGED / slowest, worth=_SMOOTH)
        return Shape(name, 0.3 / sizes.fast, 1e4 / sizes.fast, usual=_sharp(rows) if name == "k_v" else None)
    if constant.unit == "m/s":
        low, half = (min(max(1e-3 * sizes.fast, x), 0.35 * sizes.fast) for x in (_slowest(rows), 0.5 * _slowest(rows)))
        if _one_way(v):  # the foot of a bend may show where its middle does not
            return Shape(name, half, 0.7 * sizes.fast, seen=low)
        return Shape(name, low, 0.7 * sizes.fast)
    middle = constant.example or constant.default or ranges(law, sizes)[name].value
    return Shape(name, 0.2 * middle, 5 * middle, usual=constant.default)


def _ripple(rows: Rows) -> Shape:
    """How many waves are looked for.

    Raises:
        InputError: the record cannot show any.
    """
    if (found := ripple.range_of(rows.log, rows.q)) is None:
        raise InputError(
            f"{arg('terms')}: 'ripple_waves': the way holds too few of the waves that such rows show; must be given"
        )
    return Shape("ripple_waves", *found)


def _play(rows: Rows) -> Shape:
    """Over what way friction may turn round.

    Raises:
        InputError: the body never comes back.
    """
    if (found := play.range_of(rows.log)) is None:
        raise InputError(f"{arg('terms')}: 'play': needs motion in both directions: it shows behind reversals only")
    return Shape("play", *found)


def _slowest(rows: Rows) -> float:
    """The speed that some rows lie below: a bend of the curve that hardly a row shows is one of the noise."""
    v = np.sort(abs(rows.log.velocity[rows.kept][rows.weight > 0]))
    return float(v[min(_SHOWN, int(_SHOWN_SHARE * len(v)))]) if len(v) else 0.0


def unit_of(law: type[Law], name: str) -> str:
    """The unit of a constant of the law or of a term of the body."""
    return TERMS[name].unit if name in TERMS else law.constants()[name].unit
