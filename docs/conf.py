"""Sphinx configuration of the manual: `make docs` builds it into build/docs, without a network."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = "rockpulse"
author = "The rockpulse developers"
copyright = "The rockpulse developers"

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc", "command_help", "mathml", "object_card", "vertical_bars"]
exclude_patterns = ["extensions"]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_dmath_double_inline = False
myst_heading_anchors = 3

toc_object_entries = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say type, shape and unit
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

html_math_renderer = "mathml"
html_theme = "alabaster"
html_title = "rockpulse"
html_copy_source = False
html_show_sourcelink = False
html_static_path = ["static"]
html_css_files = ["manual.css"]
html_theme_options = {
    "description": "Will it topple? From strong-motion files to the overturning safety of rigid blocks.",
    "page_width": "78rem",
    "sidebar_width": "15rem",
    "fixed_sidebar": True,
    "show_powered_by": False,
    "font_family": "system-ui, 'DejaVu Sans', sans-serif",
    "head_font_family": "system-ui, 'DejaVu Sans', sans-serif",
}
html_sidebars = {"**": ["about.html", "navigation.html", "searchbox.html"]}
