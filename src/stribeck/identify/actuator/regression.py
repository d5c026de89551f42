"""A converged fit as a linear regression for the core: the outputs' Jacobian, with initial states eliminated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.drawn import input_errors
from stribeck.identify.actuator.guided import UnderGuide, steps_apart
from stribeck.identify.actuator.lacks import MissingForm, RunMotion
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.solve import fine_slopes, left_step
from stribeck.identify.core.choice import Selection, independent
from stribeck.identify.core.library import CELL, LEVELS, SEEN, STEEP, Model, ModelLibrary, seen_speeds
from stribeck.identify.core.search import search_forms
from stribeck.identify.core.states import Estimate, EstimateState, known, one_sided
from stribeck.identify.models.curves import REACHED
from stribeck.identify.models.record import BLOCK_ROWS, BLOCKS
from stribeck.laws.base import Law

SLIDING = 1e-3  # of the fastest speed: a slower contact counts as stuck
_STROKE = 5.0  # break-away distances: gross sliding begins after two or three
_ONE_LEVEL = "v_s is not identifiable: the friction level of slow motion may be F_c"
_NO_SLIDING = (
    "no stroke is long or fast enough to show where the curve ends: the friction level of slow motion may be F_s"
)
WIDE = 1 / 3  # of an initial state's range: its prior standard deviation


@dataclass(frozen=True)
class Levels:
    """Friction at recorded ``speeds``, by name; ``slow``, ``strokes``, ``viscous``: by contact, the slowest recorded speed, the
    longest way within a run in distances F_s/sigma_0, and sigma_2.

    ``values`` have ``slopes`` by the coordinates, and ``of_forms`` by the column of a form; ``static``: by that column, the
    F_s to which a form adds, and how much.
    """

    speeds: dict[str, float]
    slow: dict[str, float]
    strokes: dict[str, float]
    viscous: dict[str, float]
    values: Array
    slopes: Array
    of_forms: dict[int, Array]
    static: dict[int, tuple[str, float]]


@dataclass(kw_only=True)
class MachineLibrary(ModelLibrary):
    """Columns: residuals, and their derivatives by the coordinates and by all forms, in units of the noise.

    Recordings differ in load and drive, so they are not repeated runs: their files are one.

    Attributes:
        sought: the reported coordinates; ``u``: their point.
        J: derivatives of all residuals by all coordinates; ``left``: the step to the linearized problem's optimum.
        friction: of the contacts with fitted laws, at recorded speeds.
        measured: the changes of the measured columns.
        unit: the rms of each column before it was scaled to 1.
    """

    sought: list[MachineCoordinate]
    u: Array
    forms: list[MissingForm]
    friction: Levels
    measured: Array
    unit: Array
    J: Array
    left: Array

    @property
    def k(self) -> int:
        """The number of coordinates."""
        return len(self.sought)

    @property
    def by_ratio(self) -> frozenset[str]:
        """The parameters that are searched by their logarithm."""
        return frozenset(c.name for c in self.sought if c.logarithmic)

    @property
    def largest(self) -> float:
        """The largest change of the measured columns."""
        return float(np.max(abs(self.measured)))

    @property
    def deviation(self) -> float:
        """The standard deviation of the measured columns."""
        return float(np.std(self.measured))

    def parameters(self, model: Model, x: Array) -> dict[str, float]:
        """The fitted parameters and the levels. F_s is the level at rest, with all forms."""
        at = self.u + np.clip(x[: self.k], -20.0, 20.0)
        out = {c.name: c.outer(z) for c, z in zip(self.sought, at.tolist(), strict=True)}
        level = self.friction.values + self.friction.slopes @ x[: self.k]
        for place, column in enumerate(self.index(model)[self.k :], self.k):
            if column in self.friction.of_forms:
                level = level + x[place] * self.friction.of_forms[column]
                if column in self.friction.static:
                    name, height = self.friction.static[column]
                    out[name] = max(out[name] + float(x[place]) * height, 0.0)
        return out | dict(zip(self.friction.speeds, level.tolist(), strict=True))

    def fault(self, x: Array) -> Array:
        """A factor above 1 for steps beyond a cell, where the linearization is not valid."""
        far = np.max(abs(x[:, : self.k]), axis=1, initial=0.0)
        return np.where(far > CELL, STEEP, 1.0)

    def largest_hidden(self, form: str, unexplained: float) -> float:
        """The largest coefficient from the form's definition: a whitened residual shows nothing systematic."""
        return next(x.largest for x in self.forms if x.name == form) * float(self.unit[self.groups[form][0]])

    def level_of(self, name: str, value: Mapping[str, float]) -> tuple[float | None, bool]:
        """For a number that may be 0: where it moves the outputs as much as the number by ratio that moves them most.

        It is at most the range between its bounds.
        """
        i, c = next(((i, c) for i, c in enumerate(self.sought) if c.name == name), (0, None))
        if c is None or not c.low <= 0.0 <= c.high:
            return None, False
        moved = np.sqrt(np.einsum("bii->i", self.gram))[1 : 1 + self.k]
        largest = max((x for x, other in zip(moved, self.sought, strict=True) if other.logarithmic), default=moved[i])
        return (c.high - c.low) * min(float(largest / max(moved[i], 1e-300)), 1.0), True

    def concluded(self, estimates: dict[str, Estimate]) -> dict[str, Estimate]:
        """Clip estimates to their bounds, and withhold those whose interval is outside.

        Without slow rows, F_s and v_s become one-sided bounds. Without long strokes, F_c is withheld beside
        an open v_s; and so it is beside a v_s at its upper bound.
        """
        for c in self.sought:
            estimates[c.name] = estimates[c.name].within(c.low, c.high)
        of_path = {path: c.name for c in self.sought for path in c.targets}
        highest = {c.name: c.high for c in self.sought}
        for contact, slowest in self.friction.slow.items():
            law = f"contacts.{contact}.law.parameters."
            level, static, speed, viscous = (of_path.get(f"{law}{n}", "") for n in ("F_c", "F_s", "v_s", "sigma_2"))
            F_s, v_s = estimates.get(static), estimates.get(speed)
            if v_s is None or v_s.identifiable:
                continue
            slow = self.friction.strokes[contact] < _STROKE or np.isclose(v_s.value, highest[speed])
            if level in estimates and slow:
                withheld = replace(estimates[level], state=EstimateState.NOT_IDENTIFIABLE, why=_NO_SLIDING)
                estimates[level] = withheld
            if F_s is None:
                continue
            if slowest <= REACHED * v_s.value:  # no speed tells where the curve ends
                estimates[static] = replace(F_s, state=EstimateState.NOT_IDENTIFIABLE, why=_ONE_LEVEL)
                continue
            at_slowest = f"{contact} {LEVELS[0]}"
            of_speed = estimates.get(viscous, known(self.friction.viscous[contact]))
            levels = [estimates[at_slowest].less(of_speed, self.friction.speeds[at_slowest])]
            levels += [estimates[level]] if level in estimates else []
            estimates[static], estimates[speed] = one_sided(F_s, v_s, levels)
        return estimates


