"""Each parameter of a machine with both uncertainties and its state, and forms that would explain the residual."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
from scipy.sparse.csgraph import connected_components

from stribeck.arrays import Array
from stribeck.identify.actuator import advise
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.estimate import BestPoint
from stribeck.identify.actuator.lacks import RunMotion, forms_in_words, missing_forms
from stribeck.identify.actuator.regression import MachineLibrary, regressed
from stribeck.identify.actuator.solve import covariance
from stribeck.identify.core.choice import Selection
from stribeck.identify.core.judging import judged as by_core
from stribeck.identify.core.states import Estimate, EstimateState
from stribeck.identify.models.forms import dependences
from stribeck.identify.result_parts import Group
from stribeck.scenario import Scenario

RELATED = 0.95  # correlation above which two parameters cannot be separated: it makes an interval three times as wide
# Difference of BIC up to which models explain equally well: "positive" evidence ends here (Kass and Raftery).
EQUAL = 6.0
_CREPT = "the search crept along a valley and did not come to its end (other first values, or another motion, help)"
FORMS = 3  # sets of forms that are reported: the best, and two that explain as much


@dataclass
class JudgedParameters:
    """Parameters and friction levels with their uncertainties, correlations and notes."""

    estimates: dict[str, Estimate]
    levels: dict[str, Estimate] = field(default_factory=dict)
    speeds: dict[str, float] = field(default_factory=dict)
    correlated: list[Group] = field(default_factory=list)
    relation: tuple[list[str], Array] | None = None
    notes: list[str] = field(default_factory=list)


def judged(
    best: BestPoint, scenario: Scenario, trusted: bool, advised: bool = True, words: Mapping[str, str] | None = None
) -> JudgedParameters:
    """The estimates of a converged fit.

    Args:
        advised: whether recordings that would identify open parameters are looked for.
        trusted: whether the model describes the recordings; if not, nothing is identified.
        words: for paths and contacts in the result.
    """
    problem, u = best.problem, best.u
    asked = [i for i, c in enumerate(problem.sought) if not c.nuisance]
    if not asked:
        return JudgedParameters({})
    motion = RunMotion.of(problem, u)
    forms = missing_forms(problem, u, motion, words or {})
    choice = regressed(problem, u, motion, forms, best.under_guide)
    lib = choice.library
    estimates = by_core(choice, trusted=trusted, lower=lib.parameters(choice.model, lib.left))
    units = {c.name: unit(scenario, c) for c in lib.sought}
    columns = {c.name: c.unit for c in scenario.system.columns}
    units |= {name: columns.get(f"{name.partition(' ')[0]}.F", "") for name in lib.friction.speeds}
    labels = {form.name: form.label for form in lib.forms}
    names, relation = [c.name for c in lib.sought], _relation(lib)
    for name, e in estimates.items():
        state, why = (EstimateState.NOT_IDENTIFIABLE, _CREPT) if _crept(e) else (e.state, e.why)
        if state is EstimateState.NOT_IDENTIFIABLE and not why:
            why = _wide(e, name, names, relation)
        estimates[name] = replace(e, state=state, unit=units[name], depends_on=labels.get(e.depends_on, ""), why=why)
    open_ = [i for i in asked if not estimates[problem.sought[i].name].identifiable]
    texts = advise.experiments(problem, u, lib.J, open_ if advised else [])
    for i in open_:
        name = problem.sought[i].name
        estimates[name] = replace(estimates[name], experiment=texts.get(i, estimates[name].experiment))
    levels = {n: estimates.pop(n) for n in lib.friction.speeds}
    # a missing effect repeats itself from sample to sample: prediction errors hardly contain it
    plain = regressed(problem.without_whitening(), u, motion, forms) if problem.colored else choice
    notes = [*_explained(plain), *dependences(estimates)]
    return JudgedParameters(estimates, levels, lib.friction.speeds, _groups(names, relation), (names, relation), notes)


def blank(best: BestPoint, scenario: Scenario, why: str) -> JudgedParameters:
    """The values of a fit that was stopped, without uncertainties."""
    state, values = EstimateState.NOT_IDENTIFIABLE, best.values()
    estimates = {
        c.name: Estimate(values[c.name], (-np.inf, np.inf), None, state, unit(scenario, c), why=why)
        for c in best.problem.sought if not c.nuisance
    }  # fmt: skip
    return JudgedParameters(estimates)


def _crept(e: Estimate) -> bool:
    """Whether the step that the search left is longer than the estimate's error by the covariance."""
    return e.parts["M"] > e.parts["C"]


