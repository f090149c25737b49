"""How `make docs` builds the site: the Markdown pages as they stand, the gallery, the notebooks and the reference.

The pages are plain Markdown, to be read on a code forge too. What only a site needs is added here while they are read:
the table of contents, the pages that lie above this folder, and the figures of the article.
"""

import builtins
import importlib.util
import re
import shutil
import sys
from importlib.metadata import version as version_of
from pathlib import Path

from sphinx.errors import ExtensionError
from sphinx_gallery.scrapers import figure_rst

from stribeck import asymptotics
from stribeck.figures import load_figure, make_figures

HERE = Path(__file__).parent
ROOT = HERE.parent
sys.path.insert(0, str(HERE))

import live_curve  # noqa: E402

CONTENTS = {
    "index": ["readers", "guide", "gallery/index", "theory", "numerics", "api", "about"],
    "readers": [
        "for_engineers",
        "for_experimentalists",
        "for_ball_on_disc",
        "for_theorists",
        "for_teachers",
        "for_developers",
        "when_not_to_use",
    ],
    "guide": [
        "cli",
        "data_sheet",
        "leakage",
        "strokes",
        "experiments",
        "checks",
        "alpha_beta",
        "troubleshooting",
        "explorer",
        "surfaces",
        "fluids",
        "bench",
        "fitting",
        "contact_laws",
        "sweep",
        "batch",
        "atlas",
    ],
    "theory": ["symbols", "validity", "figures", "errata"],
    "numerics": ["numerics_tables", "convergence"],
    "about": ["citing", "references", "generated/changelog", "generated/contributing"],
    "for_teachers": ["notebooks/paper_in_one_hour", "notebooks/topography_to_stribeck_curve", "notebooks/fitting"],
}
"""The pages below each page."""

ABOVE = {"CHANGELOG.md": "changelog", "CONTRIBUTING.md": "contributing"}
"""Pages that lie above this folder, and their names among what is generated."""

LIVE = r"""<div id="live-curve">

\1

</div>

<link rel="stylesheet" href="_static/chart.css">
<script defer src="_static/atlas_table.js"></script>
<script defer src="_static/chart.js"></script>
<script defer src="_static/live_curve.js"></script>

*Move the sliders: the [atlas](atlas.md) of solved states is evaluated in your browser, and friction is within 0.01 % of a
solve. The first contact is the [PDMS cylinder](../examples/pdms_cylinder.toml) of `make demo`, with a source for every value.*
"""
"""What the front page has in place of its picture, which stays where no script runs."""

project = "stribeck"
author = "The stribeck developers"
project_copyright = author
version = release = version_of("stribeck")

extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["*.py", "gallery/*.py", "gallery/*.ipynb", "notebooks/*.ipynb"]
templates_path = ["_templates"]
suppress_warnings = ["config.cache"]  # a function in the settings of the gallery cannot be kept between builds

myst_enable_extensions = ["dollarmath", "amsmath", "html_image"]
myst_heading_anchors = 3
nb_custom_formats = {".py": ["jupytext.reads", {"fmt": "py:percent"}]}
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

autosummary_generate = True
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings have the types, with shapes and units
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

html_theme = "pydata_sphinx_theme"
html_title = f"stribeck {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_sidebars = {"index": []}
html_context = {"default_mode": "auto"}
html_theme_options = {
    "logo": {"text": "stribeck"},
    "header_links_before_dropdown": 7,
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "secondary_sidebar_items": {"**": ["page-toc"], "errata": [], "validity": []},  # wide tables
    "show_prev_next": False,
    "footer_start": ["copyright"],
    "footer_end": [],
}

# MathJax out of a package of Python, beside the pages: no page asks another server for anything.
mathjax_path = "mathjax/tex-chtml-full.js"
MATHJAX = Path(importlib.util.find_spec("sphinx-mathjax-offline").origin).parent / "static" / "mathjax"


GALLERY = (
    "stribeck_curve one_state regimes_of_a_contact what_moves_the_minimum levers_of_a_seal seal_from_pressure "
    "friction_over_a_stroke surface_to_contact_law fit_measured_friction fit_a_ball transition_of_a_ball "
    "what_the_fluid_changes film_that_ends fluid_that_thins oil_that_stiffens flow_between_asperities rubber_on_a_base "
    "rubber_that_remembers both_surfaces_move two_laws_at_heavy_load formula_against_solver force_balance"
).split()
"""The examples in the order of the gallery; others come last."""


def in_order(name):
    """Return the place of an example in the gallery."""
    return GALLERY.index(Path(name).stem) if Path(name).stem in GALLERY else len(GALLERY)


def keep_pictures(block, block_vars, gallery_conf):
    """Move the pictures that an example has written beside itself into the gallery."""
    kept = []
    folder = Path(block_vars["src_file"]).parent
    for picture in sorted([*folder.glob("*.png"), *folder.glob("*.gif")]):
        kept.append(str(Path(block_vars["image_path_iterator"].next()).with_suffix(picture.suffix)))
        shutil.move(picture, kept[-1])
    return figure_rst(kept, gallery_conf["src_dir"])


