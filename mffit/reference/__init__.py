"""Pages of the documentation that are written from records: ``python -m mffit.reference docs``."""

from __future__ import annotations

from pathlib import Path

from mffit.reference import constants, effects, rig_errors, suspicion


def pages() -> dict[str, str]:
    """Text of every generated page by its path below ``docs``."""
    return {
        **{f"effects/{name}": text for name, text in effects.pages().items()},
        "rig-errors.md": rig_errors.page(),
        "constants.md": constants.page(),
        "suspicion.md": suspicion.page(),
    }


def write(folder: Path) -> None:
    """Write all pages, and remove those of effects that no longer exist."""
    texts = pages()
    for path in (folder / "effects").glob("*.md"):
        if f"effects/{path.name}" not in texts:
            path.unlink()
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
