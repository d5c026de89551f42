"""Directives for the reference, each made from the code: ``laws``, ``parameter-sets``, ``tables PART`` and ``defaults``."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import typer
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from stribeck.cli.app import app as commands
from stribeck.laws import library as shelf
from stribeck.scenario.schema import json_schema

Entry = dict[str, Any]  # a node of the JSON Schema


def row(*cells: object) -> str:
    """A line of a table."""
    return "| " + " | ".join(str(x).replace("|", "\\|").replace("\n", " ") for x in cells) + " |"


def table(head: tuple[str, ...], rows: list[tuple[object, ...]]) -> str:
    """A table, or nothing without rows."""
    return "\n".join([row(*head), row(*["---"] * len(head)), *(row(*r) for r in rows), ""]) + "\n" if rows else ""


def literal(text: str) -> str:
    """A help text with its options as code, in which no dash is joined."""
    return re.sub(r"(?<![\w`-])--\w[\w-]*", r"`\g<0>`", text)


STATED = re.compile(r"(?:^|[;,] )([^;,]+(?:, or [^;,]+,)?) unless given")  # a default that a meaning states
NONE = "none"


def default_of(meaning: str, default: object, required: bool = False) -> tuple[str, str]:
    """A meaning without the default that it states, and the default as a file writes it."""
    stated = STATED.search(meaning)
    if stated:
        meaning = meaning[: stated.start()] + meaning[stated.end() :]
    if required:
        return meaning, "required"
    if default in (None, "", [], {}, ()):
        return meaning, stated[1].rstrip(",") if stated else NONE
    if isinstance(default, bool):
        return meaning, str(default).lower()
    if isinstance(default, int | float):
        return meaning, re.sub(r"e([+-])0*", lambda m: "e" + m[1].strip("+"), f"{default:g}")
    return meaning, str(default)


# -- laws --------------------------------------------------------------------------------------------------------------


def claim(value: object) -> str:
    """A guarantee in words."""
    if isinstance(value, dict):
        return f"if ${value['if']['latex']}$"
    return {True: "yes", False: "no"}.get(value, str(value)) if isinstance(value, bool) else str(value)


def laws() -> Iterator[str]:
    """Each law: its figure, equations, guarantees, constants and source."""
    found = shelf.library().laws
    for name, each in found.items():
        law: Any = shelf.described(each, name)
        yield f"## `{name}`\n\n{law['summary'].replace('|', chr(92) + '|')}\n\n"
        yield f"![{name} in five experiments](../pictures/laws/{name}.svg)\n\n"
        lines = " \\\\\n".join(e["latex"].replace("=", "&=", 1) for e in law["equations"])
        yield f"$$\n\\begin{{aligned}}\n{lines}\n\\end{{aligned}}\n$$\n\n"
        if law["has_z"]:
            yield table(("property", "guaranteed"), [(n, claim(x)) for n, x in law["guarantees"].items()]) + "\n"
        yield table(
            ("constant", "unit", "meaning", "allowed", "default"),
            [
                (f"`{n}`", p["unit"], meaning, p["allowed"].removeprefix("a finite number "), default)
                for n, p in law["parameters"].items()
                for meaning, default in [default_of(p["meaning"], p["default"], p["required"])]
            ],
        )
        yield f"\nSource: {law['source']}\n\n"


def parameter_sets() -> Iterator[str]:
    """Built-in parameters and machines, with their sources."""
    found = shelf.library()
    yield table(
        ("set", "what", "source"), [(f"`{s.name}`", f"{s.title} ({s.motion})", s.source) for s in found.sets.values()]
    )
    yield "\n" + table(
        ("machine", "what", "license"),
        [(f"`{m.name}`", f"{m.title} ({m.origin})", m.license) for m in found.machines.values()],
    )


# -- tables of a file ----------------------------------------------------------------------------------------------------


@cache
def whole() -> Entry:
    """The JSON Schema that 'stribeck new --schema' writes."""
    return json_schema()


def resolved(node: Entry) -> Entry:
    """A node with its reference followed."""
    if "$ref" in node:
        return {**whole()["$defs"][node["$ref"].rsplit("/", 1)[1]], **{k: x for k, x in node.items() if k != "$ref"}}
    return node


def limits(node: Entry) -> str:
    """What a value may be."""
    node = resolved(node)
    if "const" in node:
        return f"`{node['const']}`"
    if "enum" in node:
        return ", ".join(f"`{x}`" for x in node["enum"])
    words = {"exclusiveMinimum": "> {:g}", "minimum": ">= {:g}", "exclusiveMaximum": "< {:g}", "maximum": "<= {:g}"}
    bounds = " and ".join(text.format(node[key]) for key, text in words.items() if key in node)
    if "anyOf" in node or "oneOf" in node:
        kinds = {limits(x) for x in node.get("anyOf", node.get("oneOf", ())) if x.get("type") != "null"}
        return " or ".join(sorted(x for x in kinds if x)) if len(kinds) < 4 else "a table"
    kinds = {
        "object": "a table", "array": "a list", "string": "text", "boolean": "true or false", "number": "a number",
    }  # fmt: skip
    return bounds or kinds.get(node.get("type", ""), "")


def keys(node: Entry, path: str = "") -> list[tuple[object, ...]]:
    """The keys of a table: name, meaning, allowed, default."""
    rows: list[tuple[object, ...]] = []
    needed = node.get("required", ())
    for key, entry in node.get("properties", {}).items():
        if (key == "kind" and not path) or key == "folder" or (key == "name" and "description" not in resolved(entry)):
            continue
        each = resolved(entry)
        meaning = " ".join(str(each.get("description", "")).split())
        meaning, default = default_of(meaning, each.get("default"), key in needed)
        rows.append((f"`{path}{key}`", meaning, limits(entry), default))
        inner = {
            "": each,
            "[]": resolved(each.get("items", {})),
            ".NAME": resolved(each.get("additionalProperties") or {}),
        }
        for suffix, parts in inner.items():
            for x in (parts, *map(resolved, parts.get("anyOf", ()))):
                if x.get("properties") and key not in ("signal", "law", "parameters"):
                    rows += [r for r in keys(x, f"{path}{key}{suffix}.") if r not in rows]
    return rows


def kinds(node: Entry) -> list[Entry]:
    """The kinds of a family of tables, those of a user's file left out."""
    node = resolved(node)
    return [
        x
        for each in node.get("oneOf", node.get("anyOf", [node]))
        if "pattern" not in (x := resolved(each)).get("properties", {}).get("kind", {}) and "properties" in x
    ]


