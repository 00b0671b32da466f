"""What a file says of its test in its own texts: title, and name of the tyre."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

TYRE_IN_TITLE = re.compile(
    r"\b(?:tyre|tire|reifen)(?:[ _]?(?:name|id))?\s*[:=]\s*(\S.*?)\s*(?=$|[;|]|\s[^\s:=]+\s*[:=](?:\s|$))",
    re.IGNORECASE,
)
"""The name of the tyre within a title, up to the title's next entry."""
SECTION_IN_TITLE = re.compile(r"\[[^\]]*\]")
"""The heading of a section in a text file, ``[DATA]``."""


def named_tyre(about: Mapping[str, str]) -> str:
    """The tyre that a recording names; from a title, only the text after the word tyre; "" without one."""
    if about.get("tireid"):
        return about["tireid"]
    found = TYRE_IN_TITLE.search(title_of(about))
    return found[1].strip() if found else ""


def title_of(about: Mapping[str, str]) -> str:
    """The title of a recording without the headings of its sections."""
    return SECTION_IN_TITLE.sub("", about.get("title", "")).strip()


def other_names(named: Mapping[Path, str]) -> list[str]:
    """A sentence if files name different tyres; ``named`` is the name in each, "" without one."""
    first: dict[str, Path] = {}
    for path, name in named.items():
        if name:
            first.setdefault("".join(name.lower().split()), path)
    if len(first) < 2:
        return []
    listed = ", ".join(f'"{named[path]}" ({path.name})' for path in first.values())
    return [
        f"the files name {len(first)} tyres: {listed}; make a project of each, unless these are names of one tyre"
    ]
