"""``--target fmu``: an FMU of the law or of a body with it, for FMI 3.0 or 2.0, with sources and binaries."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping

from stribeck.errors import InputError
from stribeck.exports.c import c99
from stribeck.exports.c.ccode import pair, render
from stribeck.exports.c.sampling import resolution
from stribeck.exports.fmu.binaries import binaries
from stribeck.exports.fmu.description import Description, Variables, model_description
from stribeck.exports.request import Request
from stribeck.laws.base import Scales
from stribeck.machine.elements.bodies import MASS


def files(request: Request) -> dict[str, str | bytes]:
    """The archive, under the name of the model."""
    return packed("law", "fmu_model", *described(request))


def packed(part: str, model: str, description: Description, values: Mapping[str, object]) -> dict[str, str | bytes]:
    """The archive of what the templates ``part`` and ``model`` say of this FMU; ``fmu.c`` includes the rest."""
    values = {**values, **description.values()}
    name, fmi = description.prefix, description.fmi
    sources = pair(name, part, values) | {
        f"fmi{fmi}.h": render(f"fmi{fmi}.h"),
        "fmu.c": render(f"{model}.c", **values) + render(f"fmi{fmi}.c", **values),
    }
    content: dict[str, str | bytes] = {"modelDescription.xml": model_description(description)}
    content |= {f"sources/{file}": text for file, text in sources.items()}
    if fmi == 3:
        content["sources/buildDescription.xml"] = render("fmu_build.xml", model=description.model)
    for folder, library in binaries(sources, fmi).items():
        content[f"binaries/{folder}/{description.model}{_suffix(folder)}"] = library
    content["documentation/index.html"] = _page(description.about)
    return {f"{description.model}.fmu": _zipped(content)}


def described(request: Request) -> tuple[Description, dict[str, object]]:
    """The FMU of a law or a body, and what its templates need beside."""
    law, body = request.law, request.part == "body"
    values = c99.context(Request(law, "law", request.scenario, request.step, request.origin, z=request.z))
    scales = law.scales(law.p)
    mass = request.mass if body else 1.0
    variables = _variables(request, mass, scales)
    by_name = {v.name: v.reference for v in variables}
    states = [v for v in variables if v.start is not None and v.name in ("y", "v", "z") and v.nominal is not None]
    model = f"{request.name}_{request.part}"
    about = [*request.about(), *([f"mass = {mass!r} {request.unit('kg')}"] if body else [])]
    description = Description(
        request.name, model, request.options.fmi, about, variables, states, exchange=True, slopes=not law.inputs,
    )  # fmt: skip
    return description, values | {
        "body": body, "mass": mass,
        "partials": _partials(by_name, body, law.has_z), "length": float(scales.length), "speed": float(scales.speed),
        "unknowns": [v.reference for v in variables if v.calculated_from or v.derivative_of is not None],
        "knowns": [v.reference for v in variables if (v.causality == "input" or v in states) and v.name not in law.inputs],
    }  # fmt: skip


def _variables(request: Request, mass: float, scales: Scales) -> Variables:
    law, body, start, unit, words = request.law, request.part == "body", request.start, request.unit, request.words
    variables = Variables()
    add, length, speed = variables.add, float(scales.length), float(scales.speed)
    if body:
        u = add("u", unit("N"), words("force that drives the body"), "input", "m->input", start=0.0)
        y = add("y", unit("m"), words("position"), "output", "m->x[0]", start=start["y"], nominal=length)
        v = add("v", unit("m/s"), words("velocity"), "output", "m->x[1]", start=start["v"], nominal=speed)
    else:
        v = add("v", unit("m/s"), words("velocity"), "input", "m->input", start=0.0)
    loads = tuple(
        add(n, unit(c.unit), words(c.meaning), "input", f"m->load.{n}", start=request.constants[n])
        for n, c in law.constants().items()
        if n in law.inputs
    )
    z = -1
    if law.has_z:
        slot = f"m->x[{2 if body else 0}]"
        z = add("z", unit("m"), words("mean bristle deflection"), "local", slot, start=start["z"], nominal=length)
    known_of_force = (v, *loads, z) if law.has_z else (v, *loads)
    force = words("friction force, positive when it opposes positive velocity")
    add("F", unit("N"), force, "output", "e.force", settable=False, calculated_from=known_of_force)
    slots: list[tuple[str, str, int, tuple[int, ...]]] = []
    if body:
        slots = [("y", "m/s", y, (v,)), ("v", "m/s^2", v, (u, *known_of_force))]
    if law.has_z:
        slots.append(("z", "m/s", z, known_of_force))
    for i, (name, of_rate, state, known) in enumerate(slots):
        add(
            f"der({name})", unit(of_rate), f"rate of {name}", "local", f"e.rate[{i}]", derivative_of=state, settable=False,
            calculated_from=known,
        )  # fmt: skip
    if body:
        add("mass", unit("kg"), words(MASS.meaning), "parameter", "m->mass", start=mass, minimum=0.0)
    constants = {key: value for key, value in request.constants.items() if key not in law.inputs}
    if bad := [key for key in constants if key in {variable.name for variable in variables}]:
        raise InputError([f"{key}: the FMU has a variable of this name: rename the constant" for key in bad])
    for key, value in constants.items():
        variables.add_constant(key, request.declared[key], f"m->p.{key}", value)
    return variables


def _partials(references: dict[str, int], body: bool, has_z: bool) -> list[tuple[int, int, str]]:
    """(unknown, known, C) of every derivative that is not 0."""
    partials = [("F", "v", "l.force_v")]
    if has_z:
        partials += [("F", "z", "l.force_z"), ("der(z)", "v", "l.rate_v"), ("der(z)", "z", "l.rate_z")]
    if body:
        partials += [("der(y)", "v", "1"), ("der(v)", "u", "acceleration_by_u(m->mass)")]
        partials += [
            ("der(v)", known, f"acceleration_by_F(m->mass) * {slope}")
            for output, known, slope in partials
            if output == "F"
        ]
    return [(references[unknown], references[known], c) for unknown, known, c in partials]


def _suffix(folder: str) -> str:
    return ".dll" if "win" in folder and "darwin" not in folder else ".dylib" if "darwin" in folder else ".so"


def _page(lines: list[str]) -> str:
    from html import escape

    text = escape("\n".join(lines))
    return f"<!DOCTYPE html>\n<html lang='en'><meta charset='utf-8'><title>FMU</title><pre>{text}</pre></html>\n"


def _zipped(content: dict[str, str | bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in sorted(content.items()):
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))  # the same FMU every time
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def notes(request: Request) -> list[str]:
    """Notes about the accuracy of co-simulation at the given communication step."""
    return resolution(request) if request.part == "law" else []
