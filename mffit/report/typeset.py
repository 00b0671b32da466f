"""Typography of a page: ASCII symbols of sentences, which terminal and JSON need, become HTML."""

import re
from collections.abc import Callable
from html import escape, unescape

from mffit.quantities import CHANNELS, CHARACTERISTICS, CONDITIONS, DIAGNOSED, DIRECT
from tir.parameters import BY_NAME

VERBATIM = frozenset({"code", "title"})
"""Elements whose text is not changed, nor that of class ``mono``."""
VOID = frozenset({"meta", "img", "br", "col", "input", "link", "hr"})
TAG = re.compile(r"(<script\b.*?</script>|<style\b.*?</style>|<[^>]*>)", re.DOTALL)
"""A tag, or a whole script or style element, in which ``<`` does not begin a tag."""
NAME = re.compile(r"</?([a-zA-Z][\w-]*)")
TABLE = re.compile(r"<table\b.*?</table>", re.DOTALL)
HEADING = re.compile(r"<th\b[^>]*>(.*?)</th>", re.DOTALL)
ROW = re.compile(r"<tr\b.*?</tr>", re.DOTALL)
CELL = re.compile(r'<td\b(?:[^>]*?colspan="(\d+)")?')
FEW_COLUMNS = 2
"""So many fit a telephone."""

SYMBOLS = {
    **{name: channel.html for name, channel in CHANNELS.items()},
    **{
        q.ascii: q.html
        for table in (CONDITIONS, DIRECT, CHARACTERISTICS, DIAGNOSED)
        for q in table.values()
        if len(q.ascii) > 1
    },
}
"""Symbols of quantities in HTML, by their ASCII form."""


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
    (re.compile(r"(?<=\d) (?=%)"), "\N{NO-BREAK SPACE}"),
    (re.compile(r"(?<![\w.-])[A-Za-z]\w+(?![\w(]|\.\w)"), _word),
)
"""Applied in this order to escaped text."""


def sentence(text: str) -> str:
    """Escaped text with its symbols, signs, file names and coefficients as HTML."""
    parts = [text]
    for pattern, shown in RULES:
        # Code elements are results of an earlier rule and are not changed again.
        parts = [
            piece if k % 2 else pattern.sub(shown, piece)
            for k, piece in enumerate(re.split(r"(<code>.*?</code>)", "".join(parts)))
        ]
    return "".join(parts)


def page(html: str) -> str:
    """The page, well-formed HTML with ``<`` and ``>`` escaped outside of tags, with its text typeset except for verbatim
    elements.
    """
    return TABLE.sub(_stacked, _typeset(html))


def _typeset(html: str) -> str:
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


def _stacked(table: re.Match[str]) -> str:
    """A table whose cells know their headings, for a telephone, on which a row of many columns becomes a paragraph."""
    labels = [escape(unescape(re.sub(r"<[^>]*>", "", text)).strip()) for text in HEADING.findall(table[0])]
    if len(labels) <= FEW_COLUMNS:
        return table[0]

    def row(found: re.Match[str]) -> str:
        place = 0

        def cell(start: re.Match[str]) -> str:
            nonlocal place
            label, place = labels[place], place + int(start[1] or 1)
            return f'{start[0]} data-label="{label}"' if label else start[0]

        return CELL.sub(cell, found[0])

    return ROW.sub(
        row, re.sub(r'<table(?: class="([^"]*)")?', r'<table class="stacked \1"', table[0], count=1)
    )