def name_file(gallery_conf, source):
    """Let an example find the data beside it: it is run without a ``__file__`` of its own."""
    builtins.__file__ = str(source)


sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "copyfile_regex": r".*\.(toml|csv)$",
    "image_scrapers": (keep_pictures,),
    "within_subsection_order": in_order,
    "reset_modules": (name_file,),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "write_computation_times": False,
}


def prepare(app):
    """Make the figures of the article, and copy the pages that lie above this folder."""
    (HERE / "generated").mkdir(exist_ok=True)
    for made in make_figures(folder=HERE / "generated" / "figures"):
        if made.outcome not in ("solved", "reused"):
            raise ExtensionError(made.message)
    for name, page in ABOVE.items():
        text = (ROOT / name).read_text().replace("](docs/", "](../")
        (HERE / "generated" / f"{page}.md").write_text(text)


def complete(app, docname, content):
    """Add to a page what only the site needs, and turn its links to where the site has the same thing."""
    text = content[0]
    up = "../" * docname.count("/")
    for name, page in ABOVE.items():
        text = text.replace(f"](../{name}", f"]({up}generated/{page}.md")
    text = re.sub(r"\]\((?:\.\./)+examples/(\w+)\.py", rf"]({up}gallery/\1.rst", text)
    # Sources outside this folder are downloads: as links to pages they would be looked for among the notebooks.
    text = re.sub(r"\[`?([^\]`]+)`?\]\(((?:\.\./)+(?:tests|src|benchmarks)/[\w/]+\.py)\)", r"{download}`\1 <\2>`", text)
    text = text.replace("](../examples/README.rst)", f"]({up}gallery/index.rst)")
    if docname.startswith("gallery/"):
        text = re.sub(r"(?:docs/)?\b(\w+)\.md\b", r":doc:`/\1`", text)
    if docname == "figures":
        text += "\n".join(map(figure_entry, sorted((HERE / "generated" / "figures").glob("*.nc"), key=number_of)))
    if docname == "index":
        text, found = re.subn(r"(!\[[^\]]*\]\(images/curve\.png\))\s+\*.*?\*\n", LIVE, text, flags=re.DOTALL)
        if found != 1:
            raise ExtensionError("index.md has no picture for the live curve to replace")
    if docname in CONTENTS:
        below = "\n".join(CONTENTS[docname])
        text += f"\n```{{toctree}}\n:hidden:\n\n{below}\n```\n"
    content[0] = text


def number_of(path):
    """Return the place of a figure in the article."""
    name = path.stem.removeprefix("figure_")
    return (not name.isdecimal(), int(name.removeprefix("s")))


def figure_entry(path):
    """Return the section of a figure: what is claimed, what was found, the picture and its files."""
    import xarray

    figure = load_figure(path.stem.removeprefix("figure_").upper())
    with xarray.open_dataset(path) as data:
        finding = data.attrs["finding"]
    place = f"generated/figures/{path.stem}"
    return (
        f"\n## Figure {figure.name}: {figure.said['title']}\n\n![Figure {figure.name}]({place}.png)\n\n"
        f"*Claimed in [BP]:* {figure.said['claim']}\n\n*Found:* {finding}\n\n"
        f"[Data as NetCDF]({place}.nc) · [SVG]({place}.svg)\n"
    )


def finish(app, problem):
    """Put MathJax beside the pages, and refuse a page that would ask another server for anything."""
    if problem or app.builder.format != "html":
        return
    live_curve.write(Path(app.outdir) / "_static")
    to = Path(app.outdir) / "_static" / "mathjax"
    fonts = Path("output/chtml/fonts/woff-v2")
    shutil.copytree(MATHJAX / fonts, to / fonts, dirs_exist_ok=True)
    shutil.copy(MATHJAX / "tex-chtml-full.js", to)
    loaded = re.compile(r"<(?:script|img|iframe|source|video|audio)\b[^>]*\bsrc=\"(?:https?:)?//[^\"]*\"")
    linked = re.compile(r"<link\b[^>]*\bhref=\"(?:https?:)?//[^\"]*\"")
    for page in Path(app.outdir).rglob("*.html"):
        text = page.read_text()
        if found := loaded.search(text) or linked.search(text):
            raise ExtensionError(f"{page.name} would load something from another server: {found.group()}")


def show_formulas(app, env, docnames):
    """Put the functions in place of the formulas, which are objects, so that the reference shows them with their arguments."""
    for formula in asymptotics.FORMULAS:
        setattr(sys.modules[formula.function.__module__], formula.function.__name__, formula.function)


def hide_private(app, what, name, object_, options, signature, result):
    """Leave private fields out of the signature of a class."""
    return (re.sub(r", _\w+(=[^,)]*)?", "", signature), result) if signature else None


def setup(app):
    """Connect the functions above."""
    app.connect("builder-inited", prepare, priority=100)
    app.connect("autodoc-process-signature", hide_private)
    app.connect("env-before-read-docs", show_formulas)
    app.connect("source-read", complete)
    app.connect("build-finished", finish)
