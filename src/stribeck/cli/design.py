"""``stribeck design``."""

from __future__ import annotations

import shlex
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from stribeck.cli.options import ADVANCED, ControllerName, Json, Out, ScenarioOptions, command, flag, setting
from stribeck.cli.output import command_line, failed, output_folder, tell
from stribeck.cli.progress import progress

if TYPE_CHECKING:
    from stribeck.loops import Design, ServoDesign
    from stribeck.mouth.document import Document


@command("design", "stribeck design machine.toml --vary controllers.axis.K_p=10:1000 --out design")
def design(
    source: ScenarioOptions,
    vary: Annotated[
        list[str] | None,
        setting("--vary", "PATH=LOW:HIGH", "Find the values at which the verdict changes; may be repeated."),
    ] = None,
    compensate: Annotated[
        bool, flag("--compensate", "Compare remedies: feedforward, observer, inner loop, dither.")
    ] = False,
    uncertainty: Annotated[
        Path | None,
        setting(
            "--uncertainty", "parameters.toml",
            "Friction intervals for --compensate, from a fit; 10 % both ways unless given.",
        ),
    ] = None,
    controller: ControllerName = None,
    out: Out = None,
    json: Json = False,
    v_max: Annotated[
        float | None,
        setting(
            "--v-max", "V", "Largest speed of a servo's proof (m/s); twice the largest simulated speed unless given.",
            ADVANCED,
        ),
    ] = None,
) -> int:  # fmt: skip
    """Report whether an axis hunts, and by how much.

    --vary finds the gain at which hunting begins; --compensate compares remedies.

    For a pneumatic servo: report whether its Lyapunov function decreases.
    """
    from stribeck.loops import design as judge
    from stribeck.loops.boundary import Turned
    from stribeck.loops.written import FILES, write_design

    loaded = source.load(*(partial(Turned.parse, text) for text in vary or []))
    with output_folder(out, [source.scenario], FILES):
        with progress(loaded.name) as share:
            result = judge(
                loaded, vary=vary or [], compensate=compensate, uncertainty=uncertainty, controller=controller, v_max=v_max,
                tell=share,
            )  # fmt: skip
        summary = result.to_dict()
        files = [] if out is None else write_design(result, summary, out, command_line())
    tell(lambda: _document(result, source.scenario, out=out), summary if json else None, files)
    if result.failed is not None:
        failed(loaded.name, result.failed)
        return 1
    return 0


def _document(result: Design | ServoDesign, path: Path, *, out: Path | None) -> Document:
    """The result as a document, under the file's name, with the next step."""
    from stribeck.loops import Design

    document = result.document()
    if not isinstance(result, Design):
        return document
    again = f"stribeck design {shlex.quote(str(path))} --compensate"
    if not result.compensations and not result.why_not:
        following = again, "compare remedies against friction"
    elif out is None:
        following = f"{again} --out design", "write the page and the machine"
    else:
        machine = shlex.quote(str(out / "machine.toml"))
        following = f"stribeck export {machine} --part controller --target c --out c", "the controller as C"
    return replace(document, title=path.name, next=following)
