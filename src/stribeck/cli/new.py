"""``stribeck new``, also as a function."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.options import command, flag, output_path, setting
from stribeck.cli.output import check_file, wrote
from stribeck.errors import InputError, arg, printable
from stribeck.files import write_text

# What to do with an example, where that is not to run it.
_NEXT = {"axis_hunts": "stribeck design {target}", "joint_from_log": "stribeck fit {target} --logs {logs} --out fit"}
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
def _command(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the file, or of a built-in example.")] = "my_rig",
    out: Annotated[
        Path | None, setting("--out", "FILE", "File to write; NAME.toml unless given.", parser=output_path)
    ] = None,
    list: Annotated[bool, flag("--list", "List the built-in examples.")] = False,
    schema: Annotated[
        bool, flag("--schema", "Write the JSON Schema, with which editors complete and check scenario files.")
    ] = False,
) -> int:
    """Write a commented scenario file to start from."""
    files = new(name, out, list=list, schema=schema)
    if list:
        for file in files:
            first = file.read_text(encoding="utf-8").splitlines()[0]
            print(f"{file.stem:14} {first.lstrip('# ')}")
    elif schema:
        wrote(files, f"; many editors use it where a scenario begins with the line: #:schema {files[0]}")
    else:
        wrote(files)
        following = _NEXT.get(_example(name), "stribeck run {target} --out {stem}").format(
            target=shlex.quote(str(files[-1])), stem=shlex.quote(files[-1].stem),
            logs=shlex.quote(str(files[-1].with_suffix(".logs.toml"))),
        )  # fmt: skip
        print(printable(f"next: {following}"))
    return 0


def new(name: str = "my_rig", out: str | Path | None = None, *, list: bool = False, schema: bool = False) -> list[Path]:
    """Write a commented scenario file to start from.

    Args:
        name: of the file, or of a built-in example, which is copied with its recordings.
        out: the file to write; NAME.toml unless given.
        list: write nothing, and return the files of the built-in examples.
        schema: write the JSON Schema instead, with which editors complete and check scenario files.

    Returns:
        The files that were written, the scenario last.

    Raises:
        InputError: the name is none for a file, or a file exists already or cannot be written.
    """
    from stribeck import examples

    if list:
        return [examples.path(example) for example in examples.names()]
    if schema:
        from stribeck.scenario import schema as json_schema

        return _write({Path(out or json_schema.FILE): json_schema.text()})
    if not (isinstance(name, str) and re.fullmatch(r"[A-Za-z0-9][\w .-]*", name)):
        raise InputError(f"{arg('name')}: {name!r}: must be letters, digits, '_', '-', '.' and spaces")
    example, target = _example(name), Path(out or f"{name.removesuffix('.toml')}.toml")
    known = example in examples.names()
    text = examples.path(example if known else _START).read_text(encoding="utf-8")
    if not known:
        text = _BEGIN.format(name=name.removesuffix(".toml")) + text[text.index("[law.parameters]") :]
    belonging = examples.companions(example) if known else []
    copies = {target.parent / x.name.replace(f"{example}.", f"{target.stem}."): x.read_text("utf-8") for x in belonging}
    return _write({**copies, target: text})


def _example(name: str) -> str:
    """The built-in example that a name would be."""
    return name.removesuffix(".toml").replace("-", "_")


def _write(texts: Mapping[Path, str]) -> list[Path]:
    """Write new files; none if one of them cannot be written."""
    for path in texts:
        check_file(arg("out"), path, new=True)
    for path, text in texts.items():
        write_text(path, text)
    return [*texts]
