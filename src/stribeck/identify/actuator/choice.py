"""Chooses laws and terms by held-out recordings, and fits simpler friction for comparison."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from stribeck import laws as known_laws
from stribeck.constants import show
from stribeck.errors import InputError, StribeckError, arg, first_line, nearest
from stribeck.identify.actuator.coordinates import SPEED, MachineCoordinate, paths
from stribeck.identify.actuator.estimate import BestPoint, estimate
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.result import Baseline, MachineFit, Picked
from stribeck.identify.actuator.traces import traces
from stribeck.laws.base import PARAMETERS, Law
from stribeck.scenario import Scenario
from stribeck.scenario.trust import astray

if TYPE_CHECKING:
    from stribeck.identify.actuator.api import Fitting

_EARNS = 0.01  # of the held-out error: the least reduction that justifies a further parameter
_STEEP = 50.0  # k_v in units of 1/speed: the smooth sign is complete at a few hundredths of the speed
_ELASTIC = 0.5  # of F_c/sigma_0: initial value of z_ba
_FEWER = 6  # starts of fits that only serve for comparison
BASELINES = {"Coulomb and viscous": "coulomb_viscous", "Stribeck curve": "stribeck"}


@dataclass
class Chosen:
    """The chosen law."""

    scenario: Scenario
    sought: list[MachineCoordinate]
    estimate: BestPoint | None
    told: Picked | None = None
    notes: list[str] = field(default_factory=list)


def check(scenario: Scenario, laws: Mapping[str, Sequence[str]], given: Collection[str]) -> None:
    """Check that contacts and laws exist, and that laws in files elsewhere are among those ``given``.

    LOGS.toml may come from an untrusted source.

    Raises:
        InputError: a line for each problem.
    """
    folder, contacts = scenario.folder, scenario.data.get("contacts", {})
    text = "lies outside the machine's folder, and a law is a program that would be executed"
    if strange := [
        f"laws.{contact}: {show(name)}: {text}: must be in that folder or below it, or given with {arg('laws')}"
        for contact, names in laws.items() for name in astray([name for name in names if name not in given], folder, folder)
    ]:  # fmt: skip
        raise InputError(strange)
    problems = [f"law.{c}: no such contact{nearest(c, contacts)}" for c in laws if c not in contacts]
    for contact, names in laws.items():
        for name in names:
            try:
                known_laws.find(name, scenario.folder)
            except InputError as error:
                problems += [f"law.{contact}: {line}" for line in error.problems]
    if problems:
        raise InputError(problems)


def held_out_error(fit: Fitting, scenario: Scenario, best: BestPoint, held: Sequence[tuple[int, Recording]]) -> float:
    """The relative error over held-out recordings (root mean square over the columns)."""
    window = float(np.median([run.scenario.end for run in best.problem.runs])) if best.windowed else None
    parts = [
        x.relative for i, r in held for x in traces(scenario, r, i, best.problem.sought, best.values(), window)
    ]  # fmt: skip
    return float(np.sqrt(np.mean(np.square(parts)))) if parts else float("nan")


def with_laws(
    scenario: Scenario, sought: Sequence[MachineCoordinate], laws: Mapping[str, str], speeds: Mapping[str, float]
) -> tuple[Scenario, list[MachineCoordinate]]:
    """The machine with other laws in some contacts. New constants are fitted too, within wide bounds."""
    import warnings

    from stribeck.errors import StribeckNote

    coordinates = list(sought)
    for contact, name in laws.items():
        path = f"contacts.{contact}.law"
        old = scenario.data["contacts"][contact]["law"]
        law = known_laws.find(name, scenario.folder)
        if old.get("name") == name:
            continue
        changes, fresh = _constants(path, old, law, coordinates, speeds[contact])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StribeckNote)
            scenario = scenario.with_changes({f"{path}.name": name, **changes})
        has = {f"{path}.parameters.{n}" for n in law.constants()} | {f"{path}.{n}" for n in law.constants()}
        coordinates = [c for c in coordinates if not any(p.startswith(f"{path}.") and p not in has for p in c.targets)]
        coordinates += fresh
    return scenario, coordinates


def _constants(
    path: str, old: Mapping[str, object], law: type[Law], sought: Sequence[MachineCoordinate], speed: float
) -> tuple[dict[str, object], list[MachineCoordinate]]:
    """Values of the constants that the old law does not have, and coordinates of those that matter."""
    parameters = old.get("parameters", {})
    have = {
        **(parameters if isinstance(parameters, dict) else {}),
        **{n: x for n, x in old.items() if n not in ("name", "parameters")},
    }
    level = float(have.get("F_c", 1.0))
    guess = {
        "F_c": level, "F_s": 1.2 * level, "v_s": 0.1 * speed, "sigma_2": 0.1 * level / speed, "k_v": _STEEP / speed,
        "sigma_0": 300 * level / speed, "sigma_1": 0.3 * level / speed,
    }  # fmt: skip
    guess["z_ba"] = _ELASTIC * level / float(have.get("sigma_0", guess["sigma_0"]))
    changes: dict[str, object] = {}
    fresh: list[MachineCoordinate] = []
    places = paths(sought)
    for name, constant in law.constants().items():
        if name in have or constant.choices or (constant.optional and name != "k_v"):
            continue
        place = f"{path}.parameters.{name}" if name in PARAMETERS else f"{path}.{name}"
        x = guess.get(name, constant.example if constant.example is not None else constant.default)
        if x is None:
            continue
        changes[place] = x
        if (name in PARAMETERS or name == "z_ba") and place not in places:
            fresh.append(
                MachineCoordinate(place, x / 100, x * 100, x, None, {place: 1.0}, bends=constant.unit == SPEED)
            )
    return changes, fresh


def _speeds(fit: Fitting) -> dict[str, float]:
    """A typical speed in each contact, from a simulation of the machine with its present values."""
    found = {}
    for contact in fit.scenario.data.get("contacts", {}):
        try:
            from stribeck.identify.actuator.runs import recorded_run
            from stribeck.simulation import simulate

            i, recording = fit.fitted[0]
            solution = simulate(recorded_run(fit.scenario, recording, i).scenario)
            w = solution[f"{contact}.w"]
            found[contact] = max(float(np.sqrt(np.nanmean(w**2))), 1e-6)
        except (StribeckError, KeyError):
            found[contact] = 1.0
    return found


def among_laws(fit: Fitting, laws: Mapping[str, Sequence[str]]) -> Chosen:
    """Fit every combination of the given laws, and choose the one that predicts held-out recordings best.

    Among nearly equal ones the simplest is chosen.
    """
    fitted, held, note = _split(fit)
    speeds = _speeds(fit)
    tried: dict[str, tuple[Scenario, list[MachineCoordinate], BestPoint]] = {}
    failed: dict[str, str] = {}
    combinations = list(product(*laws.values()))
    for names in combinations:
        label = ", ".join(f"{c} = {n}" for c, n in zip(laws, names, strict=True))
        try:
            scenario, sought = with_laws(fit.scenario, fit.sought, dict(zip(laws, names, strict=True)), speeds)
            best = estimate(
                scenario, fitted, sought, fit.starts, fit.seed, fit.work, fit.kept.load(label), fit.kept.saver(label)
            )
        except StribeckError as error:
            failed[label] = first_line(error)
            continue
        tried[label] = (scenario, sought, best)
        if best.stopped:
            break
    if not tried:
        raise InputError([f"law: {label}: {why}" for label, why in failed.items()])
    rows = [
        (held_out_error(fit, scenario, best, held), len(sought), label, Chosen(scenario, sought, best))
        for label, (scenario, sought, best) in tried.items()
    ]
    finite = [row for row in rows if np.isfinite(row[0])] or rows
    least = min(row[0] for row in finite)
    picked = min((row for row in finite if not row[0] > (1 + _EARNS) * least), key=lambda row: (row[1], row[0]))
    told: Picked = {
        "picked": picked[2], "errors": {row[2]: row[0] for row in rows}, "numbers": {row[2]: row[1] for row in rows},
        "failed": failed,
    }  # fmt: skip
    chosen = picked[3]
    again = chosen.estimate if len(fitted) == len(fit.fitted) else None
    if again is None and chosen.estimate is not None and not chosen.estimate.stopped:
        again = estimate(chosen.scenario, fit.fitted, chosen.sought, 1, fit.seed, fit.work, chosen.estimate.values())
    return Chosen(chosen.scenario, chosen.sought, again or chosen.estimate, told, [note] if note else [])


def _split(fit: Fitting) -> tuple[list[tuple[int, Recording]], list[tuple[int, Recording]], str]:
    """The fitted and the held-out recordings of a comparison of laws."""
    if fit.held:
        return fit.fitted, fit.held, ""
    if len(fit.fitted) > 1:
        return (
            fit.fitted[:-1],
            fit.fitted[-1:],
            f"{fit.fitted[-1][1].file} was held out to compare laws, and fitted afterwards",
        )
    return fit.fitted, fit.fitted, "one recording only: laws are compared by the error of the fit itself"


def baselines(fit: Fitting, result: MachineFit) -> dict[str, Baseline]:
    """Residuals of simpler friction: none; Coulomb and viscous; Coulomb, Stribeck and viscous."""
    contacts = [
        name for name in fit.scenario.data.get("contacts", {})
        if any(p.startswith(f"contacts.{name}.") for c in fit.sought for p in c.targets)
    ]  # fmt: skip
    own: Baseline = {"fitted": result.error(False), "held_out": result.error(True), "numbers": len(fit.sought)}
    found: dict[str, Baseline] = {"the law fitted": own}
    if not contacts:
        return found
    speeds = _speeds(fit)
    values = {name: p.value for name, p in result.estimates.items()}
    kinds: list[tuple[str, str | None]] = [("no friction", None), *BASELINES.items()]
    for label, law in kinds:
        try:
            if law is None:
                scenario, sought = without_contacts(fit, contacts)
            else:
                base = Scenario(result.data, folder=fit.scenario.folder)
                scenario, sought = with_laws(base, fit.sought, dict.fromkeys(contacts, law), speeds)
            best = estimate(scenario, fit.fitted, sought, _FEWER, fit.seed, fit.work, values)
            errors = [held_out_error(fit, scenario, best, part) for part in (fit.fitted, fit.held)]
            found[label] = {"fitted": errors[0], "held_out": errors[1] if fit.held else None, "numbers": len(sought)}
        except InputError:  # a recorded column that the simpler machine lacks, such as a contact's force
            continue
        except StribeckError as error:
            found[label] = {"why": first_line(error)}
    return found


def without_contacts(fit: Fitting, contacts: Sequence[str]) -> tuple[Scenario, list[MachineCoordinate]]:
    """The machine without the fitted friction."""
    data = {
        **fit.scenario.data,
        "contacts": {n: t for n, t in fit.scenario.data["contacts"].items() if n not in contacts},
    }
    sought = [
        c for c in fit.sought if not any(p.startswith(tuple(f"contacts.{n}." for n in contacts)) for p in c.targets)
    ]
    return Scenario(data, folder=fit.scenario.folder), [replace(c) for c in sought]
