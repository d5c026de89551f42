"""The files of a fit: its numbers (parameters.toml, fit.json, machine.toml), then report.html."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import tomli_w

from stribeck import laws
from stribeck.errors import note
from stribeck.files import seen_from, together, write_text
from stribeck.identify.core.states import Estimate
from stribeck.identify.models.forms import effect, in_words
from stribeck.identify.models.terms import TERMS
from stribeck.identify.saved import FILE, MACHINE_FILE, text_of_log, text_of_machine
from stribeck.mouth import page
from stribeck.scenario.moved import moved
from stribeck.version import __version__

if TYPE_CHECKING:
    from stribeck.identify.result import Fit, LogFit, MachineFit

PARAMETERS, REPORT = "parameters.toml", "report.html"
FILES = (PARAMETERS, FILE, MACHINE_FILE, REPORT)
# What an older fit has left and a new one may not write: it would stand beside numbers that are not its own.
_OLDER = {MACHINE_FILE: "# Found by: ", REPORT: ""}


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
        texts = fit.files(folder, command)
        for name, text in texts.items():
            write_text(place / name, text)
    paths += [str(folder / name) for name in texts]
    try:
        with together(folder, last=REPORT) as place:
            page.write(fit.document(), place, command, REPORT, pictures=False)
    except (KeyError, ValueError, IndexError, TypeError, ZeroDivisionError) as error:
        note(f"{REPORT}: could not be drawn ({type(error).__name__}: {error}); the results are written")
        return paths
    paths.append(str(folder / REPORT))
    return paths


def of_log(fit: LogFit, folder: Path, command: str) -> dict[str, str]:
    """The numbers of a log's fit as the text of files: a parameter set, and fit.json."""
    known = laws.find(fit.law_name).constants()
    fitted = {n: _row(e, fit.values.get(n)) for n, e in fit.of_law.items()}
    given = {n: fit.values[n] for n in fit.given if n in known}
    tables = {"parameters": {**given, **fitted}, "body": {n: _row(e) for n, e in fit.body.items()}}
    return {PARAMETERS: _toml(fit, command, _model(fit, command), tables), FILE: text_of_log(fit, folder)}


def of_machine(fit: MachineFit, folder: Path, command: str) -> dict[str, str]:
    """The numbers of a machine's fit as the text of files; with machine.toml if the fit is done."""
    about = {"reason": fit.reason} if fit.reason else {}
    about |= {} if fit.source is None else {"logs": seen_from(folder, fit.source)}
    tables = {"parameters": {n: _row(e) for n, e in fit.estimates.items()}}
    texts = {PARAMETERS: _toml(fit, command, about, tables), FILE: text_of_machine(fit, folder)}
    if fit.status == "done":
        texts[MACHINE_FILE] = f"# Found by: {command}\n{tomli_w.dumps(moved(fit.data, fit.folder, folder))}"
    return texts


def _toml(fit: Fit, command: str, about: Mapping[str, object], tables: Mapping[str, object]) -> str:
    """The numbers, each with both uncertainties and its state.

    A number that the data do not determine is marked ``determined = false``.
    """
    levels = {n: {"speed": fit.speeds[n], **_row(e)} for n, e in fit.levels.items()}
    text = tomli_w.dumps({
        "version": __version__, "command": command, "status": fit.status, **about, **tables, "levels": levels
    })  # fmt: skip
    return f"# SI units; intervals (low, high) and ranges at 95 %.\n{text}"


def _model(fit: LogFit, command: str) -> dict[str, object]:
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


def _row(e: Estimate, used: float | str | None = None) -> Mapping[str, object]:
    """An estimate without what is open or empty; ``used``: its value in a curve, which may differ."""
    row = e.to_dict() | {"range": e.range and list(e.range), "determined": None if e.usable else False}
    row |= {} if used is None else {"value": used}
    return {key: x for key, x in row.items() if x is not None and x != ""}
