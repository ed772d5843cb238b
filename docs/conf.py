"""How the documentation is built; `python scripts/build_docs.py` runs it."""

import os
import sys
import warnings
from pathlib import Path

import harmface

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS))

project = "harmface"
author = "The harmface authors"
copyright = "The harmface authors"
version = release = harmface.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "mathml",
    "sphinx.ext.intersphinx",
    "numpydoc",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build", "examples", "gallery/*.ipynb", "gallery/*.py", "gallery/*.md5"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
root_doc = "index"

# Links into other projects need the network, which builds do without unless it is asked for.
intersphinx_mapping = (
    {
        "python": ("https://docs.python.org/3", None),
        "numpy": ("https://numpy.org/doc/stable", None),
        "scipy": ("https://docs.scipy.org/doc/scipy", None),
        "sklearn": ("https://scikit-learn.org/stable", None),
    }
    if os.environ.get("HARMFACE_DOCS_ONLINE")
    else {}
)

# Sources are listed whole; most are cited where a module begins.
suppress_warnings = ["ref.citation"]
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "gallery",
    "image_scrapers": ("gallery_figures.figures",),
    "within_subsection_order": "FileNameSortKey",
    "reset_modules": (),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_memory": False,
    "capture_repr": (),
    "plot_gallery": "True",
}

html_math_renderer = "mathml"
html_theme = "pydata_sphinx_theme"
html_title = "harmface"
html_theme_options = {
    "show_prev_next": False,
    "navigation_with_keys": False,
    "navbar_align": "left",
    "header_links_before_dropdown": 4,
    "secondary_sidebar_items": ["page-toc"],
}
html_sidebars = {"*": [], "methods/*": []}
html_show_sourcelink = False

warnings.filterwarnings("ignore", module="sphinx_gallery")
