"""Sphinx configuration of the documentation site, which `make docs` writes to out/docs."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = "rvmon"
author = "the rvmon maintainers"
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "made_pages",
]
exclude_patterns = ["extensions"]
html_theme = "furo"
html_title = "rvmon"
html_static_path = ["style"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
html_show_sourcelink = False

myst_heading_anchors = 4  # the same anchors as on code hosts
myst_enable_extensions = ["deflist"]
copybutton_prompt_text = "$ "
copybutton_line_continuation_character = "\\"

default_role = "literal"  # docstrings use single backticks for code
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_custom_sections = [("Source", "notes_style")]
