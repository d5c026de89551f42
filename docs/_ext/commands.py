"""The directive ``commands``: the reference of every command, from the commands themselves; and options on one line."""

from __future__ import annotations

import re
import textwrap
from typing import Any

import typer
from docutils import nodes
from reference import NONE, STATED, default_of, literal
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from stribeck.cli.app import app


def reference() -> dict[str, list[tuple[str, str]]]:
    """For each command its lines: (what one writes, what it means)."""
    group = typer.main.get_command(app)
    found: dict[str, list[tuple[str, str]]] = {}
    for name, command in sorted(group.commands.items()):
        lines = [("", " ".join(textwrap.dedent(command.help or "").split()))]
        for p in sorted(command.params, key=lambda p: p.param_type_name == "option"):  # arguments first, as in usage
            if getattr(p, "hidden", False) or p.name == "help":
                continue
            words = ", ".join((*p.opts, *p.secondary_opts)) if p.param_type_name == "option" else ""
            _, default = default_of(p.help or "", None if p.default is False or callable(p.default) else p.default)
            stated = "" if default == NONE or STATED.search(p.help or "") else f" Default: {default}."
            lines.append((f"{words} {p.metavar or ''}".strip(), f"{p.help or ''}{stated}"))
        lines.append(("example", command.epilog or ""))
        found[name] = lines
    return found


class Commands(SphinxDirective):
    """``{commands}``: a section for each command."""

    def run(self) -> list[nodes.Node]:
        """What stands in its place."""
        made: list[nodes.Node] = []
        for name, lines in reference().items():
            section = nodes.section(ids=[f"stribeck-{name}"], names=[f"stribeck {name}"])
            section += nodes.title("", f"stribeck {name}")
            section += self.parse_text_to_nodes(literal(lines[0][1]))
            items = nodes.definition_list()
            for words, meaning in lines[1:-1]:
                term = nodes.term("", "", nodes.literal("", words))
                items += nodes.definition_list_item(
                    "", term, nodes.definition("", *self.parse_text_to_nodes(literal(meaning)))
                )
            section += items
            if lines[-1][1]:
                example = lines[-1][1].removeprefix("Example:").strip()
                section += nodes.literal_block(example, example, language="sh")
            made.append(section)
        return made


def unbroken(html: str) -> str:
    """A page on which no line ends within an option: browsers break words after each hyphen."""
    span = '<span class="option">{}</span>'
    words = r"<[^>]*>|(?<![\w-])--[a-z][\w-]*"  # a tag as it stands, or an option
    return re.sub(words, lambda m: m[0] if m[0].startswith("<") else span.format(m[0]), html)


def keep_options(app: Sphinx, name: str, template: str, context: dict[str, Any], doctree: object) -> None:
    """Apply :func:`unbroken` to the page that Sphinx writes."""
    if "body" in context:
        context["body"] = unbroken(context["body"])


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx of the directive, and of what is done with each page."""
    app.add_directive("commands", Commands)
    app.connect("html-page-context", keep_options)
    return {"parallel_read_safe": True}