def _relation(lib: MachineLibrary) -> Array:
    """The correlation of the fitted parameters."""
    gram = lib.gram.sum(0)[1 : 1 + lib.k, 1 : 1 + lib.k]
    c = covariance(gram)
    size = np.sqrt(np.maximum(np.diag(c), 1e-300))
    return np.asarray(c / np.outer(size, size))


def _groups(names: list[str], relation: Array) -> list[Group]:
    """Groups of parameters that cannot be separated."""
    _, group_of = connected_components(abs(relation) > RELATED, directed=False)
    groups: list[Group] = []
    for k in range(group_of.max() + 1):
        group = np.flatnonzero(group_of == k).tolist()
        pairs = {
            f"{names[a]} ~ {names[b]}": float(relation[a, b])
            for a, b in combinations(group, 2) if abs(relation[a, b]) > RELATED
        }  # fmt: skip
        if pairs:
            groups.append({"names": [names[i] for i in group], "correlation": pairs})
    return groups


def _wide(e: Estimate, name: str, names: list[str], relation: Array) -> str:
    """How wide an interval is, and the parameters that one cannot be separated from."""
    low, high = e.interval
    wide = f"its interval spans a factor of {high / low:.2g}" if low > 0 else f"its interval is {low:.3g} to {high:.3g}"
    if name not in names:  # a level
        return wide
    row = relation[names.index(name)]
    others = [names[i] for i in np.argsort(-abs(row)) if names[i] != name and abs(row[i]) > RELATED]
    return f"{wide}; confounded with {' and '.join(others[:2])}" if others else wide


def _explained(choice: Selection[MachineLibrary]) -> list[str]:
    """The forms that would explain the residual, in words, and alternatives that explain as much: a note each."""
    lib = choice.library
    _, k, _, ratio = choice.choose(np.ones(len(lib.gram)), alone=False)
    if not (chosen := lib.models[k][1]):
        return []
    solved, sse = lib.solve(lib.gram.sum(0))
    score = lib.scores(sse, choice.rows)
    near = [
        i for i in np.argsort(score).tolist()
        if i != k and score[i] < score[k] + EQUAL and len(lib.models[i][1]) == len(chosen)
    ]  # fmt: skip
    words = [forms_in_words(_coefficients(lib, i, solved[i]), lib.forms) for i in [k, *near][:FORMS]]
    first = f"These effects would lower the residual by {100 * (1 - ratio):.3g} %: {words[0]}."
    return [first, *(f"These effects would lower it as much: {other}." for other in words[1:])]


def _coefficients(lib: MachineLibrary, i: int, x: Array) -> dict[str, float]:
    """The first coefficient of each of a model's forms, in its unit."""
    at = {column: n for n, column in enumerate(lib.index(lib.models[i]))}
    first = {g: lib.groups[g][0] for g in lib.models[i][1]}
    return {g: float(x[at[column]] / lib.unit[column]) for g, column in first.items()}


def unit(scenario: Scenario, c: MachineCoordinate) -> str:
    """The unit of a fitted number, if the machine declares it."""
    if c.output is not None:
        of = next((x.unit for x in scenario.system.columns if x.name == c.output[0]), "")
        return {"offset": of, "gain": "1", "delay": "s", "clock": "s/s"}.get(c.output[1], "")
    path = next(iter(c.targets))
    owner, name = scenario.places.get(path, ("", path.rpartition(".")[2]))
    if owner == "initial":
        body = scenario.system.elements.bodies[name.rpartition(".")[0]]
        length = "rad" if body.turns else "m"
        return length if name.endswith(".y") else f"{length}/s"
    tables = scenario.system.tables
    if owner in scenario.elements.laws or owner in tables:
        constants = scenario.elements.laws[owner].constants() if owner in scenario.elements.laws else tables[owner][0]
        if name in constants:
            return constants[name].unit_for(bool(owner in tables and tables[owner][1])) or "1"
    return ""
