"""Error lines of the command: the library's messages with options in place of arguments."""

from __future__ import annotations

from stribeck.errors import EXTRAS, MissingExtra, StribeckError, one_line, remedy

# Where an option is not called as the argument: the rest is --argument with dashes.
_WORDS = {"data": "DATA", "forms": "--no-forms"}
_POSITIONAL = {
    "name": ("new",),
    "what": ("explore",),
    "law": ("check", "export"),
    "scenario": ("run", "sweep", "design"),
}

# The extra that has all a command needs, where one of its packages comes with another one too.
_EXTRA = {"fit": "fit", "predict": "fit", "check": "fit", "design": "fit", "export": "fmu"}


def option(name: str, command: str) -> str:
    """The option of an argument on the command line: ``--v-max`` for ``v_max``, ``--set k_v`` for ``set.k_v``."""
    name, _, key = name.partition(".")
    if command in _POSITIONAL.get(name, ()):
        return name.upper()
    return _WORDS.get(name, "--" + name.replace("_", "-")) + (f" {key}" if key else "")


def status_of(error: BaseException, command: str) -> tuple[int, str]:
    """The status and the line for what was raised; what nobody's file or installation is at fault for is raised again."""
    from stribeck.kinds import at_fault

    if isinstance(error, MissingExtra | ModuleNotFoundError) and (text := _missing(error, command)):
        return 2, text
    if isinstance(error, StribeckError):
        return 1, one_line(str(error))
    if (usage := getattr(error, "format_message", None)) is not None:  # no text where the help was printed instead
        text = " ".join(usage().split())
        asked = context.command_path if (context := getattr(error, "ctx", None)) else "stribeck"
        return 2, f"{text} ({asked} --help)" if text else ""
    if isinstance(error, MemoryError):
        return 1, f"not enough memory{f': {error}' if str(error) else ''}"
    if isinstance(error, OSError):
        where = f"{error.filename}: " if error.filename else ""
        return 1, f"{where}{error.strerror or error}"
    if (text := at_fault(error) or "") == "" and isinstance(error, ImportError):  # no memory for it, or it is damaged
        return 1, f"a library cannot be loaded: {error}"
    if not text:
        raise error
    return 2, text


def _missing(error: MissingExtra | ModuleNotFoundError, command: str) -> str:
    """The command that installs a missing package; empty if no extra contains it."""
    package = error.package if isinstance(error, MissingExtra) else (error.name or "").partition(".")[0]
    if package not in EXTRAS:
        return ""
    if isinstance(error, MissingExtra) and (command not in _EXTRA or error.extra not in ("plot", "fit", "fmu")):
        return one_line(str(error))
    how = remedy(package, EXTRAS[package] and _EXTRA.get(command, EXTRAS[package]))
    return f"'{command}' needs {package}: {how}"
