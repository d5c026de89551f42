"""``stribeck new``."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.options import command, flag, output_path, setting
from stribeck.cli.output import check_file, wrote
from stribeck.errors import InputError, printable

# What to do with an example, where that is not to run it.
_NEXT = {
    "axis_hunts": "stribeck design {target}",
    "joint_from_log": "stribeck fit {target} --logs {stem}.logs.toml --out fit",
}
_START = "stick_slip"  # the example that a new name starts from, under another law
_BEGIN = """\
# {name}: a scenario for 'stribeck run'. SI units everywhere; with rotary = true N m and rad.
# [law] name: 'stribeck library' lists them; parameters: a table as here, a built-in set ("canudas1995") or a file.
# [drive] kind: "force" (N), "spring" (position of the far end, m), "pid" (setpoint, m) or "velocity" (m/s);
#         "cascade", a pneumatic servo, has an example of its own: stribeck new servo.
# [drive.signal] kind: "points" (t, value), "ramp" (rate), "sine" (amplitude, frequency, offset, phase),
#                      "step" (value, time) or "file" (path, time, value, unit: columns of a recorded file).
schema = 1
name = "{name}"

[law]
name = "lugre_majorant"         # smooth, and with these constants passive; 'stribeck library' lists the others
k_v = 1e6                       # s/m, steepness near rest; 'stribeck check --creep' finds the smallest
v_d = 0.02                      # m/s, bristle damping falls with speed; without it this set is not passive

"""


@command("new", "stribeck new my_rig")
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the file, or of a built-in example.")] = "my_rig",
    out: Annotated[
        Path | None,
        setting("--out", "FILE", "File to write; NAME.toml unless given.", parser=output_path),
    ] = None,
    show_list: Annotated[bool, flag("--list", "List the built-in examples.")] = False,
    schema: Annotated[
        bool,
        flag("--schema", "Write the JSON Schema, with which editors complete and check scenario files."),
    ] = False,
) -> int:
    """Write a commented scenario file to start from."""
    from stribeck import examples
    from stribeck.files import write_text

    if show_list:
        for example in examples.names():
            first = examples.path(example).read_text(encoding="utf-8").splitlines()[0]
            print(f"{example:14} {first.lstrip('# ')}")
        return 0
    if schema:
        return _schema(out)
    if not re.fullmatch(r"[A-Za-z0-9][\w .-]*", name):
        raise InputError(f"NAME: {name!r}: must be letters, digits, '_', '-', '.' and spaces")
    name = name.removesuffix(".toml")
    example = name.replace("-", "_")
    known = example in examples.names()
    text = examples.path(example if known else _START).read_text(encoding="utf-8")
    if not known:
        text = _BEGIN.format(name=name) + text[text.index("[law.parameters]") :]
    target = out or Path(f"{name}.toml")
    belonging = examples.companions(example) if known else []
    copies = {target.parent / data.name.replace(f"{example}.", f"{target.stem}."): data for data in belonging}
    for path in (target, *copies):
        check_file("--out", path, new=True)
    for path, data in copies.items():
        write_text(path, data.read_text(encoding="utf-8"))
        wrote([path])
    write_text(target, text)
    following = _NEXT.get(example, "stribeck run {target} --out {stem}").format(
        target=shlex.quote(str(target)), stem=shlex.quote(target.stem)
    )
    wrote([target])
    print(printable(f"next: {following}"))
    return 0


def _schema(out: Path | None) -> int:
    from stribeck.files import write_text
    from stribeck.scenario import schema

    target = out or Path(schema.FILE)
    check_file("--out", target, new=True)
    write_text(target, schema.text())
    wrote([target], f"; many editors use it where a scenario begins with the line: #:schema {target}")
    return 0