def regressed(
    problem: MachineProblem, u: Array, motion: RunMotion, forms: Sequence[MissingForm], under_guide: UnderGuide | None = None,
    at_bound: bool = True,
) -> Selection[MachineLibrary]:  # fmt: skip
    """The law alone and its models with forms, linearized at a converged point.

    ``motion``, ``forms``: those at this point. ``under_guide``: of a second estimate, the coordinates and their deviations.
    Without it, known errors are left out: the models can be compared, and have no intervals. ``at_bound``: whether parameters
    at a bound are coordinates, which pass it; else they stay there.
    """
    inside = (problem.low < u) & (u < problem.high) | at_bound
    asked = [i for i, c in enumerate(problem.sought) if not c.nuisance and inside[i]]
    starts = [i for i, c in enumerate(problem.sought) if c.nuisance]
    sought, scale = _linear(problem, u, asked)
    r, J = problem.residuals(u[None])[0], fine_slopes(problem, u)
    room = (problem.high - problem.low)[starts] * WIDE
    of_forms = [problem.whitened(form.slopes) for form in forms]
    clean = _without(J[:, starts] * room, np.column_stack([-r, J[:, asked] * scale, *of_forms]))
    known = list[Array]()
    if under_guide is not None:
        known = [*input_errors(problem, u, J), (J @ steps_apart(problem, u, under_guide))[None]]
    drawn = [_without(J[:, starts] * room, x.T).T for x in known]
    first = 1 + len(asked)
    rms = np.maximum(np.sqrt(np.mean(clean**2, axis=0)), 1e-300)
    moves = np.append(np.ones(first, bool), rms[first:] > 0)
    forms = [form for form, some in zip(forms, moves[first:], strict=True) if some]
    clean[:, 0] -= clean[:, 1:first] @ np.linalg.lstsq(clean[:, 1:first], clean[:, 0], rcond=1e-12)[0]  # converged
    unit = np.append(np.ones(first), rms[first:])[moves]
    columns = np.ascontiguousarray(clean[:, moves] / unit)
    groups: dict[str, list[int]] = {}
    for place, form in enumerate(forms, first):
        groups.setdefault(form.name, []).append(place)
    block = _blocks(problem)
    gram = np.array([columns[block == b].T @ columns[block == b] for b in range(block.max() + 1)])
    gram = gram + columns[block < 0].T @ columns[block < 0] / len(gram)  # priors belong to every block
    measured = [(t.x - t.x.mean()) / problem.noise[t.column] for _, t, _ in problem.pieces]
    lib = MachineLibrary(
        columns=columns, gram=gram, groups=groups, starts=[1], natural=[1.0] * columns.shape[1],
        sought=sought, u=np.array([c.inner(problem.sought[i].outer(u[i])) for i, c in zip(asked, sought, strict=True)]),
        forms=forms, measured=problem.whitened(np.concatenate(measured)),
        unit=unit, J=J, drawn=drawn,
        left=left_step(problem, u, r, J)[asked] / scale,
        friction=_levels(problem, u, asked, scale, motion, dict(enumerate(forms, first)), unit),
    )  # fmt: skip
    search_forms(lib)
    solved, sse = lib.solve(gram.sum(0))
    choice = Selection([lib], [solved], independent(lib, solved, sse), alone=True)
    choice.index = next(i for i, m in enumerate(lib.models) if not m[1])
    return choice


