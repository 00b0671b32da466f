"""Templates of pages and of texts for the terminal, with the words and the rounding that both share."""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING

from mffit import rounding
from mffit.constants import MOST_ROWS, NAMED_IN_SENTENCE
from mffit.errors import shortened
from mffit.points.left_out import together
from mffit.quantities import CHANNELS, COMPARED, CONDITIONS, DIRECT, OF_ROAD
from mffit.report import words
from mffit.report.text import layout
from mffit.rig_errors import meaning_of
from mffit.templates import environment
from mffit.viewer.bundle import script
from tir.errors import counted
from tir.parameters import BY_NAME

if TYPE_CHECKING:
    from jinja2 import Environment


@cache
def templates(*, escaped: bool) -> Environment:
    """Those of pages, whose content is escaped, or those of texts."""
    found = environment("mffit.report", "mffit.viewer", autoescape=escaped)
    found.filters |= {"shortened": shortened, "together": partial(together, most=int(NAMED_IN_SENTENCE))}
    found.filters |= {"counted": counted, "columns": layout.columns}
    for name in ("number", "with_u", "stated", "as_good_as", "times", "per_cent"):
        found.filters[name] = getattr(rounding, name)
    for name in ("paragraphs", "wrapped"):
        found.filters[name] = getattr(layout, name)
    found.globals |= {
        "channels": CHANNELS,
        "coefficients": BY_NAME,
        "compared": COMPARED,
        "of_road": OF_ROAD,
        "conditions": CONDITIONS,
        "direct": DIRECT,
        "meaning_of": meaning_of,
        "most": int(MOST_ROWS),
        "script": script,
        "words": words,
    }
    return found


def text(name: str, **content: object) -> str:
    """A text for the terminal, its parts with a blank line between them."""
    filled = templates(escaped=False).get_template(f"{name}.txt.j2").render(content)
    return layout.blocks(part.strip("\n") for part in layout.BLANK.split(filled))
