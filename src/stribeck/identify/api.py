"""``stribeck.fit``: a log in, parameters out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path

from stribeck import laws
from stribeck.constants import kind_of, show
from stribeck.errors import InputError, arg
from stribeck.identify.actuator.api import fit_machine
from stribeck.identify.actuator.recordings import Logs
from stribeck.identify.data.prepare import Preparation
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.data.reading import Data, RecordReading, files_of, read_log
from stribeck.identify.log import Log
from stribeck.identify.methods.bristles import LAW, STARTS, asked_for, beside_friction, better
from stribeck.identify.methods.static import check_motion, fit_static
from stribeck.identify.models.curves import LAWS
from stribeck.identify.options import FitOptions
from stribeck.identify.required import with_requirements
from stribeck.identify.result import Fit, LogFit
from stribeck.identify.work import Progress, part

_READ = 0.05  # of the work: reading takes about a tenth of a static fit, and nothing beside a simulation
Law = str | Sequence[str] | Mapping[str, Sequence[str]] | None


def fit(
    data: Data, law: Law = None, *, logs: Logs | str | Path | None = None,
    columns: Mapping[str, str] | None = None, unit: Mapping[str, str] | None = None,
    force_gain: float | str | None = None, mass: float | None = None, method: str | None = None,
    set: Mapping[str, float | str] | None = None, free: Sequence[str] = (), term: Sequence[str] = (),
    forms: bool = True, filter: str | None = None, speed: Sequence[float] = (),
    cutoff: float | None = None, starts: int = 20, seed: int = 0, output: str = "force",
    unknown: Mapping[str, object] | None = None, require: Mapping[str, float] | None = None,
    progress: Progress | None = None, **named: str,
) -> Fit:  # fmt: skip
    """Fit a friction law to a measured log, or a machine to recordings of it.

    Args:
        data: a file (CSV, Parquet, MAT, NPZ), a pandas data frame, a mapping of names to arrays, several of these of
            one layout (runs), or a :class:`stribeck.identify.log.Log`; with ``logs`` a machine (its file, its tables).
        law: name or FILE.py:NAME, or several, of which the one that describes the log best is taken; None compares the
            static laws, and LuGre if the record shows presliding. With ``logs`` the laws to try, by contact.
        logs: the recordings of a machine: LOGS.toml, which says what is measured and sought (docs/reference/fit-files.md).
        columns: the file's column for each role: time, position, velocity, force, ...; also as keywords
            (``time="t"``). A TOML file of the data's name beside it may hold them.
        unit: unit of a column by its name; SI unless given. A position in an angle makes the axis rotary.
        force_gain: force per unit of the force column; a number, or the name of a constant in the file.
        mass: mass, kg (rotary: kg m^2); fitted unless given.
        method: "static" (coulomb_viscous, stribeck, stribeck_tanh) or "dynamic" (by simulation, any law); static unless
            given where the law can be.
        set: given constants of the law (``k_v`` or any other), and given terms. With a given F_c or F_s the fit is by
            simulation.
        free: constants with a default that are fitted too (``k_v``).
        term: further terms of the force, beside friction, mass and offset (docs/reference/fit-files.md).
        forms: whether a static fit may add forms for effects that the law lacks.
        filter: "published" selects the published inverse-dynamics procedure with the law alone (static).
        speed: speeds at which the friction is estimated too, m/s (static).
        cutoff: cut-off frequency of the motion's filter, Hz; chosen from the data unless given; 0 for no filter.
        starts, seed: number of starts of a fit by simulation, and their seed.
        output: signal that the simulation must match: "force" along the measured motion, or "velocity" or "position" under
            the measured force (dynamic; one law). A controller in the loop is a machine (``logs``).
        unknown: what is known of fitted numbers, by name: (low, high), or a table of low, high, start and prior as in
            LOGS.toml (dynamic). With ``logs`` further unknowns, by path.
        require: half widths that numbers must be known within, as shares of them (``{"F_c": 0.05}``): a number is identified
            if its model range is as narrow; the first notes say what is missing, and what to measure.
        progress: called with the share of the work done, 0 to 1, in any thread. Ctrl-C ends a fit by simulation; the best
            values so far are returned, with status "stopped".
        **named: columns by role.

    Returns:
        The fit: a LogFit, or with ``logs`` a MachineFit.

    Raises:
        InputError: if data, columns, units or constants cannot be used; one line for each problem.
    """
    options = FitOptions(
        mass, method, dict(set or {}), tuple(free), tuple(term), starts, seed, output, forms, filter,
        tuple(speed), dict(unknown or {}), dict(require or {}),
    )  # fmt: skip
    of_file = ColumnNames({**(columns or {}), **named}, dict(unit or {}), force_gain)
    if logs is None:
        return _fit_read(data, law, of_file, options, cutoff, progress)
    _refuse_of_a_log(options, of_file, cutoff)
    if not (law is None or isinstance(law, Mapping)):
        raise InputError(f"{arg('law')}: {show(law)}: must be laws by contact with {arg('logs')}")
    of_machine = fit_machine(
        data, logs, laws=law or {}, unknown=options.unknown, starts=starts, seed=seed, progress=progress
    )
    return with_requirements(of_machine, options.require)


def _fit_read(
    data: Data, law: Law, named: ColumnNames, options: FitOptions, cutoff: float | None, progress: Progress | None
) -> LogFit:
    """Read a log and fit it, with the share of both."""
    if isinstance(law, Mapping):
        raise InputError(f"{arg('law')}: {show(law)}: laws by contact need {arg('logs')}")
    if law is not None and (not isinstance(law, Iterable) or isinstance(law, bytes)):
        raise InputError(f"{arg('law')}: {show(law)}: must be a law's name or several, not {kind_of(law)}")
    names = [] if law is None else [law] if isinstance(law, str) else list(law)
    how = preparation(names, options, cutoff)
    log = read_log(data, named, how)
    rest = None
    if progress is not None:
        progress(_READ)
        rest = lambda share: progress(_READ + (1 - _READ) * share)  # noqa: E731
    reading = RecordReading(files_of(data), named, how)
    return with_requirements(replace(fit_log(log, names, options, rest), reading=reading), options.require)


def _refuse_of_a_log(options: FitOptions, columns: ColumnNames, cutoff: float | None) -> None:
    """Refuse what says something of a log: of recordings LOGS.toml says it.

    Raises:
        InputError: a line for each.
    """
    usual = FitOptions()
    given = [f.name for f in fields(FitOptions) if getattr(options, f.name) != getattr(usual, f.name)]
    wrong = [n for n in given if n not in ("starts", "seed", "unknown", "require")]
    wrong += [*columns.names, *(["unit"] if columns.units else [])]
    wrong += [n for n, x in (("force_gain", columns.force_gain), ("cutoff", cutoff)) if x is not None]
    if wrong:
        text = f"is for a log: with {arg('logs')}, LOGS.toml says what is measured and sought"
        raise InputError([f"{arg(n)}: {text}" for n in wrong])


def fit_log(log: Log, names: Sequence[str], options: FitOptions, progress: Progress | None = None) -> LogFit:
    """Fit one law to a log; or several, or for no name the static ones, and report the best; as :func:`fit` says."""
    if options.output != "force" and len(names) != 1:
        raise InputError(f"{arg('output')}: laws are compared by the force they predict; must be given with one law")
    if len(set(names)) < len(names):
        twice = max(names, key=list(names).count)
        raise InputError(f"{arg('law')}: {twice!r}: given twice; must differ from the others")
    compared = names or LAWS
    options.check(compared)
    check_motion(log)
    static = [n for n in compared if options.method_for(laws.find(n)) == "static"]
    simulated = [n for n in compared if n not in static]
    parts = 2 if static and (simulated or not names) else 1
    best = fit_static(log, static, options, part(progress, 0, parts)) if static else None
    if best is not None and not names and options.method is None and asked_for(log, best):
        simulated, options = [LAW], replace(options, starts=STARTS, term=beside_friction(best, options))
    if best is not None and not simulated:
        return best
    return better(log, best, simulated, options, part(progress, parts - 1, parts))


def preparation(names: Sequence[str], options: FitOptions, cutoff: float | None) -> Preparation:
    """The preparation of a log for a fit of these laws."""
    simulated = any(options.method_for(laws.find(name)) == "dynamic" for name in names)
    return Preparation(cutoff, simulated, options.published)