def _linear(problem: MachineProblem, u: Array, asked: Sequence[int]) -> tuple[list[MachineCoordinate], Array]:
    """The coordinates in which the residuals are linear, and their slopes by these over those by the searched ones.

    The logarithm of a number at its lower bound has no effect there: no step within a cell shows, and one that would show
    is beyond it. The number itself has an effect, and its error is that of the number.
    """
    sought, scale = [], np.ones(len(asked))
    for n, i in enumerate(asked):
        c = problem.sought[i]
        sought.append(replace(c, plain=True) if c.logarithmic and u[i] <= problem.low[i] else c)
        scale[n] = sought[n].slope(sought[n].inner(c.outer(u[i]))) / c.slope(u[i])
    return sought, scale


def _without(starts: Array, columns: Array) -> Array:
    """Columns with the initial states eliminated, each of which has a weak prior."""
    if not starts.shape[1]:
        return columns
    h = starts.T @ starts + np.eye(starts.shape[1])
    return np.asarray(columns - starts @ np.linalg.solve(h, starts.T @ columns))


def _blocks(problem: MachineProblem) -> NDArray[np.intp]:
    """The block of time of each residual; -1 for priors."""
    log = np.concatenate([np.full(len(t.t), float(problem.runs[k].log)) for k, t, _ in problem.pieces])
    time = np.concatenate([t.t for _, t, _ in problem.pieces])
    compared = len(time)
    count = int(np.clip(compared // BLOCK_ROWS, 2, BLOCKS))
    block = np.full(problem.size, -1, np.intp)
    block[np.lexsort((time, log))] = np.arange(compared) * count // compared
    return block


def _levels(
    problem: MachineProblem, u: Array, asked: Sequence[int], scale: Array, motion: RunMotion, forms: Mapping[int, MissingForm],
    unit: Array,
) -> Levels:  # fmt: skip
    """The levels at four recorded speeds, and their derivatives by the coordinates and by each form's column.

    ``scale``: of the derivatives, see :func:`_linear`.
    """
    speeds, spans = dict[str, float](), dict[str, slice]()
    slow, strokes, viscous = dict[str, float](), dict[str, float](), dict[str, float]()
    fitted = problem.numbers(problem.repaired(u[None])[0])
    for contact in problem.runs[0].scenario.data.get("contacts", {}):
        law = f"contacts.{contact}.law"
        w = abs(motion.column(f"{contact}.w"))
        sliding = w[w > SLIDING * w.max(initial=0.0)]
        if not any(p.startswith(f"{law}.") for i in asked for p in problem.sought[i].targets) or not len(sliding):
            continue
        slow[contact] = float(np.quantile(w, SEEN[0]))
        ways = (cumulative_trapezoid(run[f"{contact}.w"], run["t"]) for run in motion.runs)
        p = _law(problem, contact, fitted).p
        longest, viscous[contact] = max(float(np.ptp(way)) for way in ways), p.numbers.get("sigma_2", 0.0)
        level = max(p.F_c, p.numbers.get("F_s", 0.0), 1e-300) if "F_c" in p.numbers else 0.0
        strokes[contact] = longest * p.sigma_0 / level if level and "sigma_0" in p.numbers else np.inf
        spans[contact] = slice(len(speeds), len(speeds) + len(LEVELS))
        speeds |= {f"{contact} {n}": v for n, v in zip(LEVELS, seen_speeds(sliding), strict=True)}
    v = np.array(list(speeds.values()))

    def levels(point: Array) -> Array:
        numbers = problem.numbers(problem.repaired(point[None])[0])
        parts = [_law(problem, contact, numbers).steady_force(v[rows]) for contact, rows in spans.items()]
        return np.concatenate(parts) if parts else np.zeros(0)

    base, slopes = levels(u), np.zeros((len(v), len(asked)))
    for n, i in enumerate(asked):
        step = problem.step if u[i] + problem.step <= problem.high[i] else -problem.step
        slopes[:, n] = (levels(u + step * (np.arange(len(u)) == i)) - base) / step * scale[n]
    of_forms, static = dict[int, Array](), dict[int, tuple[str, float]]()
    F_s = {path: problem.sought[i] for i in asked for path in problem.sought[i].targets if path.endswith(".F_s")}
    for place, form in forms.items():
        if form.at is not None and form.contact in spans:
            rows, of_forms[place] = spans[form.contact], np.zeros(len(v))
            of_forms[place][rows] = form.at(base[rows], v[rows]) / unit[place]
            if c := F_s.get(path := f"contacts.{form.contact}.law.parameters.F_s"):
                level = np.array([fitted[path]])
                static[place] = c.name, float(form.at(level, np.zeros(1))[0] / unit[place])
    return Levels(speeds, slow, strokes, viscous, base, slopes, of_forms, static)


def _law(problem: MachineProblem, contact: str, numbers: Mapping[str, float]) -> Law:
    """The law of a contact, with some numbers of the machine changed."""
    path = f"contacts.{contact}.law"
    law, inside = problem.runs[0].scenario.elements.laws[path], f"{path}."
    names = {p.removeprefix(inside).removeprefix("parameters."): x for p, x in numbers.items() if p.startswith(inside)}
    return law.replace(**{n: x for n, x in names.items() if n in law.constants()})
