"""Splits long straight-line C functions: a compiler's time and memory grow faster than the length of a function."""

from __future__ import annotations

import re
from collections.abc import Sequence

# Statements of the longest function that stays whole (the longest of the examples has 189), and of a part of a longer one. A
# chain of 200 bodies compiles in 26 s as whole functions, in 11 s with parts of 600 and in 7 s with parts of 100.
_WHOLE, _PART = 600, 100
_BETWEEN = "between"  # the array of the values that later parts use
_DEFINED = re.compile(r"(?:const )?real (\w+) =")
_WORD = re.compile(r"(?<![\w>.])[A-Za-z_]\w*")


def in_parts(name: str, arguments: str, loads: Sequence[str], lines: Sequence[str]) -> tuple[str, list[str]]:
    """Functions that run the statements one after the other, and the statements that call them.

    Args:
        name: of the whole function.
        arguments: its parameters, which each part takes too.
        loads: definitions of local names of the arguments' entries; each part repeats those that it uses.
        lines: the statements; the lines of a loop begin with its variables' definitions and are indented.

    Returns:
        The text of the functions ("" where the statements are few), and the body that replaces the statements.
    """
    if len(lines) <= _WHOLE:
        return "", [*loads, *lines]
    parts = _cut(lines)
    words = [set(_WORD.findall("\n".join(part))) for part in parts]
    places: dict[str, int] = {}
    text = ""
    for i, part in enumerate(parts):
        defined = {m[1] for line in part if (m := _DEFINED.match(line))}
        later = set().union(*words[i + 1 :])
        body = [line for line in loads if (m := _DEFINED.match(line)) and m[1] in words[i]]
        body += [f"const real {word} = {_BETWEEN}[{k}];" for word, k in places.items() if word in words[i]]
        body += part
        for word in sorted(defined & later):
            places[word] = len(places)
            body.append(f"{_BETWEEN}[{places[word]}] = {word};")
        text += f"static NOINLINE void {name}_{i + 1}({arguments}, real *{_BETWEEN})\n{{\n"
        text += "".join(f"    {line}\n" for line in [*unused(f"{arguments}, {_BETWEEN}", body), *body]) + "}\n\n"
    given = ", ".join([*argument_names(arguments), _BETWEEN])
    return text, [f"real {_BETWEEN}[{max(len(places), 1)}];", *(f"{name}_{i + 1}({given});" for i in range(len(parts)))]


def _cut(lines: Sequence[str]) -> list[list[str]]:
    parts: list[list[str]] = [[]]
    for line in lines:
        alone = not line.startswith((" ", "}", "for", "real"))  # not of a loop, whose variables are defined before it
        if alone and len(parts[-1]) >= _PART:
            parts.append([])
        parts[-1].append(line)
    return parts


def argument_names(arguments: str) -> list[str]:
    """The names of a C function's parameters."""
    return [argument.replace("*", " ").split()[-1] for argument in arguments.split(",")]


def unused(arguments: str, body: Sequence[str]) -> list[str]:
    """Statements that mention those parameters which the body does not."""
    words = {word for line in body for word in _WORD.findall(line)}
    return [f"(void){word};" for word in argument_names(arguments) if word not in words]
