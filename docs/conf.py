"""How Sphinx makes the documentation's site: ``make docs``."""

import sys
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))

from sphinx_gallery import backreferences  # noqa: E402

import stribeck  # noqa: E402

project = "Stribeck"
author = "the Stribeck developers"
copyright = "2026, " + author
version = release = stribeck.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "commands",
    "explorer",
    "evidence",
    "reference",
    "signatures",
]
exclude_patterns = ["_build", "gallery", "made/gallery/*.ipynb", "made/gallery/*.py", "**sg_execution_times.rst"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3
nitpicky = False

autodoc_member_order = "bysource"  # reference/python.md lists the members of each class
autodoc_typehints = "signature"
napoleon_attr_annotations = False
autodoc_class_signature = "mixed"

html_theme = "furo"
html_title = "Stribeck"
# MathJax in one file, from the package index: formulas are drawn where nothing can be fetched
mathjax_file = Path(find_spec("sphinx-mathjax-offline").origin).parent / "static" / "mathjax" / "tex-svg.js"
mathjax_path = mathjax_file.name
html_static_path = ["_static", str(mathjax_file)]
html_css_files = ["site.css"]
copybutton_prompt_text = r"\$ "

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "made/gallery",
    "filename_pattern": r"\.py",
    "within_subsection_order": "FileNameSortKey",
    "remove_config_comments": True,
    "show_memory": False,
    "write_computation_times": False,
    "show_signature": False,
    "min_reported_time": 1e9,
    "image_srcset": [],
    "abort_on_example_error": True,
    "download_all_examples": False,
    "capture_repr": (),
}
# sphinx-gallery leaves the text of a thumbnail empty: the example's title says what it shows
backreferences.THUMBNAIL_TEMPLATE = backreferences.THUMBNAIL_TEMPLATE.replace(":alt:\n", ":alt: {title}\n")
