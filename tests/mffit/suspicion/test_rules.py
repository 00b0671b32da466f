"""The list of suspicions: named once, limited by records, documented."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from mffit import reference
from mffit.suspicion import RULES

DOCS = Path(__file__).parents[3] / "docs"


def test_every_rule_has_a_name_of_its_own():
    assert not [name for name, number in Counter(rule.id for rule in RULES).items() if number > 1]


def test_the_page_is_current():
    written = (DOCS / "suspicion.md").read_text(encoding="utf-8")
    assert written == reference.page("suspicion.md"), "run: python -m mffit.reference docs"
