"""The structs that Python shares with the compiled solvers: their fields are read from the C that declares them."""

from __future__ import annotations

import re
from ctypes import POINTER, c_double, c_int8, c_int32, c_int64
from importlib.resources import files

_TYPES: dict[str, tuple[type, type]] = {  # a number, and a pointer to such
    "double": (c_double, POINTER(c_double)), "int64_t": (c_int64, POINTER(c_int64)),
    "int32_t": (c_int32, POINTER(c_int32)), "int8_t": (c_int8, POINTER(c_int8)),
}  # fmt: skip


def struct_fields(file: str, struct: str) -> list[tuple[str, type]]:
    """Names and types of a struct in ``runtime/FILE``, in its order, for ctypes."""
    text = files("stribeck.runtime").joinpath(file).read_text(encoding="utf-8")
    (body,) = re.findall(rf"typedef struct {{([^}}]*)}} {struct};", text)
    found: list[tuple[str, type]] = []
    for line in re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL).split(";"):
        kind, _, names = line.replace("const ", "").strip().partition(" ")
        found += [(name.strip(" *"), _TYPES[kind]["*" in name]) for name in names.split(",") if kind]
    return found
