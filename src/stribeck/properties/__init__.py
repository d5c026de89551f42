"""What a law with given constants guarantees: proofs, and counterexamples that the simulator replays."""

from __future__ import annotations

import importlib
import logging
from collections.abc import Callable
from functools import partial
from time import process_time

import numpy as np

from stribeck.constants import require_positive
from stribeck.errors import needed
from stribeck.laws.base import Law
from stribeck.properties.checked import Checked
from stribeck.properties.storage import storage_interval
from stribeck.properties.verdicts import NAMES, Verdict, Verdicts, accepted, undecided

__all__ = ["NAMES", "Verdict", "Verdicts", "check", "storage_interval"]

WORK = 2400.0  # regions looked at for all five properties; it does not depend on the machine's speed

_log = logging.getLogger(__name__)


def check(
    law: Law, v_max: float | None = None, work: float = WORK, level: tuple[float, float] | None = None
) -> Verdicts:
    """Whether a law with its constants has each of the five properties.

    Args:
        law: the law.
        v_max: passivity is asked for \\|v\\| <= v_max, m/s; for every v unless given.
        work: how many regions of (v, z) may be looked at; what is not decided by then is null.
        level: (LOW, HIGH): F_c and F_s vary together, in any way, between LOW and HIGH times their values (by load, position,
            temperature); a verdict holds for every such history.

    Returns:
        The verdicts: each true with a proof, false with a counterexample, or null with the reason. docs/check.md.

    Raises:
        InputError: ``v_max`` is no finite number > 0, ``level`` is no range, or the law does not allow such
            constants.
        MissingExtra: python-flint is not installed.
    """
    if v_max is not None:
        require_positive("v_max", v_max, "m/s")
    if level is not None:
        from stribeck.properties.level import check_level

        return check_level(law, level, v_max, work)
    started = process_time()
    if not law.has_z:
        reason = f"law '{law.name}' has no internal state z, which the properties are about"
        return Verdicts(law, {name: undecided(reason) for name in NAMES}, v_max)
    with needed("a proof"):
        importlib.import_module("flint")
    checked = Checked(law, v_max, work)
    with np.errstate(all="ignore"):  # samples may leave the range of floats; they prove nothing
        found = {name: _safely(partial(_accepted, checked, name), name) for name in NAMES}
    return Verdicts(law, found, v_max, process_time() - started)


def _accepted(checked: Checked, name: str) -> Verdict:
    return accepted(getattr(checked, name)(), checked.law, name, checked.v_max)


def _safely(decide: Callable[[], Verdict], name: str) -> Verdict:
    """A verdict; undecided where the equations are such that the check itself fails."""
    try:
        return decide()
    except (OverflowError, ZeroDivisionError) as error:
        _log.debug("numbers of '%s' leave the floats", name, exc_info=True)
        return undecided(f"a number on the way is too large or too small for a float ({error})")
    except Exception as error:
        _log.debug("the check of '%s' failed", name, exc_info=True)
        return undecided(f"the equations cannot be treated: {type(error).__name__}: {error}")
