"""``stribeck.fit``: a log in, parameters out."""

from __future__ import annotations

import copy
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from stribeck import laws
from stribeck.constants import show
from stribeck.errors import InputError, StribeckError, arg, nearest
from stribeck.identify.data.prepare import Preparation, load
from stribeck.identify.data.read import Columns
from stribeck.identify.data.units import ROLES
from stribeck.identify.log import Log
from stribeck.identify.methods.dynamic import fit_dynamic
from stribeck.identify.methods.motion import fit_motion
from stribeck.identify.methods.presliding import fit_presliding
from stribeck.identify.methods.static import Setting, check_motion
from stribeck.identify.models.terms import TERMS
from stribeck.identify.result import Fit
from stribeck.identify.statistics.choose import Choice, choose, fit_with_baselines, select_law, select_terms
from stribeck.identify.statistics.crossvalidate import FOLDS
from stribeck.identify.work import Work
from stribeck.recorded import is_table

_POOR = 0.25  # of the force, left by the fit
PLAIN = "coulomb_viscous"  # least squares itself: nothing is added to it unasked

Data = Any  # a path, a Log, a data frame or mapping of columns, or a sequence of paths or frames


def fit(
    data: Data,
    law: str | Sequence[str] | None = None,
    *,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    force_gain: float | str | None = None,
    mass: float | None = None,
    method: str | None = None,
    constants: Mapping[str, float | str] | None = None,
    free: Sequence[str] = (),
    terms: Sequence[str] = (),
    select: bool | None = None,
    cutoff: float | None = None,
    trim: int | None = None,
    decimate: int | None = None,
    robust: bool = False,
    folds: int = FOLDS,
    starts: int = 20,
    seed: int = 0,
    output: str = "force",
    drive: Mapping[str, Any] | None = None,
    progress: Callable[[float], None] | None = None,
    **named: str,
) -> Fit | Choice:
    """Fit a friction law, or several, to a measured log.

    Args:
        data: a file (CSV, Parquet, MAT, NPZ), a pandas data frame, a mapping of names to arrays, several of these of
            one layout, or a :class:`stribeck.identify.log.Log`.
        law: its name or FILE.py:NAME; a list of them is compared by the error over data left out, and one picked; None
            picks a static law and its terms.
        columns: the file's column for each role: time, position, velocity, force, ...; also as keywords
            (``time="t"``). A TOML file of the data's name beside it may hold them.
        units: the unit of a column by its name; SI unless given.
        force_gain: force per unit of the force column: a number, or the name of a constant in the file.
        mass: kg; fitted unless given (presliding: 0 unless given).
        method: "static", "presliding" or "dynamic"; by default static for a law without bristles, else dynamic.
        constants: constants of the law that are given (k_v, z_ba, or any other), and terms.
        free: constants of the law's own to fit too (k_v).
        terms: what the force holds beside friction, mass and offset (docs/fit.md).
        select: add such terms as lower the error over left-out blocks (static); by default where neither terms nor
            ``free`` are given, but for coulomb_viscous, which is then least squares as published.
        cutoff: of the motion's filter, Hz; chosen from the data unless given; 0 for none.
        trim: samples dropped at the start of a run.
        decimate: one row in so many is fitted (static); chosen from the data unless given.
        robust: Huber's loss (static).
        folds: of the cross-validation.
        starts: of the simulation-error fit; ``seed`` makes them the same each time.
        output: what the simulation is to meet: "force" for the measured motion, or "velocity" or "position" for the
            measured force or command (dynamic; one law).
        drive: what moves the body then, as ``[drive]`` of a scenario without its signal; the measured force unless given.
        progress: called with the share done of fits by simulation, 0 to 1, in any thread. Ctrl-C ends such a fit; what it
            found until then is returned, with status "stopped".
        **named: columns by role; a name that is no role is refused.

    Returns:
        The fit, or for several laws a :class:`Choice`.

    Raises:
        InputError: data, columns, units or constants cannot be used; a line for each problem.
    """
    names = [] if law is None else [law] if isinstance(law, str) else list(law)
    sharp = is_simulated(names, method)
    log = read_log(data, {**(columns or {}), **named}, units, force_gain, cutoff, trim, sharp)
    ask = _Request(
        mass, method, dict(constants or {}), tuple(free), tuple(terms), select, decimate, robust, folds, starts, seed,
        output, drive,
    )  # fmt: skip
    ask.work = Work(progress)
    if output != "force" and len(names) != 1:
        raise InputError(f"{arg('output')}: laws are compared by the force they predict; must be given with one law")
    if not names:
        return ask.any_law(log)
    if len(names) == 1:
        return ask.fit(log, names[0])
    if method is None and any(laws.find(name).has_z for name in names):
        ask.method = "dynamic"  # errors compare within one method only
    ask.cross = folds
    known = {constant for name in names for constant in laws.find(name).constants()}
    return compare(log, names, lambda log, name: ask.of_law(name, known, names).fit(log, name))


