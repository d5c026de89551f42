"""WebAssembly as bytes: functions under construction, and joining them with a module that imports them.

Joining needs no relocations. A module numbers its imports first, then its own functions. If every import k is replaced by
a function at place k of the code section, every index in the module's code stays valid.

The format: https://webassembly.github.io/spec/core/binary/
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import TypeVar

Entry = TypeVar("Entry")

I32, F64 = 0x7F, 0x7C
KIND = {"i": I32, "d": F64}
# The instructions of the expression graph's operations, on f64.
OPS = {
    "add": b"\xa0", "sub": b"\xa1", "mul": b"\xa2", "div": b"\xa3", "neg": b"\x9a", "abs": b"\x99", "sqrt": b"\x9f",
    "floor": b"\x9c", "lt": b"\x63", "le": b"\x65", "gt": b"\x64", "ge": b"\x66", "both": b"\x71", "either": b"\x72",
    "where": b"\x1b", "min": b"\xa4", "max": b"\xa5",
}  # fmt: skip
END, IF, EQUAL_I32, SUB_I32 = b"\x0b", b"\x04\x40", b"\x46", b"\x6b"
LOOP, AGAIN = b"\x03\x40", b"\x0d\x00"  # a loop, and a jump to its beginning if the number on the stack is not 0
TO_F64 = b"\xb7"  # of a signed i32


def leb(n: int) -> bytes:
    """An unsigned number (LEB128)."""
    out = bytearray()
    while n > 0x7F:
        out.append(n & 0x7F | 0x80)
        n >>= 7
    return bytes([*out, n])


def signed_leb(n: int) -> bytes:
    """A signed number (LEB128)."""
    out = bytearray()
    while not -64 <= n < 64:
        out.append(n & 0x7F | 0x80)
        n >>= 7
    return bytes([*out, n & 0x7F])


def vector(parts: Sequence[bytes]) -> bytes:
    """A list with its length."""
    return leb(len(parts)) + b"".join(parts)


def f64(x: float) -> bytes:
    """f64.const"""
    return b"\x44" + struct.pack("<d", x)


def integer(n: int) -> bytes:
    """i32.const"""
    return b"\x41" + signed_leb(n)


def get(index: int) -> bytes:
    """local.get"""
    return b"\x20" + leb(index)


def put(index: int) -> bytes:
    """local.set"""
    return b"\x21" + leb(index)


def tee(index: int) -> bytes:
    """local.tee: set, and keep the value on the stack."""
    return b"\x22" + leb(index)


def call(index: int) -> bytes:
    """A call of a function."""
    return b"\x10" + leb(index)


def address(pointer: int | None) -> bytes:
    """A pointer in a local; None: address 0."""
    return integer(0) if pointer is None else get(pointer)


def load(pointer: int | None, offset: int) -> bytes:
    """f64.load"""
    return address(pointer) + b"\x2b\x03" + leb(offset)


def store(pointer: int | None, offset: int, value: bytes) -> bytes:
    """f64.store of a value"""
    return address(pointer) + value + b"\x39\x03" + leb(offset)


@dataclass
class Function:
    """A function under construction; its parameters are its first locals.

    Args:
        parameters: a letter for each parameter: ``i`` (i32, also pointers) or ``d`` (f64).
        result: a letter, or empty without a result.
        code: the instructions.
        locals: the types of the local variables.
    """

    parameters: str
    result: str = ""
    code: bytearray = field(default_factory=bytearray)
    locals: list[int] = field(default_factory=list)

    def local(self, kind: int = F64) -> int:
        """Declare a local variable and return its index."""
        self.locals.append(kind)
        return len(self.parameters) + len(self.locals) - 1

    def type(self) -> bytes:
        """The function's entry in the type section."""
        return (
            b"\x60"
            + vector([bytes([KIND[k]]) for k in self.parameters])
            + vector([bytes([KIND[k]]) for k in self.result])
        )

    def body(self) -> bytes:
        """The function's entry in the code section."""
        groups = [(len(list(same)), kind) for kind, same in groupby(self.locals)]
        inside = vector([leb(n) + bytes([kind]) for n, kind in groups]) + bytes(self.code) + END
        return leb(len(inside)) + inside


