"""How Sphinx makes the documentation. tools/site lays out the source beside this file and starts it."""

import logging
import os
import sys

sys.path.insert(0, os.path.abspath("."))
import links  # noqa: E402  the file beside this one

project = "Pliant"
author = "The Pliant authors"
copyright = "The Pliant authors"  # noqa: A001  Sphinx asks for this name
version = release = os.environ["PLIANT_VERSION"]
html_title = "Pliant " + version

extensions = ["myst_parser", "breathe"]
if os.environ.get("PLIANT_PYTHON_MODULE"):
    sys.path.insert(0, os.environ["PLIANT_PYTHON_MODULE"])
    extensions += ["sphinx.ext.autodoc", "sphinx.ext.napoleon"]
    autodoc_member_order = "bysource"
    autodoc_typehints = "signature"

myst_heading_anchors = 4
highlight_language = "text"
smartquotes = False  # --option is no dash
templates_path = ["_templates"]
exclude_patterns = ["docs/README.md"]

breathe_projects = {"pliant": os.environ["PLIANT_API_XML"]}
breathe_default_project = "pliant"
breathe_default_members = ("members",)
cpp_index_common_prefix = ["pliant::"]

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["pliant.css"]
html_show_sourcelink = False
html_copy_source = False
html_show_sphinx = False
html_show_search_summary = False  # a browser does not fetch pages from a folder
html_domain_indices = False  # its page has a script inside
html_show_copyright = False
html_favicon = "_static/pliant.svg"
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1b6b4f", "color-brand-content": "#1b6b4f"},
    "dark_css_variables": {"color-brand-primary": "#7be0ad", "color-brand-content": "#7be0ad"},
}


def one_namespace(record):
    """Every header opens the namespace pliant, which is no second declaration of it."""
    return "'.. cpp:type:: pliant'" not in record.getMessage()


logging.getLogger("sphinx.sphinx.domains.cpp").addFilter(one_namespace)


def setup(app):
    """Links of the documents lead to pages of the site, or become plain text."""
    app.connect("source-read", links.adapt)
