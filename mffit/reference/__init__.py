"""Pages of the documentation that are written from records: ``python -m mffit.reference docs``."""

from __future__ import annotations

from pathlib import Path

from mffit.reference import effects, rig_errors, suspicion


def pages() -> dict[str, str]:
    """Text of every generated page by its path below ``docs``."""
    return {
        "effects.md": effects.page(),
        "rig-errors.md": rig_errors.page(),
        "suspicion.md": suspicion.page(),
    }


def write(folder: Path) -> None:
    """Write all pages."""
    for name, text in pages().items():
        (folder / name).write_text(text, encoding="utf-8")
