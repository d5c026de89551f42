"""The files of ``stribeck fit --out``: parameters.toml and report.html."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path

from stribeck.files import write_text
from stribeck.identify.log import Log
from stribeck.identify.result import Estimate, Fit
from stribeck.identify.statistics.choose import Choice
from stribeck.version import __version__

# What each kind of fit leaves and the other does not write: it would stand beside numbers that are not its own.
FITS = {"machine.toml": "# Found by: ", "fit.json": r'\{\s*"format": '}


def write_fit(result: Fit | Choice, log: Log, folder: Path, command: str, data: str) -> list[str]:
    """Write report.html and parameters.toml; their names."""
    from stribeck.identify.report.page import page

    fit = result.best if isinstance(result, Choice) else result
    folder.mkdir(parents=True, exist_ok=True)
    report, parameters = folder / "report.html", folder / "parameters.toml"
    write_text(report, page(result, log, command, data))
    write_text(parameters, toml(fit, command, data))
    return [parameters.name, report.name]


def toml(fit: Fit, command: str, data: str) -> str:
    """The fit as a parameter set; what the data do not determine is marked in [parameters], and explained in [unknown]."""
    lines = [
        "# Friction parameters from measured data, by 'stribeck fit'. SI units; intervals at 95 %.",
        f"title = {_text(f'{fit.law} fitted to {data}')}",
        f"source = {_text(f'stribeck {__version__}: {command}')}",
        f"law = {_text(fit.law)}",
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
    if any(not e.identifiable for e in fit.estimates.values()):
        lines += [
            "",
            "# determined = false: the data do not tell this number; it is the fitted curve's, and is refused",
        ]
        lines += ["# unless --allow-undetermined is given. [unknown] says why, and what to measure.", "[parameters]"]
    else:
        lines += ["", "[parameters]"]
    lines += [f"{name} = {text}" for name, e in fit.estimates.items() if (text := _estimate(e, fit.used.get(name)))]
    lines += [f"{name} = {_given(value)}" for name, value in fit.fixed.items() if name in stribeck_constants(fit.law)]
    if body := {n: text for n, e in fit.body.items() if (text := _estimate(e, fit.used.get(n)))}:
        lines += ["", "# The rig, not the law", "[body]", *(f"{name} = {text}" for name, text in body.items())]
    unknown = {n: e for n, e in {**fit.estimates, **fit.body}.items() if not e.identifiable}
    if unknown:
        lines += ["", "# Not determined by the data"]
    for name, e in unknown.items():
        lines += [f"[unknown.{name}]", f"unit = {_text(e.unit)}", f"why = {_text(e.why)}"]
        lines += [f"{side} = {_number(x)}" for side, x in (("low", e.low), ("high", e.high)) if x is not None]
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
    """The value with its interval, or the best one, marked; nothing where there is none."""
    best = e.value if e.identifiable else e.best if e.best is not None else used
    if best is None:
        return ""
    ends = "".join(f", {side} = {_number(x)}" for side, x in (("low", e.low), ("high", e.high)) if x is not None)
    mark = "" if e.identifiable else ", determined = false"
    return f"{{ value = {_number(best)}{ends}, unit = {_text(e.unit)}{mark} }}"


def _given(value: float | str) -> str:
    return _text(value) if isinstance(value, str) else _number(value)


def _number(x: float | None) -> str:
    assert x is not None
    return repr(float(x)) if math.isfinite(x) else "nan" if math.isnan(x) else "inf" if x > 0 else "-inf"


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
