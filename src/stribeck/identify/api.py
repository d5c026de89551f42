"""``stribeck.fit``: a log in, parameters out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from stribeck import laws
from stribeck.constants import show
from stribeck.errors import InputError, arg, nearest
from stribeck.identify.actuator.api import fit_machine
from stribeck.identify.actuator.recordings import Logs
from stribeck.identify.actuator.result import MachineFit
from stribeck.identify.data.prepare import Preparation, load_log
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.data.units import ROLES, with_counts
from stribeck.identify.log import Log
from stribeck.identify.methods.bristles import LAW, STARTS, asked_for, better
from stribeck.identify.methods.static import LAWS, Setting, check_motion, fit_static
from stribeck.identify.options import FitOptions
from stribeck.identify.required import with_requirements
from stribeck.identify.result import Fit, LogFit, RecordReading
from stribeck.recorded import is_table

_READ = 0.05  # of the work
Data = Any  # a path, a Log, a data frame or mapping of columns, or a sequence of paths or frames
Law = str | Sequence[str] | Mapping[str, Sequence[str]] | None


def fit(
    data: Data, law: Law = None, *, logs: Logs | str | Path | None = None, transfer: Logs | str | Path | None = None,
    columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None,
    counts: float | None = None, force_gain: float | str | None = None, mass: float | None = None, method: str | None = None,
    constants: Mapping[str, float | str] | None = None, free: Sequence[str] = (), terms: Sequence[str] = (),
    forms: bool = True, filter: str | None = None, weight: bool = True, speeds: Sequence[float] = (),
    cutoff: float | None = None, starts: int = 20, seed: int = 0, output: str = "force",
    unknown: Mapping[str, object] | None = None, require: Mapping[str, float] | None = None,
    folder: str | Path | None = None,
    progress: Callable[[float], None] | None = None, **named: str,
) -> Fit:  # fmt: skip
    """Fit a friction law to a measured log, or a machine to recordings of it.

    Args:
        data: a file (CSV, Parquet, MAT, NPZ), a pandas data frame, a mapping of names to arrays, several of these of
            one layout (runs), or a :class:`stribeck.identify.log.Log`; with ``logs`` a machine (its file, its tables).
        law: name or FILE.py:NAME, or several, of which the one that describes the log best is taken; None compares the
            static laws, and LuGre if the record shows presliding. With ``logs`` the laws to try, by contact.
        logs: the recordings of a machine: LOGS.toml, which says what is measured and sought (docs/reference/fit-files.md).
        transfer: recordings of another unit or day; numbers that moved are listed (with ``logs``).
        columns: the file's column for each role: time, position, velocity, force, ...; also as keywords
            (``time="t"``). A TOML file of the data's name beside it may hold them.
        units: unit of a column by its name; SI unless given. A position in an angle makes the axis rotary.
        counts: an encoder's counts a turn, for columns whose unit is counts.
        force_gain: force per unit of the force column; a number, or the name of a constant in the file.
        mass: mass, kg (rotary: kg m^2); fitted unless given.
        method: "static" or "dynamic" (by simulation); static for laws without bristles, dynamic for others unless given.
        constants: given constants of the law (``k_v`` or any other), and given terms.
        free: constants with a default that are fitted too (``k_v``).
        terms: further terms of the force, beside friction, mass and offset (docs/reference/fit-files.md).
        forms: whether a static fit may add forms for effects that the law lacks.
        filter: "published" selects the published inverse-dynamics procedure with the law alone (static).
        weight: whether the model has a rotary joint's weight (static).
        speeds: speeds at which the friction is estimated too, m/s (static).
        cutoff: cut-off frequency of the motion's filter, Hz; chosen from the data unless given; 0 for no filter.
        starts, seed: number of starts of a fit by simulation, and their seed.
        output: signal that the simulation must match: "force" along the measured motion, or "velocity" or "position" under
            the measured force (dynamic; one law). A controller in the loop is a machine (``logs``).
        unknown: what is known of fitted numbers, by name: (low, high), or a table of low, high, start and prior as in
            LOGS.toml. A static fit takes low and high of what bends the law's curve (v_s, k_v): the rest has one optimum.
            With ``logs`` further unknowns, by path.
        require: half widths that numbers must be known within, as shares of them (``{"F_c": 0.05}``): a number is identified
            if its model range is as narrow; the first notes say what is missing, and what to measure.
        folder: where a fit of a machine keeps how far it has come, so that one that was stopped goes on.
        progress: called with the share of the work done, 0 to 1, in any thread. Ctrl-C ends a fit by simulation; the best
            values so far are returned, with status "stopped".
        **named: columns by role.

    Returns:
        The fit: a LogFit, or with ``logs`` a MachineFit.

    Raises:
        InputError: if data, columns, units or constants cannot be used; one line for each problem.
    """
    options = FitOptions(
        mass, method, dict(constants or {}), tuple(free), tuple(terms), starts, seed, output, forms, filter, weight,
        tuple(speeds), dict(unknown or {}), dict(require or {}),
    )  # fmt: skip
    of_file = ColumnNames({**(columns or {}), **named}, with_counts(units or {}, counts), force_gain)
    if logs is None:
        if transfer is not None:
            raise InputError(f"{arg('transfer')}: {show(str(transfer))}: needs {arg('logs')}")
        return _fit_read(data, law, of_file, options, cutoff, progress)
    _refuse_of_a_log(options, of_file, cutoff)
    return _fit_recorded(data, logs, law, transfer, options, folder, progress)


def _fit_recorded(
    data: Data, logs: Logs | str | Path, law: Law, transfer: Logs | str | Path | None, options: FitOptions,
    folder: str | Path | None, progress: Callable[[float], None] | None,
) -> MachineFit:  # fmt: skip
    """Fit a machine to its recordings."""
    found = fit_machine(
        data, logs, laws=_by_contact(law), unknown=options.unknown, transfer_to=transfer, starts=options.starts,
        seed=options.seed, progress=progress, folder=None if folder is None else Path(folder),
    )  # fmt: skip
    return with_requirements(found, options.require)


def _fit_read(
    data: Data, law: Law, of_file: ColumnNames, options: FitOptions, cutoff: float | None,
    progress: Callable[[float], None] | None,
) -> LogFit:  # fmt: skip
    """Read a log and fit it, with the share of both."""
    if isinstance(law, Mapping):
        raise InputError(f"{arg('law')}: {show(law)}: laws by contact need {arg('logs')}")
    names = [] if law is None else [law] if isinstance(law, str) else list(law)
    how = preparation(names, options, cutoff)
    log = log_of(data, of_file, how)
    rest = None
    if progress is not None:
        progress(_READ)
        rest = lambda share: progress(_READ + (1 - _READ) * share)  # noqa: E731
    of_log = replace(fit_log(log, names, options, rest), reading=reading(data, of_file, how, options))
    return with_requirements(of_log, options.require)


def _refuse_of_a_log(options: FitOptions, columns: ColumnNames, cutoff: float | None) -> None:
    """Refuse what says something of a log: of recordings LOGS.toml says it.

    Raises:
        InputError: a line for each.
    """
    usual = FitOptions()
    given = [f.name for f in fields(FitOptions) if getattr(options, f.name) != getattr(usual, f.name)]
    wrong = [n for n in given if n not in ("starts", "seed", "unknown", "require")]
    wrong += [*columns.names, *(["units"] if columns.units else [])]
    wrong += [n for n, x in (("force_gain", columns.force_gain), ("cutoff", cutoff)) if x is not None]
    if wrong:
        text = f"is for a log: with {arg('logs')}, LOGS.toml says what is measured and sought"
        raise InputError([f"{arg(n)}: {text}" for n in wrong])


def _by_contact(law: Law) -> dict[str, Sequence[str]]:
    """The laws to try by contact.

    Raises:
        InputError: they are not given by contact.
    """
    if law is None or isinstance(law, Mapping):
        return dict(law or {})
    raise InputError(f"{arg('law')}: {show(law)}: must be laws by contact with {arg('logs')}")


def reading(data: Data, columns: ColumnNames, how: Preparation, options: FitOptions) -> RecordReading:
    """How a record was read, as fit.json has it."""
    return RecordReading(
        files_of(data),
        columns.names,
        columns.units,
        columns.force_gain,
        how.cutoff,
        options.output,
        how.published,
        how.simulated,
    )


def files_of(data: Data) -> tuple[str, ...]:
    """The files of a record that is from files."""
    sources = data if isinstance(data, list | tuple) else [data]
    return tuple(str(Path(each).resolve()) for each in sources if isinstance(each, str | Path))


def fit_log(
    log: Log, names: Sequence[str], options: FitOptions, progress: Callable[[float], None] | None = None
) -> LogFit:
    """Fit one law to a log; or several, or for no name the static ones, and report the best; as :func:`fit` says."""
    if options.output != "force" and len(names) != 1:
        raise InputError(f"{arg('output')}: laws are compared by the force they predict; must be given with one law")
    if len(set(names)) < len(names):
        twice = max(names, key=list(names).count)
        raise InputError(f"{arg('law')}: {twice!r}: given twice; must differ from the others")
    if not names:
        options.check_without_law()
        found = fit_static(log, LAWS, _setting(options))
        if options.method is not None or not asked_for(log, found):
            return found
        return better(log, found, [LAW], replace(options, starts=STARTS), progress)
    known = {constant for name in names for constant in laws.find(name).constants()}
    for name in names:
        options.of_law(name, known).check(name)
    static = [n for n in names if options.method_for(laws.find(n)) == "static"]
    simulated = [n for n in names if n not in static]
    best = fit_static(log, static, _setting(options)) if static else None
    if not simulated:
        assert best is not None
        return best
    check_motion(log)
    return better(log, best, simulated, options, progress)


def is_simulated(names: Sequence[str], method: str | None) -> bool:
    """Whether a fit of these laws simulates them."""
    return method == "dynamic" or (method is None and any(laws.find(name).has_z for name in names))


def preparation(names: Sequence[str], options: FitOptions, cutoff: float | None) -> Preparation:
    """How a fit of these laws reads its record."""
    return Preparation(cutoff, None, is_simulated(names, options.method), options.filter == "published")


def read_log(
    data: Data,
    columns: Mapping[str, str],
    units: Mapping[str, str] | None = None,
    counts: float | None = None,
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
        counts: an encoder's counts a turn, for columns whose unit is counts.
        force_gain: force per unit of the force column: a number, or the name of a constant in the file.
        cutoff: of the low-pass filter, Hz; chosen from the data unless given.
        trim: rows left out at both ends, where the filter rings; chosen unless given.
        simulated: for laws with bristles, which are simulated: the filter rounds break-away less.

    Returns:
        A :class:`stribeck.identify.log.Log` in SI units, for :func:`stribeck.fit`.

    Raises:
        InputError: the file cannot be read, a column is missing or has no unit; one line for each problem.
    """
    named = ColumnNames(dict(columns), with_counts(units or {}, counts), force_gain)
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


def _setting(options: FitOptions) -> Setting:
    fixed = {n: float(x) for n, x in options.constants.items() if not isinstance(x, str)}
    fixed |= {} if options.mass is None else {"mass": options.mass}
    return Setting(
        fixed,
        options.free,
        options.terms,
        not options.forms,
        options.filter == "published",
        options.weight,
        options.speeds,
        {n: (x.low, x.high) for n, x in options.sought.items()},
    )
