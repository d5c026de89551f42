"""``stribeck laws``."""

from __future__ import annotations

from dataclasses import asdict, fields
from typing import Any

from stribeck import laws as registry
from stribeck.cli.show import print_json
from stribeck.cli.text import say
from stribeck.constants import DECIDED
from stribeck.errors import InputError, note, said_by
from stribeck.laws.base import Claims, Law
from stribeck.laws.form import USUAL, Form
from stribeck.laws.render import Equation, condition, equations
from stribeck.parameter_sets import parameters
from stribeck.scenario.trust import in_a_file

_OF_FILES = ("name", "units", "words")  # what a set says of itself beside its numbers, or of its file


def laws(names: list[str], json: bool, test: bool, sets: bool = False) -> int:
    """List the laws named, or all; with ``test``, test what they claim; with ``sets``, list the parameter sets."""
    if sets:
        return _sets(names, json)
    chosen = [registry.find(name) for name in names] or list(registry.builtin().values())
    if test:
        return _test(chosen, json)
    described = [_described(law, name) for law, name in zip(chosen, names or registry.builtin(), strict=True)]
    if json:
        known = {name: {k: v for k, v in asdict(s).items() if k not in _OF_FILES} for name, s in parameters().items()}
        print_json({"laws": described, "parameter_sets": known})
        return 0
    for law in described:
        _print(law)
    if not names:
        say("parameter sets: " + ", ".join(parameters()) + " (--sets shows what is passive with each)", 4)
    return 0


def _sets(names: list[str], json: bool) -> int:
    """The built-in parameter sets and the laws that are passive with each."""
    from stribeck.properties.matrix import every_law, passive_with

    if names:
        raise InputError(f"--sets: lists every set with every law; leave out {', '.join(names)}")
    listed = {
        name: {
            **{k: v for k, v in asdict(s).items() if k not in _OF_FILES},
            "passive": passive_with(s.values),
            "own_constants": {n: x for law in every_law(s.values) for n, x in law.p.numbers.items()
                              if n in law.own_constants()},
        }
        for name, s in parameters().items()
    }  # fmt: skip
    if json:
        print_json({"parameter_sets": listed})
        return 0
    for name, s in listed.items():
        passive = [law for law, holds in s["passive"].items() if holds]
        own = ", ".join(f"{n} = {x:g}" for n, x in s["own_constants"].items())
        say(f"{name}: {s['title']} ({s['motion']})", 4)
        say(", ".join(f"{n} = {x:g}" for n, x in s["values"].items()), 4, "    ")
        say(f"passive with {', '.join(passive) or 'no law'} (with {own})", 6, "    ")
        say(f"source: {s['source']}", 6, "    ")
    return 0


def _described(law: type[Law], name: str) -> dict[str, object]:
    try:
        described, trouble = _describe(law), _trouble(law) if in_a_file(name) else None
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        if not in_a_file(name):
            raise
        raise InputError(f"{name!r}: its equations cannot be evaluated: {said_by(error)}") from error
    if trouble:
        raise InputError(f"{name!r}: {trouble}")
    return described


def _trouble(law: type[Law]) -> str | None:
    """What keeps its equations from being evaluated with constants that are allowed; None where none are at hand."""
    values = _example(law)
    values |= {n: 1.0 for n, c in law.constants().items() if c.required and n not in values and not c.problem(1.0)}
    if law.problems(values):
        return None
    found = law(values)
    trouble = registry.trouble(found)
    if trouble is None and (text := registry.gap(found)):
        note(f"law '{law.name}': {text}")
    return trouble


def _example(law: type[Law]) -> dict[str, float]:
    """Constants that make sense."""
    values = {n: v for n, v in parameters()["canudas1995"].values.items() if n in law.constants()}
    return values | {n: c.example for n, c in law.own_constants().items() if c.example is not None and n not in values}


def _describe(law: type[Law]) -> dict[str, object]:
    constants = {
        name: {
            "unit": c.unit or "1", "rotary_unit": c.rotary_unit, "meaning": c.meaning, "allowed": c.allowed,
            "required": c.required, "default": c.choices[0] if c.choices else c.default,
            "where": "law.parameters" if name in law.uses else "law",
        }
        for name, c in law.constants().items()
    }  # fmt: skip
    return {
        "name": law.name,
        "summary": " ".join((law.__doc__ or "").split()),
        "equations": _equations(law),
        "parameters": constants,
        "source": law.source,
        "has_z": law.has_z,
        "guarantees": _guarantees(law),
        "with": {form.words[0]: _changed(law, form) for form in law.forms() if len(form.words) == 1},
    }


def _equations(law: type[Law], form: Form = USUAL) -> list[dict[str, str]]:
    return [asdict(e) for e in equations(law, form)]


def _guarantees(law: type[Law], form: Form = USUAL) -> dict[str, object]:
    claims = {field.name: getattr(law.claims, field.name) for field in fields(Claims)}
    found = {n: condition(c, law, form) if callable(c) else c for n, c in claims.items()}
    return {n: {"if": asdict(c)} if isinstance(c, Equation) else c for n, c in found.items()}


def _changed(law: type[Law], form: Form) -> dict[str, object]:
    """The equations and guarantees that a form of the law has and the usual one has not."""
    usual, claims = _equations(law), _guarantees(law)
    return {
        "equations": [e for e in _equations(law, form) if e not in usual],
        "guarantees": {n: c for n, c in _guarantees(law, form).items() if c != claims[n]},
    }


def _print(law: dict[str, Any]) -> None:
    say(f"{law['name']}: {law['summary']}", 4)
    for equation in law["equations"]:
        say(equation["text"], 8, "    ")
    words = _words(law["guarantees"])
    none = "none stated" if law["has_z"] else "no internal state, so none of the five properties"
    say(words or none, 13, "  claims     ")
    for form, changed in law["with"].items():
        parts = [*(e["text"] for e in changed["equations"]), _words(changed["guarantees"])]
        say("; ".join(part for part in parts if part), 13, f"  with {form}: ")
    own = [f"{n} ({_unit_or_words(p)}, {p['meaning']})" for n, p in law["parameters"].items() if p["where"] == "law"]
    if own:
        say("; ".join(own), 13, "  constants  ")
    used = [n for n, p in law["parameters"].items() if p["where"] != "law"]
    say(", ".join(used) or "none", 13, "  parameters ")
    say(law["source"], 13, "  source     ")
    print()


def _words(guarantees: dict[str, object]) -> str:
    words = []
    for name, claim in guarantees.items():
        if claim is not None:
            text = f"if {claim['if']['text']}" if isinstance(claim, dict) else DECIDED[bool(claim)]
            words.append(f"{name.replace('_', '-')}: {text}")
    return "; ".join(words)


def _unit_or_words(parameter: dict[str, Any]) -> str:
    return str(parameter["allowed"] if parameter["allowed"].startswith("one of") else parameter["unit"])


def _test(chosen: list[type[Law]], json: bool) -> int:
    from stribeck.laws.claims import violations

    found: dict[str, list[str]] = {}
    for law in chosen:
        found[law.name] = violations(law(_example(law)))
    if json:
        print_json({"violations": found})
    else:
        for name, texts in found.items():
            print(f"{name}: {'all that it claims holds in the tests' if not texts else ''}")
            for text in texts:
                print(f"    {text}")
    return 1 if any(found.values()) else 0
