"""The generated pages of the documentation are those of the records."""

from __future__ import annotations

from pathlib import Path

from mffit import reference
from mffit.reference import write

DOCS = Path(__file__).parents[3] / "docs"


def read(path: Path) -> str:
    """The text of a page, empty if it was not written yet."""
    return path.read_text(encoding="utf-8") if path.exists() else ""


def test_the_pages_are_current():
    written = {name: read(DOCS / name) for name in reference.pages()}
    stale = sorted(name for name, page in reference.pages().items() if written[name] != page)
    assert not stale, (
        f"docs/{', docs/'.join(stale)} not as the records say; run: python -m mffit.reference docs"
    )


def test_the_pages_are_written_to_the_folder(tmp_path):
    write(tmp_path)
    assert {path.name: read(path) for path in tmp_path.iterdir()} == reference.pages()
