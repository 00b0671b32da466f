"""Symbols in a page: what sentences write in ASCII, as terminal and JSON need it, becomes what a page shows."""

from __future__ import annotations

import re
from collections.abc import Callable

from mffit.quantities import CHANNELS, COMPARED, CONDITIONS, DIAGNOSED, DIRECT
from tir.parameters import BY_NAME

VERBATIM = frozenset({"code", "svg", "title"})
"""Elements whose text stays as it is; so does that of class ``mono``."""
VOID = frozenset({"meta", "img", "br", "col", "input", "link", "hr"})
TAG = re.compile(r"(<script\b.*?</script>|<style\b.*?</style>|<[^>]*>)", re.DOTALL)
"""A tag, or the whole of an element in which ``<`` is no tag."""
NAME = re.compile(r"</?([a-zA-Z][\w-]*)")

SYMBOLS = {
    **{name: channel.html for name, channel in CHANNELS.items()},
    **{
        q.ascii: q.html
        for table in (CONDITIONS, DIRECT, COMPARED, DIAGNOSED)
        for q in table.values()
        if len(q.ascii) > 1
    },
}
"""The symbols of the quantities as sentences write them, and as a page shows them."""


def _word(match: re.Match[str]) -> str:
    word = match[0]
    if word in SYMBOLS:
        return SYMBOLS[word]
    return f'<span class="mono">{word}</span>' if word in BY_NAME else word


RULES: tuple[tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]], ...] = (
    (re.compile(r"(?<![\w/])[\w-]+(?:\.[\w-]+)*\.(?:tir|toml|json|csv|html)\b"), r"<code>\g<0></code>"),
    (re.compile(r"\+-"), "±"),
    (re.compile(r"(?<![\w.)\]-])-(?=\d)"), "−"),
    (re.compile(r"(?<=\d) deg\b"), "°"),
    (re.compile(r"\bdegC\b"), "°C"),
    (re.compile(r"(?<![\w.-])[A-Za-z]\w+(?![\w(]|\.\w)"), _word),
)
"""In this order, on escaped text."""


def sentence(text: str) -> str:
    """Escaped text with its symbols, signs, file names and coefficients as HTML."""
    parts = [text]
    for pattern, shown in RULES:
        # What an earlier rule made is a tag and its text: left alone.
        parts = [
            piece if k % 2 else pattern.sub(shown, piece)
            for k, piece in enumerate(re.split(r"(<code>.*?</code>)", "".join(parts)))
        ]
    return "".join(parts)


def page(html: str) -> str:
    """All text of a page, but for what is verbatim.

    Parameters
    ----------
    html : well-formed, with every ``<`` and ``>`` outside of tags escaped
    """
    out: list[str] = []
    open_tags: list[bool] = []  # whether each is verbatim
    for piece in TAG.split(html):
        if not piece.startswith("<"):
            out.append(piece if any(open_tags) else sentence(piece))
            continue
        out.append(piece)
        name = NAME.match(piece)
        if name is None or name[1] in VOID or piece.endswith(("/>", "</script>", "</style>")):
            continue
        if piece.startswith("</"):
            open_tags.pop()
        else:
            open_tags.append(name[1] in VERBATIM or re.search(r'class="[^"]*\bmono\b', piece) is not None)
    return "".join(out)
