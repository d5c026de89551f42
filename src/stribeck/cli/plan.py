"""``stribeck fit --plan``: what to measure before a fit."""

from __future__ import annotations

from dataclasses import asdict, fields
from pathlib import Path

import typer

from stribeck.cli.options import given_options
from stribeck.cli.output import output_folder, print_json, wrote
from stribeck.errors import InputError, read_pairs
from stribeck.files import together
from stribeck.identify import plan_files
from stribeck.identify.plan import Limits, program
from stribeck.identify.synthetic import LABEL
from stribeck.parameter_sets.assignments import parse_assignments, value_of

_WITH_PLAN = ("plan", "simulate", "law", "set_", "seed", "out", "json")
_SIMULATED = ("law", "set_", "seed")  # describe the synthetic rig alone


def plan(
    context: typer.Context, text: str, *, simulate: bool, laws: list[str], assignments: list[str], seed: int,
    out: Path | None, json: bool,
) -> int:  # fmt: skip
    """Print the experiments that would determine a law on a rig with these limits; simulate a log of them on request."""
    given = given_options(context)
    if wrong := [words for name, words in given.items() if name not in _WITH_PLAN]:
        raise InputError([f"{words}: must be left out with --plan, which fits nothing" for words in wrong])
    if not simulate and (alone := [words for name, words in given.items() if name in _SIMULATED]):
        raise InputError([f"{words}: goes with --simulate, which is not given" for words in alone])
    if simulate and out is None:
        raise InputError("--simulate: needs --out DIR, where the synthetic log goes")
    if len(laws) > 1:
        raise InputError("--law: given twice: a synthetic rig has one law")
    limits, law = _limits(text), laws[0] if laws else "lugre"
    constants = plan_files.numbers(list(parse_assignments(assignments).items()))
    experiment = plan_files.simulated(limits, law, constants, seed) if simulate else None
    tests, files = program(limits), list[str]()
    if out is not None:
        name = "program.csv"
        with output_folder(out, writes=[name]), together(out, last=name, older=plan_files.SYNTHETIC) as place:
            written = plan_files.write_rig(limits, place)
            written += plan_files.write_simulated(experiment, place) if experiment is not None else []
        files = [str(out / name) for name in written]
    if json:
        truth = None if experiment is None else {"law": law, "constants": experiment.law.values, "label": LABEL}
        print_json({"tests": [asdict(t) for t in tests], "synthetic": truth, "files": files})
    else:
        print(plan_files.table(tests), end="")
    wrote(files, error=True)
    return 0


def _limits(text: str) -> Limits:
    """``stroke=M,speed=M/S,force=N`` as limits.

    Raises:
        InputError: a key is unknown, missing or given twice, or a value is no number.
    """
    known = [field.name for field in fields(Limits)]

    def read(part: str) -> tuple[str, float]:
        key, sign, given = part.partition("=")
        key, value = key.strip(), value_of(given)
        if key not in known or not sign:
            raise InputError(f"--plan: {part!r}: must be one of {', '.join(known)}, followed by = and a number")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"--plan {key}: {value!r}: must be a number")
        return key, float(value)

    limits = read_pairs(read, text.split(","), "--plan")
    if missing := [f"--plan {key}: missing" for key in ("stroke", "speed", "force") if key not in limits]:
        raise InputError(missing)
    return Limits(**limits)