def kind_of(node: Entry) -> str:
    """The kind that a table has."""
    kind = node["properties"].get("kind", {})
    return str(kind.get("const", kind.get("default", "")))


def tables(part: str) -> Iterator[str]:
    """Every kind of table of a part of the file, with its keys."""
    definitions = whole()["$defs"]
    if part == "signals":
        families = {"signal": definitions["signal"]}
    elif part == "elements":
        properties = definitions["machine"]["properties"]
        families = {n: x["additionalProperties"] for n, x in properties.items() if x.get("additionalProperties")}
    else:
        families = {n: x for n, x in definitions["body"]["properties"].items() if n in (part.split(","))}
    for name, family in families.items():
        if part == "elements":
            yield f"## `[{name}.NAME]`\n\n"
        for each in kinds(family):
            kind = kind_of(each)
            if kind:
                yield f'**`kind = "{kind}"`**'
            about = str(each.get("description", "")).split("\n\n")[0]
            yield f" {' '.join(about.split())}\n\n" if kind else "\n\n"
            yield table(("key", "meaning", "allowed", "default"), keys(each)) + "\n"


# -- defaults ------------------------------------------------------------------------------------------------------------


def defaults() -> Iterator[str]:
    """One table of every default: of a file's keys, of laws' constants and of the commands' options."""
    rows: list[tuple[object, ...]] = []
    without = ("required", NONE)
    body = whole()["$defs"]["body"]["properties"]
    for part in ("solve", "output"):
        rows += [(f"`[{part}]` {r[0]}", *r[1:]) for r in keys(body[part]) if r[3] not in without]
    for name, node in whole()["$defs"]["machine"]["properties"].items():
        if node.get("additionalProperties"):
            for each in kinds(node["additionalProperties"]):
                place = f"`[{name}]` {kind_of(each)}".strip()
                rows += [(f"{place} {r[0]}", *r[1:]) for r in keys(each) if r[3] not in without]
    for each in kinds(whole()["$defs"]["signal"]):
        rows += [(f"signal {kind_of(each)} {r[0]}", *r[1:]) for r in keys(each) if r[3] not in without]
    for name, law in shelf.library().laws.items():
        described: Any = shelf.described(law, name)
        rows += [
            (f"law `{name}` `{n}`", meaning, p["allowed"].removeprefix("a finite number "), default)
            for n, p in described["parameters"].items()
            for meaning, default in [default_of(p["meaning"], p["default"], p["required"])]
            if default not in without
        ]
    for name, command in sorted(typer.main.get_command(commands).commands.items()):  # type: ignore[attr-defined]
        for p in command.params:
            words = f"`stribeck {name} {max(p.opts, key=len)}`"
            given = None if p.default is False or callable(p.default) else p.default
            meaning, default = default_of(getattr(p, "help", None) or "", given, p.required)
            if default not in without:
                rows.append((words, literal(meaning), "", default))
    yield table(("where", "meaning", "allowed", "default"), rows)


# -- the directives ------------------------------------------------------------------------------------------------------


class Made(SphinxDirective):
    """A directive whose Markdown a function makes."""

    optional_arguments = 1

    def run(self) -> list[nodes.Node]:
        """What stands in its place."""
        made = {"laws": laws, "parameter-sets": parameter_sets, "defaults": defaults}.get(self.name)
        text = "".join(made() if made else tables(self.arguments[0]))
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    for name in ("laws", "parameter-sets", "tables", "defaults"):
        app.add_directive(name, Made)
    return {"parallel_read_safe": True}
