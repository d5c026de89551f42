"""``--target st``: the block as a function block in IEC 61131-3 Structured Text."""

from __future__ import annotations

from stribeck.errors import InputError
from stribeck.export.c.ccode import render
from stribeck.export.controller.block import Block
from stribeck.export.text.st import WORDS, StWriter, st_number, unspeakable
from stribeck.expressions.graph import ordered

_OWN = ("reset", "ok", "x")


def files(block: Block) -> dict[str, str | bytes]:
    """The function block, with the functions that it needs."""
    kept = {f"state.{c.name}": f"s_{c.name}" for c in block.states}
    called = {n: f"{n}_value" if n.lower() in WORDS else n for n in block.constants}  # LIMIT is a function
    symbols = {path: called[n] for n, (_, _, path) in block.constants.items()}
    inputs = {f"input.{c.name}": c.name for c in block.inputs} | kept | symbols
    names = [*_OWN, *(c.name for c in (*block.inputs, *block.outputs)), *kept.values(), *called.values()]
    lower = [name.lower() for name in names]  # the language knows no case
    if clash := sorted({name for name in names if lower.count(name.lower()) > 1 or unspeakable(name)}):
        raise InputError([f"{name}: a constant of this name cannot be exported to Structured Text" for name in clash])
    writer = StWriter(block.name, inputs, block.called)
    writer.taken.update(lower)
    wanted = [(f"n_{c.name}", block.expressions[f"next.{c.name}"]) for c in block.states]
    wanted += [(c.name, block.expressions[c.name]) for c in block.outputs]
    lines = [line.replace(" = ", " := ", 1) for line in writer.write(wanted)]
    used = {node.op for node in ordered(e for _, e in wanted)}
    text = render(
        "block.st", P=block.name, b=block, about=block.about(), lines=lines, variables=list(dict.fromkeys(writer.variables)),
        constants=[(called[n], st_number(value), c) for n, (c, value, _) in block.constants.items()], used=used,
    )  # fmt: skip
    return {f"{block.name}.st": text}