def is_simulated(names: Sequence[str], method: str | None) -> bool:
    """Whether a fit of these laws simulates them."""
    return method in ("presliding", "dynamic") or (method is None and any(laws.find(name).has_z for name in names))


def read_log(
    data: Data,
    columns: Mapping[str, str],
    units: Mapping[str, str] | None = None,
    force_gain: float | str | None = None,
    cutoff: float | None = None,
    trim: int | None = None,
    sharp: bool = False,
) -> Log:
    """The log in files, ready to be fitted; a log as it is.

    Args:
        data: a file (CSV, Parquet, MAT, NPZ), a data frame or a mapping of names to arrays, or several of one layout.
        columns: the file's column for each role: ``{"time": "t", "velocity": "v", "force": "F"}``, and position,
            acceleration, ...; a TOML file of the data's name beside it may hold them.
        units: the unit of a column by its name; SI unless given.
        force_gain: force per unit of the force column: a number, or the name of a constant in the file.
        cutoff: of the low-pass filter, Hz; chosen from the data unless given.
        trim: rows left out at both ends, where the filter rings; chosen unless given.
        sharp: keep break-away as sharp as it was measured (for laws with bristles).

    Returns:
        A :class:`stribeck.identify.log.Log` in SI units, for :func:`stribeck.fit`.

    Raises:
        InputError: the file cannot be read, a column is missing or has no unit; one line for each problem.
    """
    if unknown := [n for n in columns if n not in ROLES]:
        raise InputError([f"{n}: {show(columns[n])}: unknown argument{nearest(n, ROLES)}" for n in unknown])
    if isinstance(data, Log):
        asked = {**columns, "units": units, "force_gain": force_gain, "cutoff": cutoff, "trim": trim}
        if given := [name for name, value in asked.items() if value is not None]:
            raise InputError(
                [f"{arg(n)}: {show(asked[n])}: is for columns of a file; a Log is taken as it is" for n in given]
            )
        return data
    sources = [data] if isinstance(data, str | Path) or is_table(data) else list(data)
    return load(sources, Columns(dict(columns), dict(units or {}), force_gain), Preparation(cutoff, trim, sharp))


def compare(log: Log, names: Sequence[str], each: Callable[[Log, str], Fit]) -> Fit | Choice:
    """Fit each law and pick one; the fit that Ctrl-C stopped."""
    if len(set(names)) < len(names):
        raise InputError(
            f"{arg('law')}: {max(names, key=list(names).count)!r}: given twice; must differ from the others"
        )
    fits: dict[str, Fit] = {}
    failed: dict[str, str] = {}
    for name in names:
        laws.find(name)
        try:
            fits[name] = each(log, name)
            if fits[name].status == "stopped":
                return fits[name]
        except StribeckError as error:
            failed[name] = str(error).splitlines()[0]
    return choose(fits, failed)


