# SPDX-License-Identifier: MIT
"""The site of `make docs`: the pages of this folder, the API, the gallery and the verification pages."""

import hashlib
import re
import shutil
import sys
from pathlib import Path

from docutils.nodes import SkipNode
from docutils.utils.math.latex2mathml import tex2mathml
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "docs"), str(ROOT / "docs" / "tools")]

project = "samfem"
author = "the samfem authors"
copyright = author
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.githubpages",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "stories",
    "matplotlib.sphinxext.plot_directive",
]
exclude_patterns = ["_build", "gallery", "theory", "tools"]
default_role = "code"
nitpicky = True
nitpick_ignore_regex = [("py:.*", r"(?!samfem\.).*")]  # other libraries, and what is below samfem
autodoc_member_order = "bysource"

myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3

plot_formats = [("png", 120)]
plot_html_show_formats = False
plot_html_show_source_link = False

html_math_renderer = "mathml"
html_theme = "pydata_sphinx_theme"
html_title = "samfem"
html_show_sourcelink = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_sidebars = {
    "*": [],
    "api/*": [],
    "auto_gallery/*": [],
    "auto_gallery/*/*": [],
}  # pages without others below them
html_theme_options = {"header_links_before_dropdown": 6, "show_toc_level": 2}
copybutton_selector = "div:not(.output):not(.sphx-glr-script-out) > div.highlight > pre"

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "auto_gallery",
    "within_subsection_order": "FileNameSortKey",
    "filename_pattern": "/",  # all scripts run, whatever their name
    "abort_on_example_error": True,
    "show_memory": False,
    "image_scrapers": ("matplotlib", "conf.last_figure"),
    "min_reported_time": 5,
}

SOURCES = sorted(
    path
    for package in ("samfem", "sam", "fem_reference", "verification", "docs/gallery")
    for path in (ROOT / package).rglob("*.*")
    if path.suffix != ".pyc"
)
CODE = hashlib.sha256(b"".join(path.read_bytes() for path in SOURCES)).hexdigest()
"""Where it has changed, everything is run and drawn anew."""
SEEN = ROOT / "docs" / "_build" / "code"
LINK = re.compile(r"(!?\[(?:[^][]|\[[^]]*\])*\]\()([^)\s:#][^)\s:]*)\)")
INCLUDED = re.compile(r"^```\{include\} \.\./(\S+)\n```$", re.MULTILINE)


def link_in_site(match: re.Match) -> str:
    """A link between files of the repository as one between pages of the site."""
    start, target = match.groups()
    to_root, _, path = target.rpartition("../")
    if path.startswith("reports/") and not start.startswith("!"):
        page = path.removeprefix("reports/").replace("README.md", "index.html")
        return f'<a href="{to_root}verification/{page}">{start[1:-2]}</a>'
    inside = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md", "README.md": "index.md"}
    if path in inside:
        return f"{start}{to_root}{inside[path]})"
    gallery = re.fullmatch(r"((?:\.\./)?)(?:docs/)?gallery/(?:(\w+/\w+)\.py)?", target)
    return f"{start}{gallery[1]}auto_gallery/{gallery[2] or 'index'}.rst)" if gallery else match.group()


def as_page(app, name: str, source: list[str]) -> None:
    """A page with the files of the root that it includes, and with links that work in the site."""

    def included(match: re.Match) -> str:
        app.env.note_dependency(str(ROOT / match[1]))
        text = (ROOT / match[1]).read_text(encoding="utf-8")
        return LINK.sub(lambda link: f"{link[1]}{f'../{link[2]}'.removeprefix('../docs/')})", text)

    source[0] = LINK.sub(link_in_site, INCLUDED.sub(included, source[0]))


def as_written(app, what: str, *others: object) -> None:
    """A docstring in which |x| is an absolute value, and `a: b` of an attribute no type and description."""
    lines = others[-1]
    lines[:] = [line.replace("|", "\\|") for line in lines]
    if what in ("attribute", "data", "property"):
        lines.insert(0, "")


def last_figure(block, block_vars: dict, gallery_conf: dict) -> str:
    """A figure that is the value of the last line of a block, as of `run.plot()`, as a picture."""
    value = block_vars["example_globals"].get("___")
    if not isinstance(value, Figure):
        return ""
    path = next(block_vars["image_path_iterator"])
    value.savefig(path, dpi=120)
    return figure_rst([path], gallery_conf["src_dir"])


def finish(app, failed: Exception | None) -> None:
    """Put the published verification pages into the site, whose home is their home, and the scenes that they
    name.
    """
    site = Path(app.outdir) / "verification"
    if not failed:
        SEEN.write_text(CODE, encoding="utf-8")
        shutil.copytree(
            ROOT / "reports", site, ignore=shutil.ignore_patterns("latest*", "*.md"), dirs_exist_ok=True
        )
        for page in site.glob("*.html"):
            text = page.read_text(encoding="utf-8").replace('href="../README.md"', 'href="../index.html"')
            page.write_text(text, encoding="utf-8")
        shutil.copytree(ROOT / "verification" / "scenes", site / "scenes", dirs_exist_ok=True)


def inline_formula(translator, node) -> None:
    """A formula as MathML, which needs no script and no network."""
    translator.body.append(tex2mathml(node.astext()))
    raise SkipNode


def displayed_formula(translator, node) -> None:
    """A formula on a line of its own."""
    translator.body.append(
        f'<div class="formula" tabindex="0">{tex2mathml(node.astext(), as_block=True)}</div>'
    )
    raise SkipNode


def setup(app) -> None:
    """Called by Sphinx."""
    app.add_config_value("code", CODE, "env")
    if not SEEN.exists() or SEEN.read_text(encoding="utf-8") != CODE:
        for folder in ("auto_gallery", "_build/plot_directive"):
            shutil.rmtree(ROOT / "docs" / folder, ignore_errors=True)
    app.add_html_math_renderer("mathml", (inline_formula, None), (displayed_formula, None))
    app.connect("source-read", as_page)
    app.connect("autodoc-process-docstring", as_written, priority=100)  # before napoleon
    app.connect("build-finished", finish)
