# Configuration of Sphinx for the site. tools/site/build stages its pages, and calls Doxygen first.
import logging
import os
import re

from sphinx.domains.cpp import ASTDeclaration, _max_id

root = os.environ["REHEARSE_SOURCE"]
with open(os.path.join(root, "CMakeLists.txt"), encoding="utf-8") as file:
    release = re.search(r"VERSION (\d+\.\d+\.\d+)", file.read()).group(1)

project = "Rehearse"
author = "the Rehearse authors"
copyright = "the Rehearse authors; MIT licence"
extensions = ["myst_parser", "sphinx_copybutton", "breathe"]
myst_heading_anchors = 6
myst_enable_extensions = ["deflist"]
highlight_language = "text"
smartquotes = False  # `--model` in a text is no dash
copybutton_prompt_text = "$ "
copybutton_selector = "div.highlight-console pre, div.highlight-sh pre, div.highlight-cpp pre, div.highlight-yaml pre"
breathe_projects = {"rehearse": os.environ["REHEARSE_DOXYGEN"]}
breathe_default_project = "rehearse"
cpp_id_attributes = ["REHEARSE_API"]
# links and names of types from outside of the documented headers
nitpicky = False

html_theme = "furo"
html_title = f"Rehearse {release}"
html_static_path = [os.path.join(root, "tools/site/static"), os.environ["REHEARSE_MADE"]]
html_css_files = ["style.css"]
html_show_sourcelink = False
html_copy_source = False
html_last_updated_fmt = None
html_theme_options = {"navigation_with_keys": True}
templates_path = []
exclude_patterns = []


class Namespaces(logging.Filter):
    """Leaves out the warning that a namespace is declared on several pages: every header opens it anew."""

    def filter(self, record):
        text = record.getMessage()
        return not ("Duplicate C++ declaration" in text and "Declaration is '.. cpp:type:: " in text)


logging.getLogger("sphinx.sphinx.domains.cpp").addFilter(Namespaces())


def newest_id(declaration):
    """The id of a declaration, computed once: Sphinx computes those of all overloads anew for each link."""
    if not hasattr(declaration, "newest_id"):
        declaration.newest_id = declaration.get_id(_max_id, True)
    return declaration.newest_id


ASTDeclaration.get_newest_id = newest_id
