"""What all pages have in common: head, style, policy, scripts, and the sections at their end."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files

import xarray as xr

from gearidae.archive.select import scene_of
from gearidae.archive.target import MADE_BY
from gearidae.report import html
from gearidae.report.tables import parameter_tables, provenance_list, validity_table

_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
"""What the browser may load for the page: nothing from anywhere."""


def page(ds: xr.Dataset, kind: str, sentence: str, sections: Sequence[str], scripts: Sequence[str]) -> str:
    """Put a page together from its own sections and those that all pages have.

    Parameters
    ----------
    ds : xarray.Dataset
        What the page is about.
    kind : str
        What the page is, for its title.
    sentence : str
        Below the heading.
    sections : sequence of str
        From `gearidae.report.html.section`, in their order.
    scripts : sequence of str
        Files of this package, in the order in which they run.
    """
    name = str(scene_of(ds).get("name", "gearidae"))
    common = (
        html.section("validity", "How far the model holds", validity_table(ds)),
        html.section("parameters", "Parameters", parameter_tables(ds)),
        html.section("provenance", "Provenance", provenance_list(ds)),
    )
    main = "\n".join(part for part in (*sections, *common) if part)
    script = "\n".join(_resource(file) for file in scripts)
    return f"""<!DOCTYPE html>
<!-- {MADE_BY} -->
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta http-equiv="Content-Security-Policy" content="{html.text(_POLICY)}">
<meta name="generator" content="gearidae {html.text(ds.attrs.get("product_version", ""))}">
<title>{html.text(name)}: {html.text(kind)}</title>
<style>
{_resource("page.css")}
</style>
</head>
<body>
<header>
<h1>{html.text(name.replace("_", " "))}</h1>
<p class="headline">{html.text(sentence)}</p>
{html.paragraph(ds.attrs.get("summary", ""), "summary")}
</header>
<main>
{main}
</main>
<script>
{script}
</script>
</body>
</html>
"""


def _resource(name: str) -> str:
    return (files("gearidae.report") / name).read_text(encoding="utf-8")
