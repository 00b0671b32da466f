"""Sphinx configuration: ``sphinx-build -W docs build/docs`` makes the site. The pages are readable as Markdown without it."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parent)]

import mffit  # noqa: E402

project = "mffit"
author = "the mffit project"
release = version = mffit.__version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sitepages", "samplepages"]
exclude_patterns = ["examples"]
html_math_renderer = "mathml"
html_theme = "furo"
html_title = f"mffit {mffit.__version__}"
html_show_copyright = False
html_theme_options = {"navigation_with_keys": True}

nb_execution_mode = "force"  # notebooks are stored without outputs; -D nb_execution_mode=off leaves them so
nb_execution_timeout = 300
nb_execution_raise_on_error = True
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # a page may skip heading levels

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
napoleon_google_docstring = False
napoleon_use_rtype = False
