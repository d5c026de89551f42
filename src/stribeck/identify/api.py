"""``stribeck.fit``: a log in, parameters out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from stribeck import laws
from stribeck.constants import show
from stribeck.errors import InputError, StribeckError, arg, first_line, nearest
from stribeck.identify.data.prepare import Preparation, load_log
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.data.units import ROLES
from stribeck.identify.log import Log
from stribeck.identify.methods.dynamic import fit_dynamic
from stribeck.identify.methods.motion import fit_motion
from stribeck.identify.methods.optimise import STOPPED
from stribeck.identify.methods.presliding import fit_presliding
from stribeck.identify.methods.static import Setting, check_motion
from stribeck.identify.options import FitOptions
from stribeck.identify.result import Fit
from stribeck.identify.statistics.choose import Choice, choose, fit_with_baselines, select_law, select_terms
from stribeck.identify.statistics.crossvalidate import FOLDS
from stribeck.identify.work import Work
from stribeck.recorded import is_table

_POOR = 0.25  # of the force, left by the fit
PLAIN = "coulomb_viscous"  # least squares itself: nothing is added to it unasked

Data = Any  # a path, a Log, a data frame or mapping of columns, or a sequence of paths or frames


def fit(
    data: Data, law: str | Sequence[str] | None = None, *,
    columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None,
    force_gain: float | str | None = None, mass: float | None = None, method: str | None = None,
    constants: Mapping[str, float | str] | None = None, free: Sequence[str] = (), terms: Sequence[str] = (),
    select: bool | None = None, cutoff: float | None = None, trim: int | None = None, decimate: int | None = None,
    robust: bool = False, folds: int = FOLDS, starts: int = 20, seed: int = 0,
    output: str = "force", drive: Mapping[str, object] | None = None,
    progress: Callable[[float], None] | None = None, **named: str,
) -> Fit | Choice:  # fmt: skip
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
    options = FitOptions(
        mass, method, dict(constants or {}), tuple(free), tuple(terms), select, decimate, robust, folds, starts, seed,
        output, drive,
    )  # fmt: skip
    of_file = ColumnNames({**(columns or {}), **named}, dict(units or {}), force_gain)
    log = log_of(data, of_file, preparation(names, options, cutoff, trim))
    return fit_log(log, names, options, progress)


def fit_log(
    log: Log, names: Sequence[str], options: FitOptions, progress: Callable[[float], None] | None = None
) -> Fit | Choice:
    """Fit one law to a log; or several, or for no name the static ones, and pick one; as :func:`fit` says."""
    work = Work(progress)
    if options.output != "force" and len(names) != 1:
        raise InputError(f"{arg('output')}: laws are compared by the force they predict; must be given with one law")
    if not names:
        return _any_law(log, options)
    if len(names) == 1:
        return _fit_law(log, names[0], options, work)
    if options.method is None and any(laws.find(name).has_z for name in names):
        options = replace(options, method="dynamic")  # errors compare within one method only
    known = {constant for name in names for constant in laws.find(name).constants()}

    def each(log: Log, name: str) -> Fit:
        part = work.part(names.index(name), len(names))
        return _fit_law(log, name, options.of_law(name, known), part, compared=True)

    return compare(log, names, each)


def is_simulated(names: Sequence[str], method: str | None) -> bool:
    """Whether a fit of these laws simulates them."""
    return method in ("presliding", "dynamic") or (method is None and any(laws.find(name).has_z for name in names))


def preparation(names: Sequence[str], options: FitOptions, cutoff: float | None, trim: int | None) -> Preparation:
    """How a fit of these laws reads its record."""
    return Preparation(cutoff, trim, is_simulated(names, options.method), list(names) == [PLAIN] and not options.select)


def read_log(
    data: Data,
    columns: Mapping[str, str],
    units: Mapping[str, str] | None = None,
    force_gain: float | str | None = None,
    cutoff: float | None = None,
    trim: int | None = None,
    simulated: bool = False,
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
        simulated: for laws with bristles, which are simulated: the filter rounds break-away less.

    Returns:
        A :class:`stribeck.identify.log.Log` in SI units, for :func:`stribeck.fit`.

    Raises:
        InputError: the file cannot be read, a column is missing or has no unit; one line for each problem.
    """
    named = ColumnNames(dict(columns), dict(units or {}), force_gain)
    return log_of(data, named, Preparation(cutoff, trim, simulated))


