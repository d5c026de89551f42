"""The options of a command in place of the arguments that the library's messages name."""

from __future__ import annotations

# Where an option is not called as the argument: the rest is --argument with dashes.
_WORDS = {
    "constants": "--set", "changes": "--set", "terms": "--term", "units": "--unit", "data": "DATA",
    "forces": "--force", "laws": "--law", "folder": "--out", "speeds": "--speed", "forms": "--no-forms",
    "weight": "--no-weight",
}  # fmt: skip
_POSITIONAL = {"law": ("check", "export"), "scenario": ("run", "sweep", "design")}


def option(name: str, command: str) -> str:
    """What gives an argument on the command line: ``--set k_v`` for ``constants.k_v``."""
    name, _, key = name.partition(".")
    if command in _POSITIONAL.get(name, ()):
        return name.upper()
    return _WORDS.get(name, "--" + name.replace("_", "-")) + (f" {key}" if key else "")
