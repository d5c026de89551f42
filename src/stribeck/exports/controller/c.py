"""``--target c``: the block as C99, and a program that checks it."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files as resources

import numpy as np

from stribeck.codegen import SAME
from stribeck.exports.c.ccode import DIALECT, WORDS, CWriter, pair, render
from stribeck.exports.c.selftest import output_spread
from stribeck.exports.controller.block import Block
from stribeck.expressions.emit import C_FUNCTIONS, python_function
from stribeck.expressions.graph import ordered
from stribeck.machine.elements.controllers import Controller
from stribeck.machine.elements.dither import PHASE

_DIALECT = replace(DIALECT, functions={**DIALECT.functions, **SAME})
_TAKEN = WORDS | C_FUNCTIONS | frozenset(["p", "x", "in", "o", "next", "i", "t", "real", "R", "FN", "sign_of"])
_ROWS = 24  # random rows of the self-test: each input has both signs in some, except for 1 in 10^7 cases


def files(block: Block) -> dict[str, str | bytes]:
    """``NAME.h`` and ``NAME.c``, and ``NAME_test.c`` if requested."""
    values, name = context(block), block.name
    content: dict[str, str | bytes] = {**pair(name, "block", values)}
    if block.options.self_test:
        content[f"{name}_test.c"] = render("block_test.c", **values, rows=rows(block))
    return content


def context(block: Block) -> dict[str, object]:
    """Values for the templates."""
    used = {node.op for node in ordered(block.expressions.values())}
    portable = resources("stribeck.codegen.runtime").joinpath("portable.c").read_text(encoding="utf-8")
    return {
        "P": block.name, "b": block, "about": block.about(), "step_lines": _sample(block), "path_lines": _path(block),
        "portable": portable if used & set(SAME) else "", "sign": "sign" in used, "period": block.step or None,
    }  # fmt: skip


def _written(block: Block, wanted: list[tuple[str, str]], inputs: dict[str, str]) -> str:
    inputs = {**block.of_symbols(), **inputs}
    writer = CWriter(_DIALECT, inputs, taken=_TAKEN, names=block.called)
    return "\n".join(
        f"    {line}" for line in writer.write([(target, block.expressions[output]) for target, output in wanted])
    )


def _sample(block: Block) -> str:
    inputs = {f"input.{c.name}": f"in->{c.name}" for c in block.inputs}
    inputs |= {f"state.{c.name}": f"x->{c.name}" for c in block.states}
    wanted = [(f"o->{c.name}", c.name) for c in block.outputs]
    wanted += [(f"next->{c.name}", f"next.{c.name}") for c in block.states]
    return _written(block, wanted, inputs)


def _path(block: Block) -> str:
    wanted = [(f"in->{c.name}", f"path.{c.name}") for c in block.path_columns if f"path.{c.name}" in block.expressions]
    inputs = {f"segment.{block.controller.use.name}_{n}": f"pieces[i].{n}" for n in block.piece_fields} | {"t": "t"}
    return _written(block, wanted, inputs) if wanted else ""


def rows(block: Block) -> list[tuple[str, ...]]:
    """Rows for the self-test: inputs and states, then outputs and next states, each with its spread."""
    constants = {path: value for _, value, path in block.constants.values()}
    inputs = [f"input.{c.name}" for c in block.inputs] + [f"state.{c.name}" for c in block.states]
    wanted = [block.expressions[c.name] for c in block.outputs]
    wanted += [block.expressions[f"next.{c.name}"] for c in block.states]
    function = python_function([*constants, *inputs], [*wanted, *output_spread(wanted)])
    size, random, test_rows = sizes(block), np.random.default_rng(1), []
    for _ in range(_ROWS):
        x = [float(np.float32(size[name.partition(".")[2]] * random.uniform(-1, 1))) for name in inputs]
        x = [abs(round(v)) if name == "state.readings" else v for name, v in zip(inputs, x, strict=True)]
        with np.errstate(all="ignore"):
            out = [float(v) for v in function(*constants.values(), *x)]
        pairs = zip(out[: len(wanted)], out[len(wanted) :], strict=True)
        test_rows.append(tuple(repr(float(v)) for v in (*x, *(v for pair in pairs for v in pair))))
    return test_rows


def sizes(block: Block) -> dict[str, float]:
    """A natural size of each input and state."""
    machine = block.scenario.elements
    body_scales = machine.scales[machine.leader(block.controller.body).name]
    near = 10 * body_scales.length
    speed = 3 * body_scales.speed
    sampled = {
        "r": near, "y": near, "last": near, "filter_y": near, "r_rate": speed, "v": speed, "filter_v": speed,
        "r_second": 10 * speed, "readings": 3.0, "z_hat": body_scales.length, PHASE: 1.0,
    }  # fmt: skip
    numbers = machine.controllers[block.controller.name]
    assert isinstance(numbers, Controller)
    names = [s.name for s in numbers.form_states()]
    sizes = numbers.scales(body_scales.length, body_scales.force)
    natural = [sizes.get(n, body_scales.length) for n in names]
    return sampled | {n: 3 * x for n, x in zip(names, natural, strict=True)}