def log_of(data: Data, columns: ColumnNames, how: Preparation | None = None) -> Log:
    """The log in files, ready to be fitted; a log as it is."""
    names, how = columns.names, how or Preparation()
    if unknown := [n for n in names if n not in ROLES]:
        raise InputError([f"{n}: {show(names[n])}: unknown argument{nearest(n, ROLES)}" for n in unknown])
    if isinstance(data, Log):
        asked = {
            **names, "units": columns.units or None, "force_gain": columns.force_gain, "cutoff": how.cutoff,
            "trim": how.trim,
        }  # fmt: skip
        if given := [name for name, value in asked.items() if value is not None]:
            raise InputError(
                [f"{arg(n)}: {show(asked[n])}: is for columns of a file; a Log is taken as it is" for n in given]
            )
        return data
    sources = [data] if isinstance(data, str | Path) or is_table(data) else list(data)
    return load_log(sources, columns, how)


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
            failed[name] = first_line(error)
        except KeyboardInterrupt:  # before anything of this law was found
            if not fits:
                raise
            best = min(fits.values(), key=lambda fit: fit.cross_validated_error or fit.relative_force_error)
            return replace(best, status="stopped", notes=(f"{STOPPED}, of {', '.join(fits)}", *best.notes))
    return choose(fits, failed)


def _fit_law(log: Log, law: str, options: FitOptions, work: Work, compared: bool = False) -> Fit:
    """The fit of one law; ``compared``: beside others, by the error over data left out."""
    options.check(law)
    check_motion(log)
    method = options.method_for(laws.find(law))
    if method == "static":
        found = _static(log, law, options, compared)
    elif method == "presliding":
        found = fit_presliding(
            log, law, fixed=_numbers(options), mass=options.mass or 0.0, starts=min(options.starts, 8),
            seed=options.seed, work=work,
        )  # fmt: skip
    else:
        found = _dynamic(log, law, options, work, compared)
    return _with_warning(found)


def _numbers(options: FitOptions) -> dict[str, Any]:
    return dict(options.constants)


def _setting(options: FitOptions, free: Sequence[str] | None) -> Setting:
    return Setting(
        _numbers(options), free, options.mass, options.body("offset"), options.decimate, options.robust,
        folds=options.folds,
    )  # fmt: skip


def _static(log: Log, law: str, options: FitOptions, compared: bool) -> Fit:
    """By least squares on the force, without memory."""
    setting, plain = _setting(options, options.free_of(law)), law == PLAIN or compared
    select = options.select if options.select is not None else not (options.terms or options.free or plain)
    with threadpool_limits(1):  # more threads of linear algebra only spin on matrices so small
        return select_terms(log, law, setting) if select else fit_with_baselines(log, law, setting)


def _any_law(log: Log, options: FitOptions) -> Fit | Choice:
    """The static law and the terms that predict data left out best."""
    options.check_without_law()
    with threadpool_limits(1):
        choice = select_law(log, _setting(options, None))
    if isinstance(choice, Fit):  # stopped
        return _with_warning(choice)
    return replace(choice, fits={name: _with_warning(each) for name, each in choice.fits.items()})


def _dynamic(log: Log, law: str, options: FitOptions, work: Work, compared: bool) -> Fit:
    """By simulation of the law along the measured motion, or of the motion under the measured force or command."""
    free = options.free_of(law)
    if options.output != "force":
        offset = ("offset",) if (options.drive or {"kind": "force"}).get("kind") == "force" else ()
        return fit_motion(
            log, law, options.drive, output=options.output, fixed=_numbers(options), free=free, mass=options.mass,
            body=options.body(*offset), starts=options.starts, seed=options.seed, work=work,
        )  # fmt: skip
    folds = options.folds if compared else 0  # costly, and wanted for comparison only
    return fit_dynamic(
        log, law, fixed=_numbers(options), free=free, mass=options.mass, body=options.body("offset"),
        starts=options.starts, seed=options.seed, folds=folds, work=work,
    )  # fmt: skip


def _with_warning(fit: Fit) -> Fit:
    """The fit, with a note where the law explains little of the force."""
    known = any(e.identifiable for e in {**fit.estimates, **fit.body}.values())
    share = fit.relative_force_error
    if not share > _POOR or "output" in fit.details:  # a fit of the motion is judged by the motion
        return fit
    bristles = "; what friction does behind reversals takes a law with bristles, such as lugre"
    text = (
        f"the fit misses {share:.0%} of the force: the law or the terms lack something that the data hold (the residuals "
        f"show what{bristles if fit.method == 'static' else ''})"
        f"{', and its numbers, intervals too, say little about the machine' if known else ''}"
    )
    return replace(fit, notes=(text, *fit.notes))
