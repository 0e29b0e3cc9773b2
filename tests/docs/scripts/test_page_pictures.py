"""Pictures of shipped cases: each is on a page, and its script draws it."""

from pathlib import Path

from matplotlib.figure import Figure

from gearidae_pages.page_pictures import PICTURES

DOCS = Path(__file__).parents[3] / "docs"


def test_each_picture_is_there_and_on_a_page():
    pages = "".join(page.read_text(encoding="utf-8") for page in DOCS.glob("*.md"))
    for name in PICTURES:
        assert (DOCS / "images" / f"{name}.png").exists()
        assert f"(images/{name}.png)" in pages


def test_no_picture_is_left_over():
    pages = "".join(page.read_text(encoding="utf-8") for page in DOCS.glob("*.md"))
    assert [path.name for path in (DOCS / "images").iterdir() if f"(images/{path.name})" not in pages] == []


def test_a_picture_is_drawn():
    assert isinstance(PICTURES["impact_forces"](), Figure)
