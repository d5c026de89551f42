"""``--target c``: one header and one source of C99."""

from __future__ import annotations

import json
from importlib.resources import files as resources

from stribeck.errors import InputError, arg
from stribeck.exports.c.ccode import ARGUMENTS, WORDS, Call, LawCode, c_conditions, net_force, pair, render
from stribeck.exports.request import Request
from stribeck.expressions import pretty
from stribeck.expressions.graph import symbol, wrap
from stribeck.laws import builtin
from stribeck.laws.base import Law
from stribeck.machine.pneumatic.observer import least_K_D


def files(request: Request) -> dict[str, str | bytes]:
    """``NAME.h`` and ``NAME.c``, and ``NAME_test.c`` if requested."""
    values = context(request)
    name = request.name
    content: dict[str, str | bytes] = {**pair(name, "law", values)}
    if request.options.self_test:
        from stribeck.exports.c.selftest import cases

        content[f"{name}_test.c"] = render("law_test.c", **values, cases=cases(request))
    return content


def context(request: Request) -> dict[str, object]:
    """Values for the templates."""
    law, equations = request.law, LawCode(request.law)
    if request.part == "observer" and not equations.observable:
        what = "no sigma_0 to weigh the tracking error by" if law.has_z else "no internal state to observe"
        raise InputError(f"{arg('part')}: 'observer': law '{law.name}' has {what}")
    if bad := [name for name in request.constants if name in WORDS | ARGUMENTS or not name.isascii()]:
        raise InputError([f"{name}: a constant of this name cannot be exported to C: rename it" for name in bad])
    declared = request.declared
    every = {name: (declared[name], value) for name, value in request.constants.items()}
    inputs = {name: declared[name] for name in law.inputs}
    return {
        "u": request.unit,
        "w": request.words,
        "P": request.name,
        "about": request.about(),
        "law": law,
        "constants": {name: declaration for name, declaration in every.items() if name not in inputs},
        "inputs": inputs,
        "call": Call(request.name, law.inputs),
        "now": "&now" if inputs else "&m->p",
        "relations": c_conditions(law, {name: f"p->{name}" for name in request.constants}),
        "eq": equations,
        "smooth": law.differentiable and not inputs,
        "costs": costs(law),
        "start": request.start,
        "with_body": request.part in ("law", "body"),
        "net_force": net_force(),
        "with_observer": equations.observable and request.part in ("law", "observer"),
        "proven_observer": equations.observable and equations.linear,
        "least_K_D": _least_K_D(),
    }


def _least_K_D() -> str:
    """The proof's condition on K_D, in words."""
    names = ("K", "sigma_0", "sigma_1", "w")
    return pretty.write(wrap(least_K_D(*map(symbol, names))), dict(zip(names, names, strict=True)), latex=False)


def costs(law: Law) -> list[str]:
    """Lines of the header with the cost of a step, by benchmarks/instructions.py; none for a law or form without a count."""
    counted = json.loads(resources("stribeck.exports").joinpath("templates", "costs.json").read_text(encoding="utf-8"))
    rows = counted["laws"].get(" ".join((law.name, *law.form.words)), {})
    if not rows or builtin().get(law.name) is not type(law):
        return []
    each = "; ".join(f"{target} {mean} (most {most})" for target, (mean, most) in rows.items())
    return [
        f"Instructions of one {law.name}_step, mean over speeds around v_s at 1 ms:",
        f"  {each}",
        f"  (gcc {counted['gcc']} -O2 with newlib, every executed instruction counted under qemu; cycles depend on your part)",
    ]


def notes(request: Request) -> list[str]:
    """Notes about the loss of accuracy at the given time step."""
    from stribeck.exports.c.sampling import unstable

    return unstable(request)
