"""The files of a fit: its numbers (parameters.toml, fit.json, machine.toml), then report.html."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path

import tomli_w

from stribeck import laws
from stribeck.errors import note
from stribeck.files import seen_from, together, write_text
from stribeck.identify.actuator.result import MachineFit
from stribeck.identify.core.states import Estimate
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
    if isinstance(fit, LogFit):
        write_text(place / PARAMETERS, toml(fit, command))
        return [PARAMETERS, FILE]
    assert isinstance(fit, MachineFit)
    write_text(place / PARAMETERS, machine_toml(fit, command, folder))
    if fit.status != "done":
        return [PARAMETERS, FILE]
    tables = moved(fit.data, fit.folder, folder)
    write_text(place / MACHINE, f"# Found by: {command}\n{tomli_w.dumps(tables)}")
    return [PARAMETERS, FILE, MACHINE]


# -- of a log --------------------------------------------------------------------------------------------------------


def toml(fit: LogFit, command: str) -> str:
    """The fit as a parameter set; what the data do not determine is marked in [parameters], and explained in [unknown]."""
    data = ", ".join(Path(name).name for name in fit.reading.files) or fit.title
    lines = [
        "# Friction parameters from measured data, by 'stribeck fit'. SI units; intervals and ranges at 95 %.",
        f"title = {_text(f'{fit.law_name} fitted to {data}')}",
        f"source = {_text(f'stribeck {__version__}: {command}')}",
        *(['motion = "rotary"'] if fit.log is not None and fit.log.rotary else []),
        f"law = {_text(fit.law_name)}",
        f"method = {_text(fit.method)}",
        f"data = {_text(data)}",
        f"data_sha256 = {_text(fit.data_hash)}",
        f"version = {_text(__version__)}",
        f"command = {_text(command)}",
        f"status = {_text(fit.status)}",
        f"relative_force_error = {_number(fit.relative_force_error)}",
    ]
    if fit.cross_validated_error is not None:
        lines.append(f"cross_validated_error = {_number(fit.cross_validated_error)}")
    lines.append("")
    if any(not e.usable for e in fit.estimates.values()):
        lines += [
            "# determined = false: the data do not tell this number; it is the fitted curve's, and is refused",
            "# unless --allow-undetermined is given. [unknown] says why, and what to measure.",
        ]
    known = laws.find(fit.law_name).constants()
    lines.append("[parameters]")
    lines += [f"{name} = {_estimate(e, fit.used.get(name))}" for name, e in fit.estimates.items()]
    lines += [f"{name} = {_given(value)}" for name, value in fit.fixed.items() if name in known]
    if fit.body:
        lines += ["", "# The rig, not the law", "[body]", *(f"{n} = {_estimate(e, None)}" for n, e in fit.body.items())]
    lines += [*_levels(fit), *_unknown(fit), *_covariance(fit)]
    return "\n".join(lines) + "\n"


def _levels(fit: LogFit) -> list[str]:
    if not fit.levels:
        return []
    lines = ["", "# Friction at speeds that were seen", "[levels]"]
    for n, e in fit.levels.items():
        speed = f"speed = {_number(fit.speeds[n])}, " if n in fit.speeds else ""
        lines.append(f"{_text(n)} = {{ {speed}{_estimate(e, None)[2:]}")
    return lines


def _unknown(fit: LogFit) -> list[str]:
    lines = []
    for name, e in {**fit.estimates, **fit.body}.items():
        if not e.usable:
            lines += ["", f"[unknown.{name}]", f"unit = {_text(e.unit)}", f"why = {_text(e.why)}"]
            lines += [f"experiment = {_text(e.experiment)}"]
    return lines


def _covariance(fit: LogFit) -> list[str]:
    if not fit.names:
        return []
    rows = (", ".join(_number(x) for x in row) for row in fit.covariance.tolist())
    lines = ["", "[covariance]", f"names = [{', '.join(map(_text, fit.names))}]"]
    return [*lines, "matrix = [", *(f"  [{row}]," for row in rows), "]"]


def _estimate(e: Estimate, used: float | None) -> str:
    """The value as the curve uses it, with interval, range and state; marked if the data do not determine it."""
    value = e.value if used is None else used
    ends = "".join(f", {side} = {_number(x)}" for side, x in (("low", e.low), ("high", e.high)) if x is not None)
    if e.range:
        ends += f", range = [{_number(e.range[0])}, {_number(e.range[1])}]"
    state = f", state = {_text(str(e.state))}" + (f", depends_on = {_text(e.depends_on)}" if e.depends_on else "")
    mark = "" if e.usable else ", determined = false"
    return f"{{ value = {_number(value)}{ends}, unit = {_text(e.unit)}{state}{mark} }}"


def _given(value: float | str) -> str:
    return _text(value) if isinstance(value, str) else _number(value)


def _number(x: float) -> str:
    return repr(float(x)) if math.isfinite(x) else "nan" if math.isnan(x) else "inf" if x > 0 else "-inf"


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


# -- of a machine ------------------------------------------------------------------------------------------------------


def machine_toml(fit: MachineFit, command: str, folder: Path) -> str:
    """The numbers by path and the levels, each with both uncertainties and its state."""
    told: dict[str, object] = {"version": __version__, "command": command, "status": fit.status}
    if fit.reason:
        told["reason"] = fit.reason
    if fit.source is not None:
        told["logs"] = seen_from(folder, fit.source)
    rows = {name: _row(e) for name, e in fit.estimates.items()}
    levels = {name: {"speed": fit.speeds[name], **_row(e)} for name, e in fit.levels.items()}
    return tomli_w.dumps({**told, "parameters": rows, "levels": levels})


def _row(e: Estimate) -> Mapping[str, object]:
    """An estimate without what is open or empty."""
    own = {
        "value": e.value, "low": e.low, "high": e.high, "range": None if e.range is None else list(e.range), "unit": e.unit,
        "identifiable": e.identifiable, "state": str(e.state), "depends_on": e.depends_on, "why": e.why,
        "experiment": e.experiment,
    }  # fmt: skip
    return {k: x for k, x in own.items() if x is not None and x != ""}
