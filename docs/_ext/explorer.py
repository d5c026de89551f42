"""The directive ``explorer``: a live page of ``stribeck explore`` within a page of the site.

Its argument is what follows ``stribeck explore``: a built-in example or a law, and options. A last word such as
``#law.parameters.F_s=1`` is the setting with which the page begins, as in a copied link.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import stribeck.examples

EXAMPLES = Path(stribeck.examples.__file__).parent


class Explorer(SphinxDirective):
    """``.. explorer:: stick_slip --law lugre``."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """What stands in its place."""
        words = shlex.split(self.arguments[0])
        start = words.pop() if words[-1].startswith("#") else ""
        if (example := EXAMPLES / f"{words[0]}.toml").is_file():
            words[0] = str(example)
        if find_spec("ziglang") is None or find_spec("bokeh") is None:
            return [nodes.paragraph("", "The live explorer needs the extra stribeck[plot] when the site is built.")]
        name = f"{Path(words[0]).stem}-{sha256(self.arguments[0].encode()).hexdigest()[:8]}.html"
        page = Path(self.env.app.outdir) / "explorers" / name
        if not page.is_file():
            page.parent.mkdir(parents=True, exist_ok=True)
            command = [sys.executable, "-m", "stribeck", "explore", *words, "--out", str(page)]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        up = "../" * self.env.docname.count("/")
        text = (
            f'<p><a href="{up}explorers/{name}{start}">Open the live explorer on a page of its own</a></p>\n'
            f'<iframe class="explorer" loading="lazy" title="live explorer" src="{up}explorers/{name}{start}"></iframe>'
        )
        return [nodes.raw("", text, format="html")]


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx of the directive."""
    app.add_directive("explorer", Explorer)
    return {"parallel_read_safe": True}
