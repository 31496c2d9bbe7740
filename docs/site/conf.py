"""Settings of the site of the documents, for Sphinx. `make docs` runs it on a copy of the pages; see stage.py."""

import re
from pathlib import Path

import batten

project = "batten"
copyright = "the authors of batten, MIT licence"
release = version = batten.__version__

extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_copybutton",
    "sphinx_design",
]
# The first one is that of the pages of the reference, which autosummary writes.
source_suffix = {".rst": "restructuredtext", ".md": "myst-nb", ".py": "myst-nb"}
templates_path = ["_templates"]
exclude_patterns = ["_templates", "conf.py"]
# Shortened JSON is no JSON.
suppress_warnings = ["misc.highlighting_failure"]

# Pages
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
# Tutorials are Python scripts whose cells begin with `# %%`. A cell that fails stops the build.
nb_custom_formats = {".py": ["jupytext.reads", {"fmt": "py:percent"}]}
nb_execution_mode = "force"
nb_execution_timeout = 300
nb_execution_show_tb = True
nb_merge_streams = True

# Reference
autosummary_generate = True
autodoc_typehints = "none"
autodoc_member_order = "bysource"
numpydoc_show_class_members = False

# Look
html_theme = "pydata_sphinx_theme"
html_title = "batten"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_context = {"default_mode": "light"}
html_theme_options = {
    "navbar_align": "left",
    "header_links_before_dropdown": 8,
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": ["theme-version"],
    "logo": {"text": "batten"},
    "pygments_light_style": "tango",
}
html_sidebars = {"index": [], "gallery": []}


def plain_examples(app, what, name, obj, options, lines):
    """Names of C in double backquotes of docstrings stay as they are; an ellipsis in them too."""
    lines[:] = [re.sub(r"(?<!`)`(bat_\w+)`(?!`)", r"``\1``", line) for line in lines]


def card_pictures(app):
    """Pictures of the first page that no document has."""
    folder = Path(app.srcdir) / "docs/images"
    cube = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    fine = batten.refine_mesh(cube, quads, scheme="catmull-clark", levels=5)
    (folder / "decimation.png").write_bytes(batten.decimate(fine, vertices=150).mesh.picture(wires=True))
    (folder / "basis.svg").write_text(batten.analyze("four-point")._repr_svg_())


def setup(app):
    app.connect("builder-inited", card_pictures)
    app.connect("autodoc-process-docstring", plain_examples)
    return {"parallel_read_safe": True, "version": Path(__file__).name}
