"""Title of a test and name of its tyre, from the lines above the readings of a file or from a column."""

import re
import tomllib
from collections.abc import Mapping
from importlib import resources
from pathlib import Path

TYRE_IN_TITLE = re.compile(
    r"\b(?:tyre|tire|reifen)(?:[ _]?(?:name|id))?\s*[:=]\s*(\S.*?)\s*(?=$|[;|]|\s[^\s:=]+\s*[:=](?:\s|$))",
    re.IGNORECASE,
)
"""The name of the tyre within a title, up to the title's next entry."""
WORDS: dict[str, frozenset[str]] = {
    kind: frozenset(words)
    for kind, words in tomllib.loads(
        resources.files(__package__).joinpath("words.toml").read_text(encoding="utf-8")
    ).items()
}
"""Words of laboratories by kind; headings among them are :func:`simplified`."""
SPELLINGS = str.maketrans({" ": "_", "-": "_", "ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss"})
"""Characters that headings spell in several ways, and one spelling for each."""
SECTION_IN_TITLE = re.compile(r"\[[^\]]*\]")
"""The heading of a section in a text file, ``[DATA]``."""


def simplified(heading: str) -> str:
    """A heading or name without differences of case, blanks, hyphens and umlauts (``ae`` for ``ä``)."""
    return heading.lower().translate(SPELLINGS)


def names_tyre(heading: str) -> bool:
    """Whether a column of this heading names the tyre of each row."""
    return simplified(heading.strip()).rstrip(".") in WORDS["specimen"]


def named_tyre(about: Mapping[str, str]) -> str:
    """Name of the tyre in a recording, from a title only the text after the word tyre; "" if there is none."""
    if about.get("tireid"):
        return about["tireid"]
    found = TYRE_IN_TITLE.search(title_of(about))
    return found[1].strip() if found else ""


def title_of(about: Mapping[str, str]) -> str:
    """The title of a recording without the headings of its sections."""
    return SECTION_IN_TITLE.sub("", about.get("title", "")).strip()


def other_names(named: Mapping[Path, str]) -> list[str]:
    """A sentence if files name different tyres; ``named`` maps each file to the name in it, or to ""."""
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
