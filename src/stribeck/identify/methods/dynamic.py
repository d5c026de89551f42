"""Simulation-error fit: the law's constants with which the simulated force meets the measured one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from stribeck.arrays import Array
from stribeck.errors import StribeckError
from stribeck.identify.beyond import seen
from stribeck.identify.log import Log
from stribeck.identify.methods.blockwise import solve_blocks
from stribeck.identify.methods.optimise import STOPPED, Optimum, multistart, starting_points
from stribeck.identify.models.dynamic_problem import Given, VelocityProblem, velocity_problem
from stribeck.identify.models.motion_problem import white_noise
from stribeck.identify.models.problem import Problem, Tie
from stribeck.identify.models.terms import TERMS
from stribeck.identify.result import Fit, Prediction
from stribeck.identify.statistics import uncertainty
from stribeck.identify.statistics.crossvalidate import LeftOut, cross_validate
from stribeck.identify.statistics.verdicts import Noise
from stribeck.identify.work import Work

_STARTS = 20


def fit_dynamic(
    log: Log,
    law: str,
    *,
    fixed: Given | None = None,
    free: Sequence[str] | None = None,
    tied: Mapping[str, Tie] | None = None,
    start: Given | None = None,
    mass: float | None = None,
    body: Sequence[str] = ("offset",),
    starts: int = _STARTS,
    seed: int = 0,
    profiles: bool = True,
    folds: int = 0,
    work: Work | None = None,
) -> Fit:
    """Fit a law's constants so that the force simulated for the measured velocity meets the measured force.

    Args:
        log: the record, SI units.
        law: the law's name, or FILE.py:NAME.
        fixed: constants and terms that are given, such as the law's own constants (k_v, z_ba).
        free: constants to fit; by default those of the machine that are not given.
        tied: constants that follow another one: ``{"F_s": Tie("F_c", 1.4)}``.
        start: values to start from; the other starts fill a range around what the data suggest.
        mass: kg; None fits it.
        body: terms of the force beside mass and friction, fitted unless ``fixed`` holds them
            (:data:`stribeck.identify.models.terms.TERMS`).
        starts: how many starting points; the seed makes them the same each time.
        seed: of the starting points.
        profiles: find intervals from profiles of the likelihood; else from the covariance alone.
        folds: parts of a cross-validation, whose :class:`stribeck.identify.statistics.crossvalidate.LeftOut` is then in
            ``details["left_out"]``; 0 for none.
        work: told how far the fit is, and asked whether to stop; Ctrl-C leaves a fit with status "stopped".

    Returns:
        The fit; its ``details["search"]`` says how the starts ended.

    Raises:
        InputError: constants are unknown, missing or not allowed; nothing moves.
        BuildError: there is no C compiler.
        StribeckError: no start led to a simulation that works.
    """
    problem, first, low, high = velocity_problem(
        log, law, fixed=fixed, free=free, tied=tied, start=start, mass=mass, body=body
    )
    began = starting_points(problem, first, low, high, starts, seed)
    return fitted(problem, began, log, profiles, folds, work or Work())


def fitted(problem: VelocityProblem, began: list[Array], log: Log, profiles: bool, folds: int, work: Work) -> Fit:
    """The problem's best fit from these starts, judged, and cross-validated where there are ``folds``; as above."""
    level = white_noise(log.force, list(log.runs()))
    noise = Noise(level, level)
    with threadpool_limits(1):  # the starts run beside each other; more threads of linear algebra only spin
        work.section(0.7)
        optimum = multistart(problem, began, work)
        if problem.misfit(optimum.point) is None:
            raise StribeckError(f"law '{problem.law.name}': no start led to a simulation that works")
        work.section(0.9 if folds >= 2 else 1.0)
        judged = judged_of(problem, optimum, log, profiles, noise, work)
        fit = fit_of(problem, judged.point, judged, optimum, log, work)
        if folds < 2 or work.stopped:
            return fit
        left_out = cross_validated(problem, judged.point, log, folds)
        work.done(1.0)
    return replace(
        fit,
        cross_validated_error=left_out.error,
        notes=(*fit.notes, f"cross-validated {left_out.how}"),
        details={**fit.details, "left_out": left_out},
    )


def cross_validated(problem: VelocityProblem, point: Array, log: Log, folds: int) -> LeftOut:
    """The problem fitted anew without each part of the log, from the optimum of all, and what it misses there.

    The simulation runs through the part that is left out, whose force it does not see.
    """

    def missed_without(out: NDArray[np.bool_]) -> tuple[float, float]:
        training = problem.with_rows(~out)
        found = solve_blocks(training, training.without_unseen_starts(point), 1e-6, 30).point
        found = training.nearest(training.without_unseen_starts(found))  # nothing has kept them in place
        force = training.force(found[None, :])
        missed = np.inf if force is None else float(np.sum((force[0] - log.force)[out] ** 2))
        return missed, float(np.sum(log.force[out] ** 2))

    return cross_validate(log, folds, sum(not c.nuisance for c in problem.coordinates), missed_without)


def judged_of(
    problem: Problem, optimum: Optimum, log: Log, profiles: bool, noise: Noise, work: Work
) -> uncertainty.ConfidenceIntervals:
    """What is known at an optimum; the bare values where Ctrl-C comes before that is clear."""
    try:
        return uncertainty.judge(problem, optimum.point, log, profiles, noise, work)
    except KeyboardInterrupt:
        work.stop()
        return uncertainty.without(problem, optimum.point, STOPPED)


def fit_of(
    problem: VelocityProblem, point: Array, judged: uncertainty.ConfidenceIntervals, optimum: Optimum, log: Log, work: Work
) -> Fit:  # fmt: skip
    """The fit from its optimum and what was judged of it; ``point``: the optimum in the problem's coordinates."""
    force = problem.force(point[None, :])
    if force is None:
        raise StribeckError(f"law '{problem.law.name}': the fit cannot be simulated along the measured motion")
    values, misfit = problem.values(point), log.force - force[0]
    beside = problem.of_body([values])[0]
    notes = [] if optimum.converged and (optimum.starts == 1 or optimum.agreeing > 1) else [optimum.verdict]
    if work.stopped:
        notes = [STOPPED]
    return Fit(
        law_name=problem.law.name,
        method="dynamic",
        estimates={n: e for n, e in judged.estimates.items() if n not in TERMS},
        body={n: e for n, e in judged.estimates.items() if n in TERMS},
        fixed=problem.fixed,
        used=problem.describe(point),
        names=judged.names,
        covariance=judged.covariance,
        relative_force_error=float(np.linalg.norm(misfit) / np.linalg.norm(log.force)),
        data_hash=log.hash,
        profiles=judged.profiles,
        prediction=Prediction(log.time, log.position, log.velocity, log.force - beside, force[0] - beside),
        notes=(*([] if optimum.exhausted and not work.stopped else notes), *judged.notes),
        details={"search": optimum.verdict, "noise": judged.noise, "seen": seen(log, np.ones(len(log), bool))},
        status="stopped" if work.stopped else "done",
    )
