"""``stribeck rig``."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path

from stribeck.cli import show
from stribeck.errors import InputError
from stribeck.files import together
from stribeck.parameter_sets import load
from stribeck.rig import report as made
from stribeck.rig.plan import Limits, programme
from stribeck.rig.synthetic import LABEL
from stribeck.scenario import parse_assignments


def rig(
    limits: tuple[float, float, float, float | None], simulate: bool, law: str | None, parameters: str | None,
    assignments: list[str], seed: int, out: Path | None, json: bool,
) -> int:  # fmt: skip
    """Print the programme, or write it and, where asked for, a synthetic log."""
    bounds = Limits(*limits)
    if simulate and out is None:
        raise InputError("--simulate: needs --out DIR, where the synthetic log goes")
    if not simulate and (parameters or assignments):
        raise InputError("--parameters, --set: are for --simulate: the programme depends on the rig's limits only")
    if seed < 0:
        raise InputError(f"--seed: {seed}: must be a whole number >= 0")
    asked = {"--law": law, "--seed": seed or None}
    if not simulate and (alone := [f"{name}: {x}" for name, x in asked.items() if x is not None]):
        raise InputError([f"{each}: goes with --simulate, which is not given" for each in alone])
    law = law or "lugre"
    given = dict(load(parameters).values) if parameters else {}
    given |= made.numbers(list(parse_assignments(assignments).items()))
    experiment = made.simulated(bounds, law, given, seed) if simulate else None
    tests, files = programme(bounds), []
    if out is not None:
        show.check_folder(out)
        with together(out, last="programme.csv", older=made.SYNTHETIC) as place:
            written = made.write_rig(bounds, place)
            written += made.write_simulated(experiment, place) if experiment is not None else []
        files = [str(out / name) for name in written]
    if json:
        truth = None if experiment is None else {"law": law, "constants": experiment.law.values, "label": LABEL}
        show.print_json({"tests": [asdict(t) for t in tests], "synthetic": truth, "files": files})
    else:
        print(made.csv(made.HEAD, made.table(tests)), end="")
    for file in files:
        print(f"wrote {file}", file=sys.stderr)
    return 0
