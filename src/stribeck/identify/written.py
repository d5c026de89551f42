"""The files of a fit: its numbers (parameters.toml, fit.json, machine.toml), then report.html."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import tomli_w

from stribeck import laws
from stribeck.errors import note
from stribeck.files import seen_from, together, write_text
from stribeck.identify.actuator.result import MachineFit
from stribeck.identify.core.states import Estimate
from stribeck.identify.models.forms import effect, in_words
from stribeck.identify.models.terms import TERMS
from stribeck.identify.result import Fit, LogFit
from stribeck.identify.saved import FILE, MACHINE, text_of
from stribeck.mouth import page
from stribeck.scenario.moved import moved
from stribeck.version import __version__

PARAMETERS, REPORT = "parameters.toml", "report.html"
FILES = (PARAMETERS, FILE, MACHINE, REPORT)
# What an older fit has left and a new one may not write: it would stand beside numbers that are not its own.
_OLDER = {MACHINE: "# Found by: ", REPORT: ""}


def write_fit(fit: Fit, folder: Path, command: str = "", paths: list[str] | None = None) -> list[str]:
    """Write the numbers, all of them together, then the page, whose drawing takes seconds and may be stopped.

    Args:
        command: that made the fit.
        paths: list that gets each path when its file is there.

    Returns:
        The paths.
    """
    paths = [] if paths is None else paths
    with together(folder, last=PARAMETERS, older=_OLDER) as place:
        names = _write_numbers(fit, place, folder, command)
    paths += [str(folder / name) for name in names]
    try:
        with together(folder, last=REPORT) as place:
            page.write(fit.document(), place, command, REPORT, pictures=False)
    except (KeyError, ValueError, IndexError, TypeError, ZeroDivisionError) as error:
        note(f"{REPORT}: could not be drawn ({type(error).__name__}: {error}); the results are written")
        return paths
    paths.append(str(folder / REPORT))
    return paths


def _write_numbers(fit: Fit, place: Path, folder: Path, command: str) -> list[str]:
    """Write the numbers into ``place``, as ``folder`` will hold them; their names."""
    write_text(place / FILE, text_of(fit, folder))
    write_text(place / PARAMETERS, toml(fit, command, folder))
    if not isinstance(fit, MachineFit) or fit.status != "done":
        return [PARAMETERS, FILE]
    write_text(place / MACHINE, f"# Found by: {command}\n{tomli_w.dumps(moved(fit.data, fit.folder, folder))}")
    return [PARAMETERS, FILE, MACHINE]


def toml(fit: Fit, command: str, folder: Path | None = None) -> str:
    """The numbers, each with both uncertainties and its state; those of a log are a parameter set.

    A number that the data do not determine is marked ``determined = false``.
    """
    about: dict[str, object] = {"version": __version__, "command": command, "status": fit.status}
    if isinstance(fit, LogFit):
        about |= _of_log(fit, command)
        tables = _tables_of_log(fit)
    else:
        assert isinstance(fit, MachineFit)
        tables = {"parameters": {n: _row(e) for n, e in fit.estimates.items()}}
        about |= {"reason": fit.reason} if fit.reason else {}
        about |= {} if fit.source is None or folder is None else {"logs": seen_from(folder, fit.source)}
    levels = {n: {"speed": fit.speeds[n], **_row(e)} for n, e in fit.levels.items()}
    text = tomli_w.dumps({**about, **tables, "levels": levels})
    return f"# SI units; intervals (low, high) and ranges at 95 %.\n{text}"


def _of_log(fit: LogFit, command: str) -> dict[str, object]:
    """The fitted model."""
    data = ", ".join(Path(name).name for name in fit.reading.files) or fit.title
    about = {
        "title": f"{fit.law_name} fitted to {data}", "source": f"stribeck {__version__}: {command}",
        "motion": "rotary" if fit.log is not None and fit.log.rotary else None, "law": fit.law_name, "method": fit.method,
        "data": data, "data_sha256": fit.data_hash, "relative_force_error": fit.relative_force_error,
        "cross_validated_error": fit.cross_validated_error, "left_out": _left_out(fit) or None,
    }  # fmt: skip
    return {key: x for key, x in about.items() if x is not None}


def _left_out(fit: LogFit) -> list[str]:
    """The friction that the fit found and the law has no constant for, each effect once."""
    terms = [name for name, e in fit.body.items() if e.usable and (TERMS[name].level or TERMS[name].friction)]
    return list(dict.fromkeys([*terms, *(in_words(form) for form in fit.forms or () if effect(form)[0].level)]))


def _tables_of_log(fit: LogFit) -> dict[str, object]:
    """The law's parameters as its curve has them, given ones too, and what belongs to the rig."""
    known = laws.find(fit.law_name).constants()
    fitted = {n: _row(e, fit.values.get(n)) for n, e in fit.of_law.items()}
    given = {n: fit.values[n] for n in fit.given if n in known}
    return {"parameters": {**given, **fitted}, "body": {n: _row(e) for n, e in fit.body.items()}}


def _row(e: Estimate, used: float | str | None = None) -> Mapping[str, object]:
    """An estimate without what is open or empty; ``used``: its value in a curve, which may differ."""
    row = e.to_dict() | {"range": e.range and list(e.range), "determined": None if e.usable else False}
    row |= {} if used is None else {"value": used}
    return {key: x for key, x in row.items() if x is not None and x != ""}
