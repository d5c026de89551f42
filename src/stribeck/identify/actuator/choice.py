"""Chooses laws and terms by held-out recordings, and fits simpler friction for comparison."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from stribeck import laws as known_laws
from stribeck.constants import show
from stribeck.errors import InputError, StribeckError, StribeckNote, arg, first_line, nearest
from stribeck.identify.actuator.coordinates import SPEED, MachineCoordinate, paths
from stribeck.identify.actuator.estimate import BestPoint, Estimation
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.runs import recorded_run
from stribeck.identify.actuator.traces import traces
from stribeck.identify.result import MachineFit
from stribeck.identify.result_parts import Baseline, Picked
from stribeck.laws.base import PARAMETERS, Law
from stribeck.scenario import Scenario
from stribeck.scenario.trust import astray
from stribeck.simulation import simulate

if TYPE_CHECKING:
    from stribeck.identify.actuator.api import Fitting

_EARNS = 0.01  # of the held-out error: the least reduction that justifies a further parameter
_STEEP = 50.0  # k_v in units of 1/speed: the smooth sign is complete at a few hundredths of the speed
_ELASTIC = 0.5  # of F_c/sigma_0: initial value of z_ba
_WIDE = 100.0  # ratio of the bounds of a new constant to its initial value, which is only an order of magnitude
_FEWER = 6  # starts of fits that only serve for comparison
BASELINES = {"no friction": None, "Coulomb and viscous": "coulomb_viscous", "Stribeck curve": "stribeck"}


def check(scenario: Scenario, laws: Mapping[str, Sequence[str]], given: Collection[str]) -> None:
    """Check that contacts and laws exist, and that laws in files elsewhere are among those ``given``.

    LOGS.toml may come from an untrusted source.

    Raises:
        InputError: a line for each problem.
    """
    folder, contacts = scenario.folder, scenario.data.get("contacts", {})
    text = "lies outside the machine's folder, and a law is a program that would be executed"
    if strange := [
        f"laws.{contact}: {show(name)}: {text}: must be in that folder or below it, or given with {arg('law')}"
        for contact, names in laws.items() for name in astray([name for name in names if name not in given], folder, folder)
    ]:  # fmt: skip
        raise InputError(strange)
    problems = [f"law.{c}: no such contact{nearest(c, contacts)}" for c in laws if c not in contacts]
    for contact, name in ((contact, name) for contact, names in laws.items() for name in names):
        try:
            known_laws.find(name, folder)
        except InputError as error:
            problems += [f"law.{contact}: {line}" for line in error.problems]
    if problems:
        raise InputError(problems)


def held_out_error(scenario: Scenario, best: BestPoint, held: Sequence[tuple[int, Recording]]) -> float:
    """The relative error over held-out recordings (root mean square over the columns)."""
    parts = [
        x.relative for i, r in held for x in traces(scenario, r, i, best.problem.sought, best.values(), best.bandwidth)
    ]
    return float(np.sqrt(np.mean(np.square(parts)))) if parts else float("nan")


def with_laws(
    scenario: Scenario, sought: Sequence[MachineCoordinate], laws: Mapping[str, str], speeds: Mapping[str, float]
) -> tuple[Scenario, list[MachineCoordinate]]:
    """The machine with other laws in some contacts. New constants are fitted too, within wide bounds."""
    coordinates = list(sought)
    for contact, name in laws.items():
        path = f"contacts.{contact}.law"
        old = scenario.data["contacts"][contact]["law"]
        law = known_laws.find(name, scenario.folder)
        if old.get("name") == name:
            continue
        values, fresh = _constants(path, old, law, paths(coordinates), speeds[contact])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StribeckNote)
            scenario = scenario.with_changes({f"{path}.name": name, **values})
        has = {f"{path}.parameters.{n}" for n in law.constants()} | {f"{path}.{n}" for n in law.constants()}
        coordinates = [c for c in coordinates if not any(p.startswith(f"{path}.") and p not in has for p in c.targets)]
        coordinates += fresh
    return scenario, coordinates


def _constants(
    path: str, old: Mapping[str, object], law: type[Law], sought: Collection[str], speed: float
) -> tuple[dict[str, object], list[MachineCoordinate]]:
    """Values of the constants that the old law does not have, and coordinates of those that matter."""
    parameters = old.get("parameters", {})
    have = {**old, **(parameters if isinstance(parameters, dict) else {})}
    level = float(have.get("F_c", 1.0))
    guess = {
        "F_c": level, "F_s": 1.2 * level, "v_s": 0.1 * speed, "sigma_2": 0.1 * level / speed, "k_v": _STEEP / speed,
        "sigma_0": 300 * level / speed, "sigma_1": 0.3 * level / speed,
    }  # fmt: skip
    guess["z_ba"] = _ELASTIC * level / float(have.get("sigma_0", guess["sigma_0"]))
    values: dict[str, object] = {}
    fresh: list[MachineCoordinate] = []
    for name, constant in law.constants().items():
        x = guess.get(name, constant.example if constant.example is not None else constant.default)
        if name in have or constant.choices or (constant.optional and name != "k_v") or x is None:
            continue
        place = f"{path}.parameters.{name}" if name in PARAMETERS else f"{path}.{name}"
        values[place] = x
        if (name in PARAMETERS or name == "z_ba") and place not in sought:
            bends = constant.unit == SPEED
            fresh.append(MachineCoordinate(place, x / _WIDE, x * _WIDE, x, None, {place: 1.0}, bends=bends))
    return values, fresh


def _speeds(fit: Fitting) -> dict[str, float]:
    """A typical speed in each contact, from a simulation of the machine with its present values."""
    contacts = fit.scenario.data.get("contacts", {})
    try:
        i, recording = fit.fitted[0]
        solution = simulate(recorded_run(fit.scenario, recording, i).scenario)
        return {name: max(float(np.sqrt(np.nanmean(solution[f"{name}.w"] ** 2))), 1e-6) for name in contacts}
    except (StribeckError, KeyError):
        return dict.fromkeys(contacts, 1.0)


def among_laws(fit: Fitting, laws: Mapping[str, Sequence[str]]) -> tuple[BestPoint, Picked, list[str]]:
    """Fit every combination of the given laws, and give the fit the one that predicts held-out recordings best.

    Among nearly equal ones the simplest is chosen.

    Returns:
        Its best point on all fitted recordings, all laws that were tried, and notes.
    """
    fit.work.section(0.6)
    fitted, held, notes = _split(fit)
    speeds = _speeds(fit)
    tried: dict[str, tuple[Scenario, list[MachineCoordinate], BestPoint]] = {}
    failed: dict[str, str] = {}
    for names in product(*laws.values()):
        label = ", ".join(f"{c} = {n}" for c, n in zip(laws, names, strict=True))
        try:
            scenario, sought = with_laws(fit.scenario, fit.sought, dict(zip(laws, names, strict=True)), speeds)
            best = Estimation(scenario, fitted, sought, fit.starts, fit.seed, fit.work).best()
        except StribeckError as error:
            failed[label] = first_line(error)
            continue
        tried[label] = (scenario, sought, best)
        if best.stopped:
            break
    if not tried:
        raise InputError([f"law: {label}: {why}" for label, why in failed.items()])
    errors = {label: held_out_error(scenario, best, held) for label, (scenario, _, best) in tried.items()}
    numbers = {label: len(sought) for label, (_, sought, _) in tried.items()}
    finite = [label for label in tried if np.isfinite(errors[label])] or list(tried)
    least = min(errors[label] for label in finite)
    near = [label for label in finite if not errors[label] > (1 + _EARNS) * least]
    picked = min(near, key=lambda label: (numbers[label], errors[label]))
    fit.scenario, fit.sought, best = tried[picked]
    if len(fitted) != len(fit.fitted) and not best.stopped:
        best = Estimation(fit.scenario, fit.fitted, fit.sought, 1, fit.seed, fit.work, best.values()).best()
    return best, {"picked": picked, "errors": errors, "numbers": numbers, "failed": failed}, notes


def _split(fit: Fitting) -> tuple[list[tuple[int, Recording]], list[tuple[int, Recording]], list[str]]:
    """The fitted and the held-out recordings of a comparison of laws, and a note about them."""
    if fit.held_out:
        return fit.fitted, fit.held_out, []
    if len(fit.fitted) > 1:
        note = f"{fit.fitted[-1][1].file} was held out to compare laws, and fitted afterwards"
        return fit.fitted[:-1], fit.fitted[-1:], [note]
    return fit.fitted, fit.fitted, ["one recording only: laws are compared by the error of the fit itself"]


def baselines(fit: Fitting, result: MachineFit) -> dict[str, Baseline]:
    """Residuals of simpler friction: none; Coulomb and viscous; Coulomb, Stribeck and viscous.

    Raises:
        Stopped: after Ctrl-C, when a search may not have converged.
    """
    fitted_paths = paths(fit.sought)
    contacts = [
        name for name in fit.scenario.data.get("contacts", {})
        if any(p.startswith(f"contacts.{name}.") for p in fitted_paths)
    ]  # fmt: skip
    rows: dict[str, Baseline] = {
        "the law fitted": {"fitted": result.error(False), "held_out": result.error(True), "numbers": len(fit.sought)}
    }
    if not contacts:
        return rows
    speeds = _speeds(fit)
    values = {name: p.value for name, p in result.estimates.items()}
    for label, law in BASELINES.items():
        try:
            if law is None:
                scenario, sought = without_contacts(fit, contacts)
            else:
                base = Scenario(result.data, folder=fit.scenario.folder)
                scenario, sought = with_laws(base, fit.sought, dict.fromkeys(contacts, law), speeds)
            best = Estimation(scenario, fit.fitted, sought, _FEWER, fit.seed, fit.work, values).best()
            fit.work.check()
            errors = [held_out_error(scenario, best, part) for part in (fit.fitted, fit.held_out)]
            rows[label] = {"fitted": errors[0], "held_out": errors[1] if fit.held_out else None, "numbers": len(sought)}
        except InputError:  # a recorded column that the simpler machine lacks, such as a contact's force
            continue
        except StribeckError as error:
            rows[label] = {"why": first_line(error)}
    return rows


def without_contacts(fit: Fitting, contacts: Sequence[str]) -> tuple[Scenario, list[MachineCoordinate]]:
    """The machine without the fitted friction."""
    kept = {n: t for n, t in fit.scenario.data["contacts"].items() if n not in contacts}
    gone = tuple(f"contacts.{n}." for n in contacts)
    sought = [c for c in fit.sought if not any(p.startswith(gone) for p in c.targets)]
    return Scenario({**fit.scenario.data, "contacts": kept}, folder=fit.scenario.folder), sought
