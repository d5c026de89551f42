"""The files of ``stribeck fit --out``: parameters.toml and report.html."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path

from stribeck.errors import note
from stribeck.files import write_text
from stribeck.identify.result import Estimate, Fit
from stribeck.version import __version__

# What each kind of fit leaves and the other does not write: it would stand beside numbers that are not its own.
FITS = {"machine.toml": "# Found by: ", "fit.json": r'\{\s*"format": '}


def write_fit(
    fit: Fit, folder: Path, command: str, data: str, reading: Mapping[str, object] | None = None
) -> list[str]:
    """Write parameters.toml and fit.json, then report.html; their names."""
    return [*write_numbers(fit, folder, command, data, reading), *write_report(fit, folder, command, data)]


def write_numbers(
    fit: Fit, folder: Path, command: str, data: str, reading: Mapping[str, object] | None = None
) -> list[str]:
    """Write parameters.toml and fit.json; their names.

    Args:
        reading: how the record was read, for fit.json; as the fit has it unless given.
    """
    from stribeck.identify import predict

    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / "parameters.toml", toml(fit, command, data))
    write_text(folder / predict.FILE, predict.saved(fit, reading if reading is not None else fit.reading))
    return ["parameters.toml", predict.FILE]


def write_report(fit: Fit, folder: Path, command: str, data: str) -> list[str]:
    """Write report.html; its name, or none where it could not be drawn, which a note says."""
    from stribeck.identify.report.page import page

    try:
        write_text(folder / "report.html", page(fit, command, data))
    except (KeyError, ValueError, IndexError, TypeError, ZeroDivisionError) as error:
        note(f"report.html: could not be drawn ({type(error).__name__}: {error}); the results are written")
        return []
    return ["report.html"]


def toml(fit: Fit, command: str, data: str) -> str:
    """The fit as a parameter set; what the data do not determine is marked in [parameters], and explained in [unknown]."""
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
    lines.append("[parameters]")
    lines += [f"{name} = {_estimate(e, fit.used.get(name))}" for name, e in fit.estimates.items()]
    lines += [
        f"{name} = {_given(value)}" for name, value in fit.fixed.items() if name in stribeck_constants(fit.law_name)
    ]
    if fit.body:
        lines += ["", "# The rig, not the law", "[body]", *(f"{n} = {_estimate(e, None)}" for n, e in fit.body.items())]
    if fit.levels:
        speeds = fit.details.get("speeds", {})
        lines += ["", "# Friction at speeds that were seen", "[levels]"]
        for n, e in fit.levels.items():
            speed = f"speed = {_number(speeds[n])}, " if n in speeds else ""
            lines.append(f"{_text(n)} = {{ {speed}{_estimate(e, None)[2:]}")
    for name, e in {**fit.estimates, **fit.body}.items():
        if not e.usable:
            lines += ["", f"[unknown.{name}]", f"unit = {_text(e.unit)}", f"why = {_text(e.why)}"]
            lines += [f"experiment = {_text(e.experiment)}"]
    if len(fit.names):
        rows = (", ".join(_number(x) for x in row) for row in fit.covariance.tolist())
        lines += ["", "[covariance]", f"names = [{', '.join(map(_text, fit.names))}]"]
        lines += ["matrix = [", *(f"  [{row}]," for row in rows), "]"]
    return "\n".join(lines) + "\n"


def stribeck_constants(law: str) -> Mapping[str, object]:
    """The constants of a law by name."""
    from stribeck import laws

    return laws.find(law).constants()


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


def _number(x: float | None) -> str:
    assert x is not None
    return repr(float(x)) if math.isfinite(x) else "nan" if math.isnan(x) else "inf" if x > 0 else "-inf"


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
