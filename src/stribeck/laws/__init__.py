"""Friction laws. Each equation is written once, and every file in this folder is registered."""

from __future__ import annotations

from collections.abc import Container, Mapping
from functools import lru_cache
from pathlib import Path
from types import ModuleType

import numpy as np

from stribeck import kinds, parameter_sets
from stribeck.constants import Constant, kind_of, show
from stribeck.errors import InputError, arg, error_text, nearest
from stribeck.laws.base import IN_MEMORY, PARAMETERS, BristleLaw, Claims, Law, Relation, Scales, StaticLaw

__all__ = [
    "BristleLaw", "Claims", "Law", "Relation", "Scales", "StaticLaw", "builtin", "find", "gap", "law", "parameters_for",
    "trouble",
]  # fmt: skip

_LISTED_FIRST = ("lugre", "elastoplastic", "dahl", "static")


@lru_cache(maxsize=1)
def builtin() -> dict[str, type[Law]]:
    """Every law of the package by name."""
    modules = kinds.modules(__name__, __path__, _LISTED_FIRST)
    return {name: law for module in modules for name, law in _laws_of(module).items()}


def _laws_of(module: ModuleType) -> dict[str, type[Law]]:
    return {law.name: law for law in kinds.classes(module, Law) if law not in (BristleLaw, StaticLaw)}


def find(name: object, folder: Path | None = None) -> type[Law]:
    """The law called ``name``: a built-in one, or ``FILE.py:NAME`` with FILE relative to ``folder``.

    Raises:
        InputError: there is no such law, or the file does not load.
    """
    if not isinstance(name, str):
        raise InputError(f"{show(name)}: must be the name of a law, not {kind_of(name)}")
    if name in IN_MEMORY:
        return IN_MEMORY[name]
    if ".py:" in name:
        return _from_file(name, folder)
    if name not in builtin():
        guess = nearest(name, builtin()) or f" (known: {', '.join(builtin())}; or FILE.py:NAME)"
        raise InputError(f"{name!r}: no such law{guess}")
    return builtin()[name]


def _from_file(name: str, folder: Path | None) -> type[Law]:
    module, path, wanted = kinds.load_module(name, folder)
    laws = _laws_of(module)
    by_class = {cls.__name__: cls for cls in laws.values()}
    if wanted in laws or wanted in by_class:
        return laws.get(wanted) or by_class[wanted]
    if isinstance(getattr(module, wanted, None), type):
        raise InputError(f"{name!r}: {wanted} is no law: it must be derived from BristleLaw, StaticLaw or Law")
    raise InputError(f"{name!r}: {path} has no law '{wanted}' (it has {', '.join(by_class) or 'none'})")


def overflow(law: Law) -> str | None:
    """A message if a law's constants are too large or too small for its equations, or None."""
    try:
        speed, length = np.float64(law.scales(law.p).speed), np.float64(0.0)
        with np.errstate(all="ignore"):  # the constants are Python's floats, which raise an error on overflow
            law.friction(law.p, speed, length, law.dz_dt(law.p, speed, length))
    except ArithmeticError as error:
        return f"its equations cannot be evaluated with these constants: {type(error).__name__}"
    return None


def trouble(law: Law) -> str | None:
    """The reason why the equations of a user's law cannot be evaluated, or None."""
    try:
        scales = law.scales(law.p)
        at = scales.speed, 0.5 * scales.length
        values = (law.force(*at), *law.jacobian(*at))
        if not all(np.ndim(x) == 0 for x in values):
            return "its equations must give one number for one v and z"
        given = {"F": law.force} | ({"dz/dt": law.rate} if law.has_z else {})
        wrong = [n for n, f in given.items() if np.isnan(f(*at)) and np.isnan(f(at[0], 0.0))]  # not all finite
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        return f"its equations cannot be evaluated: {error_text(error)}"
    return f"its equations give nan as {wrong[0]} at v = {at[0]:g} m/s, z = {at[1]:g} m and 0" if wrong else None


def parameters_for(
    law: type[Law] | None, name: str, folder: Path | None = None, given: Container[str] = ()
) -> dict[str, float]:
    """The values that a law takes from a parameter set, which may hold the constants of other laws too.

    Args:
        law: the law, or None for the machine's own parameters.
        name: a built-in set, or a TOML file.
        folder: base of a relative path.
        given: parameters that replace those of the set, which need not determine them.

    Raises:
        InputError: there is no such set, or no law has one of its constants.
    """
    needs = None if law is None else [n for n in law.constants() if n not in given]
    parameter_set = parameter_sets.load(name, folder, needs)
    values = parameter_set.values
    constants = law.constants() if law is not None else {}
    known = dict.fromkeys(
        n for each in (PARAMETERS, constants, *(c.constants() for c in builtin().values())) for n in each
    )
    if law is not None and (odd := [n for n in values if n not in known and n not in parameter_set.words]):
        raise InputError(
            [f"{name!r}: {n} = {show(values[n])}: no law has such a constant{nearest(n, known)}" for n in odd]
        )
    every: dict[str, Constant] = {**PARAMETERS, **constants}
    meant = {n: (every[n].unit_for(False), every[n].unit_for(True), "SI") for n in parameter_set.units if n in every}
    if wrong := [n for n, units in meant.items() if parameter_set.units[n] not in units]:
        raise InputError(
            [
                f"{name!r}: {n}.unit: {show(parameter_set.units[n])}: must be {' or '.join(dict.fromkeys(meant[n][:2]))}"
                for n in wrong
            ]
        )
    kinds = {  # 0 linear, 1 rotary, by the units of the constants
        n: meant[n].index(u)
        for n, u in parameter_set.units.items()
        if n in meant and len(set(meant[n])) == 3 and u != "SI"
    }
    if len(set(kinds.values())) > 1:
        listed = ", ".join(f"{n} in {parameter_set.units[n]}" for n in kinds)
        raise InputError(f"{name!r}: {listed}: must be units of one kind of motion, straight or turning")
    return {n: value for n, value in values.items() if n in PARAMETERS or n in constants}


def law(name: str, parameters: str | Path | Mapping[str, float] | None = None, **constants: float | str | None) -> Law:
    """A friction law with its constants.

    Args:
        name: a built-in law's name (:func:`library` lists them), or ``"FILE.py:NAME"`` for a law of your own.
        parameters: parameters of the machine in SI units: a mapping, the name of a built-in set, or the path of a set's file.
        **constants: constants of the law (``k_v=1e7``, ``smooth_abs="sqrt"``); they also override single parameters.
            ``rotary=True`` selects N m and rad instead of N and m; otherwise the set decides.

    Raises:
        InputError: if the law or set is unknown, or a value is not allowed; one line for each problem.
    """
    law_class, rotary = find(name), constants.pop("rotary", None)
    if not isinstance(rotary, bool | None):
        raise InputError(f"{arg('rotary')}: {show(rotary)}: must be True or False")
    if isinstance(parameters, str | Path):
        values, turns = (
            parameters_for(law_class, str(parameters), given=constants),
            parameter_sets.load(str(parameters), needs=()).rotary,
        )
        return law_class({**values, **constants}, turns if rotary is None else bool(rotary))
    if parameters is not None and not isinstance(parameters, Mapping):
        must = "must be a table of numbers by name, or a set's name or file"
        raise InputError(f"{arg('parameters')}: {show(parameters)}: {must}, not {kind_of(parameters)}")
    return law_class({**(parameters or {}), **constants}, bool(rotary))
