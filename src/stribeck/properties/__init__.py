"""Decisions about the properties of a law, by proofs or by counterexamples that the simulator replays."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from stribeck.constants import require_positive
from stribeck.errors import InputError
from stribeck.laws.base import Law
from stribeck.properties.checked import at_level, check_law, check_varied
from stribeck.properties.verdicts import NAMES, Verdict, Verdicts

if TYPE_CHECKING:
    from stribeck.properties.ports import MachineVerdicts
    from stribeck.scenario import Scenario
    from stribeck.scenario.objects import Machine

__all__ = ["NAMES", "Verdict", "Verdicts", "check"]

WORK = 2400.0  # regions examined for all five properties; a count does not depend on the computer's speed


@overload
def check(
    what: Law, v_max: float | None = None, *, level: tuple[float, float] | None = None,
    work: float = WORK,
    **tolerated: Any,
) -> Verdicts: ...  # fmt: skip


@overload
def check(
    what: Machine | Scenario | str | Path | Mapping[str, object], v_max: float | None = None, *,
    force: Mapping[str, float] | None = None, t_end: float | None = None, work: float = WORK,
) -> MachineVerdicts: ...  # fmt: skip


def check(
    what: Law | Machine | Scenario | str | Path | Mapping[str, object], v_max: float | None = None, *,
    level: tuple[float, float] | None = None, force: Mapping[str, float] | None = None, t_end: float | None = None,
    work: float = WORK, **tolerated: Any,
) -> Verdicts | MachineVerdicts:  # fmt: skip
    """Decide five properties of a law with its constants, or of each contact of a machine.

    Args:
        what: a law; or a machine, a scenario, its file or its tables. Each contact is then checked for every history of its
            constants that the file allows: signals over the whole run, positions and speeds without limit.
        v_max: check passivity for \\|v\\| <= v_max, m/s; for every v unless given.
        level: of a law, (LOW, HIGH): F_c and F_s vary together in any way between LOW and HIGH times their values. A verdict
            holds for every such history.
        force: of a machine, assumed bounds of forces by the name of a link, load or motor, N or N m.
        t_end: of a machine, end of the run over which signals are bounded, s; the scenario's unless given.
        **tolerated: of a law with k_v, tolerances: ``creep``, ``steady_error`` at a ``speed``
            (:class:`stribeck.properties.steepness.Tolerated`). ``.steepness`` is then the smallest k_v that meets them.
        work: largest number of regions of (v, z) to examine; undecided properties are then None.

    Returns:
        The verdicts: each true with a proof, false with a counterexample, or None with the reason
        (docs/explanation/check.md).

    Raises:
        InputError: if ``v_max`` is not a finite number > 0, ``level`` is not a range, the law does not allow such constants,
            or the scenario is not valid.
        MissingExtra: if python-flint is not installed.
    """
    if v_max is not None:
        require_positive("v_max", v_max, "m/s")
    if not isinstance(what, Law):
        from stribeck.properties.ports import check_machine

        if level is not None:
            raise InputError("level: must be left out for a machine: its file defines what varies")
        if tolerated:
            raise InputError([f"{name}: must be left out for a file: it is about one law" for name in tolerated])
        return check_machine(what, v_max, force, t_end, work)
    alien = {"force": force, "t_end": t_end}
    if problems := [f"{name}: must be left out for a law: it is about a machine" for name, x in alien.items() if x]:
        raise InputError(problems)
    steepness = {}
    if tolerated:
        from stribeck.properties.steepness import Tolerated, smallest_steepness

        steepness = smallest_steepness(what, Tolerated.given({**tolerated, "v_max": v_max}))
    varied = None if level is None else at_level(what, level)
    verdicts = check_law(what, v_max, work) if varied is None else check_varied(varied, v_max, work)
    verdicts.steepness = steepness
    return verdicts