class _Request:
    """What is asked of every law."""

    def __init__(
        self, mass: float | None, method: str | None, constants: dict[str, Any], free: Sequence[str],
        terms: Sequence[str], select: bool | None, decimate: int | None, robust: bool, folds: int, starts: int, seed: int,
        output: str, drive: Mapping[str, Any] | None,
    ) -> None:  # fmt: skip
        if method is not None and method not in METHODS:
            raise InputError(f"{arg('method')}: {method!r}: must be {', '.join(METHODS)}{nearest(method, METHODS)}")
        self.mass, self.method, self.constants, self.free = mass, method, constants, tuple(free)
        self.terms, self.select, self.decimate, self.robust = tuple(terms), select, decimate, robust
        self.folds, self.starts, self.seed = folds, starts, seed
        self.output, self.drive = output, drive
        self.work = Work()
        self.cross = 0  # folds of a simulation-error fit: costly, and wanted for comparison only

    def of_law(self, law: str, known: Collection[str], among: Sequence[str]) -> _Request:
        """The request without the constants that only other laws have."""
        foreign = set(known) - set(laws.find(law).constants())
        other = copy.copy(self)
        other.work = self.work.part(among.index(law), len(among))
        other.constants = {n: v for n, v in self.constants.items() if n not in foreign}
        other.free = tuple(n for n in self.free if n not in foreign)
        return other

    def fit(self, log: Log, law: str) -> Fit:
        """The fit of one law."""
        found = laws.find(law)
        problems = [
            f"{arg(argument)}: {name}: law '{law}' has no such constant{nearest(name, found.constants())}"
            for argument, names in (("constants", self.constants), ("free", self.free))
            for name in names
            if name not in found.constants() and not (argument == "constants" and name in TERMS)
        ]
        problems += [
            f"{arg(f'constants.{name}')}: {show(value)}: {text}"
            for name, value in self.constants.items()
            if name in found.constants() and (text := found.constants()[name].problem(value))
        ]
        problems += [
            f"{arg(f'constants.{name}')}: {show(value)}: must be a finite number"
            for name, value in self.constants.items()
            if name in TERMS and (isinstance(value, str) or not np.isfinite(value))
        ]
        problems += [
            f"{arg('free')}: {name}: is a word, not a number; must be given with {arg('constants')}"
            for name in self.free
            if name in found.constants() and found.constants()[name].choices
        ]
        if self.mass is not None and not (np.isfinite(self.mass) and self.mass >= 0):
            problems.append(f"{arg('mass')}: {show(self.mass)}: must be a finite number >= 0")
        if problems:
            raise InputError(problems)
        method = self.method or ("dynamic" if found.has_z else "static")
        if method != "static" and (wrong := self._only_static()):
            raise InputError([f"{arg(name)}: belongs to {arg('method')} static, not {method}" for name in wrong])
        if method != "dynamic" and (self.output != "force" or self.drive):
            raise InputError(f"{arg('output')}, {arg('drive')}: belong to {arg('method')} dynamic, not {method}")
        if self.drive and self.output == "force":
            raise InputError(f"{arg('drive')}: needs {arg('output')} velocity or position")
        check_motion(log)
        return _with_warning(METHODS[method](self, log, law))

    def _only_static(self) -> list[str]:
        given = {"select": bool(self.select), "decimate": self.decimate, "robust": self.robust}
        return [name for name, value in given.items() if value]

    def free_of(self, law: str) -> list[str] | None:
        """The machine's constants and what is freed beside them; None for the machine's alone."""
        found = laws.find(law)
        usual = list(found.uses or found.own_constants())
        return list(dict.fromkeys([*usual, *self.free])) if self.free else None

    def _setting(self, free: Sequence[str] | None) -> Setting:
        body = tuple(dict.fromkeys(("offset", *self.terms)))
        return Setting(self.constants, free, self.mass, body, self.decimate, self.robust, folds=self.folds)

    def static(self, log: Log, law: str) -> Fit:
        """By least squares on the force, without memory."""
        setting, plain = self._setting(self.free_of(law)), law == PLAIN or self.cross
        select = self.select if self.select is not None else not (self.terms or self.free or plain)
        with threadpool_limits(1):  # more threads of linear algebra only spin on matrices so small
            return select_terms(log, law, setting) if select else fit_with_baselines(log, law, setting)

    def any_law(self, log: Log) -> Choice:
        """The static law and the terms that predict data left out best."""
        if self.method not in (None, "static") or self.free:
            option = "free" if self.free else "method"
            raise InputError(f"{arg(option)}: needs {arg('law')}: without one, static laws are compared")
        if self.mass is not None and not (np.isfinite(self.mass) and self.mass >= 0):
            raise InputError(f"{arg('mass')}: {show(self.mass)}: must be a finite number >= 0")
        with threadpool_limits(1):
            choice = select_law(log, self._setting(None))
        return replace(choice, fits={name: _with_warning(each) for name, each in choice.fits.items()})

    def presliding(self, log: Log, law: str) -> Fit:
        """From small reversals."""
        return fit_presliding(
            log, law, fixed=self.constants, mass=self.mass or 0.0, starts=min(self.starts, 8), seed=self.seed,
            work=self.work,
        )  # fmt: skip

    def dynamic(self, log: Log, law: str) -> Fit:
        """By simulation of the law along the measured motion, or of the motion under the measured force or command."""
        if self.output != "force":
            offset = ("offset",) if (self.drive or {"kind": "force"}).get("kind") == "force" else ()
            return fit_motion(
                log, law, self.drive, output=self.output, fixed=self.constants, free=self.free_of(law), mass=self.mass,
                body=tuple(dict.fromkeys((*offset, *self.terms))), starts=self.starts, seed=self.seed,
                work=self.work,
            )  # fmt: skip
        return fit_dynamic(
            log, law, fixed=self.constants, free=self.free_of(law), mass=self.mass,
            body=tuple(dict.fromkeys(("offset", *self.terms))), starts=self.starts, seed=self.seed, folds=self.cross,
            work=self.work,
        )  # fmt: skip


def _with_warning(fit: Fit) -> Fit:
    """The fit, with a note where the law explains little of the force."""
    share = fit.relative_force_error
    if not share > _POOR or "output" in fit.details:  # a fit of the motion is judged by the motion
        return fit
    text = (
        f"the fit misses {share:.0%} of the force: the law or the terms lack something that the data hold (the residuals "
        "show what), and its numbers, intervals too, say little about the machine"
    )
    return replace(fit, notes=(text, *fit.notes))


METHODS: dict[str, Callable[[Any, Log, str], Fit]] = {
    "static": _Request.static, "presliding": _Request.presliding, "dynamic": _Request.dynamic,
}  # fmt: skip
