"""Sphinx configuration; tables of keys, variables and options are written from the code before each build."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from gallery_pictures import copy_scripts
from generate import write_tables
from linked import SHORT_NAMES, write_inventories

import gearidae

project = "gearidae"
author = "The gearidae authors"
copyright = "2026, the gearidae authors"  # noqa: A001
version = release = gearidae.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.intersphinx",
    "sphinx.ext.viewcode",
    "numpydoc",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "mathml",
]
html_math_renderer = "mathml"
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
exclude_patterns = ["_build", "**/generated/*.inc.md", "gallery/*.py", "gallery/*.ipynb"]
html_theme = "furo"
html_title = f"gearidae {release}"
autosummary_generate = True
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
intersphinx_mapping = write_inventories(Path(__file__).parent / "reference" / "generated")
numpydoc_xref_param_type = True
numpydoc_xref_aliases = SHORT_NAMES
numpydoc_xref_ignore = "all"  # but the aliases
copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = True  # of a block with prompts: what is printed stays
copybutton_remove_prompts = True
_HERE = Path(__file__).parent
sphinx_gallery_conf = {
    "examples_dirs": copy_scripts(_HERE.parent, _HERE / "_build"),
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",  # all of them run
    "image_scrapers": ("matplotlib", "gallery_pictures.pictures"),
    "abort_on_example_error": True,
    "show_signature": False,
    "write_computation_times": False,
}
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False
highlight_language = "none"


def setup(app: object) -> None:
    """Write the generated tables before anything is read."""
    write_tables(Path(__file__).parent / "reference" / "generated")