class _Reader:
    def __init__(self, data: bytes) -> None:
        self.data, self.place = data, 0

    def leb(self) -> int:
        n = shift = 0
        while True:
            byte = self.data[self.place]
            self.place += 1
            n |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return n

    def take(self, n: int) -> bytes:
        self.place += n
        return self.data[self.place - n : self.place]

    def name(self) -> str:
        return self.take(self.leb()).decode()


_TYPES, _IMPORTS, _FUNCTIONS, _GLOBALS, _EXPORTS, _CODE = 1, 2, 3, 6, 7, 10  # numbers of sections


class Module:
    """A module that imports functions alone, parsed as far as joining needs it.

    Attributes:
        imports: names of the imported functions, in order.
        exported: index of each exported function.
    """

    def __init__(self, data: bytes) -> None:
        reader = _Reader(data)
        reader.place = 8  # behind the mark and the version
        self._sections = list[tuple[int, bytes]]()  # number and content
        while reader.place < len(data):
            kind = reader.take(1)[0]
            self._sections.append((kind, reader.take(reader.leb())))
        self._by_kind = dict(self._sections)
        self.imports = self._entries(_IMPORTS, _import)
        self._exports = self._entries(_EXPORTS, lambda r: (r.name(), r.take(1)[0], r.leb()))
        self.exported = {name: index for name, kind, index in self._exports if kind == 0}

    def _entries(self, section: int, read: Callable[[_Reader], Entry]) -> list[Entry]:
        """The entries of a section's list."""
        reader = _Reader(self._by_kind[section])
        return [read(reader) for _ in range(reader.leb())]

    def constant(self, name: str) -> int:
        """The value of an exported global; all of them are addresses, hence i32 and not negative."""
        (index,) = (index for exported, kind, index in self._exports if (exported, kind) == (name, 3))
        return self._entries(_GLOBALS, _global)[index]

    def _with(self, section: int, before: Sequence[bytes], after: Sequence[bytes]) -> bytes:
        """A section's list with further entries."""
        reader = _Reader(self._by_kind[section])
        count = reader.leb() + len(before) + len(after)
        return leb(count) + b"".join(before) + self._by_kind[section][reader.place :] + b"".join(after)

    def joined(self, functions: Mapping[str, Function], added: Mapping[str, Function]) -> bytes:
        """This module with its imports replaced by ``functions``, and with further exported functions ``added``."""
        begin, end = [functions[name] for name in self.imports], list(added.values())
        types_before, own = (_Reader(self._by_kind[section]).leb() for section in (_TYPES, _FUNCTIONS))
        types = list(dict.fromkeys(f.type() for f in (*begin, *end)))
        first = len(begin) + own  # the index of the first added function
        exports = [leb(len(n.encode())) + n.encode() + b"\0" + leb(first + i) for i, n in enumerate(added)]
        indices = [[leb(types_before + types.index(f.type())) for f in part] for part in (begin, end)]
        new = {
            _TYPES: self._with(_TYPES, [], types),
            _FUNCTIONS: self._with(_FUNCTIONS, *indices),
            _EXPORTS: self._with(_EXPORTS, [], exports),
            _CODE: self._with(_CODE, [f.body() for f in begin], [f.body() for f in end]),
        }
        parts = [(kind, new.get(kind, content)) for kind, content in self._sections if kind != _IMPORTS]
        return b"\0asm\1\0\0\0" + b"".join(bytes([kind]) + leb(len(x)) + x for kind, x in parts)


def _import(r: _Reader) -> str:
    """The name of an imported function."""
    r.name()  # of its module
    name = r.name()
    r.take(1)  # a function
    r.leb()  # its type
    return name


def _global(r: _Reader) -> int:
    """The initial value of a global."""
    r.take(3)  # type, mutability, i32.const
    value = r.leb()
    r.take(1)  # the end of the expression
    return value
