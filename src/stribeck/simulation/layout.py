"""The structs that Python shares with the compiled solvers: their fields are read from the C that declares them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from ctypes import CDLL, Structure, c_double, c_int8, c_int32, c_int64, c_void_p, sizeof
from importlib.resources import files

from stribeck.errors import BuildError

_TYPES: dict[str, type] = {"double": c_double, "int64_t": c_int64, "int32_t": c_int32, "int8_t": c_int8}


def struct_fields(file: str, struct: str, pointer: type = c_void_p) -> list[tuple[str, type]]:
    """Names and ctypes of the fields of a struct in ``runtime/FILE``, in order; ``pointer`` is the type of an address."""
    text = files("stribeck.codegen.runtime").joinpath(file).read_text(encoding="utf-8")
    (body,) = re.findall(rf"typedef struct {{([^}}]*)}} {struct};", text)
    fields: list[tuple[str, type]] = []
    for line in re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL).split(";"):
        kind, _, names = line.replace("const ", "").strip().partition(" ")
        fields += [(name.strip(" *"), pointer if "*" in name else _TYPES[kind]) for name in names.split(",") if kind]
    return fields


def declare(
    library: CDLL, what: str, shared: type[Structure], size: str, calls: Mapping[str, tuple[type | None, list[type]]]
) -> None:
    """Say how the functions of a library are called, each with the type of its result and of its arguments.

    Raises:
        BuildError: it has no such functions, or its function ``size`` gives the struct ``shared`` another size.
    """
    try:
        for name, (result, arguments) in {size: (c_int64, list[type]()), **calls}.items():
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
    except AttributeError:
        raise BuildError(f"the library built is not {what}") from None
    if getattr(library, size)() != sizeof(shared):
        raise BuildError("the compiled system was built for another version of Stribeck")
