"""Entries of readings left out, as a page lists them."""

from __future__ import annotations

from mffit.points.left_out import LeftOut, together


def entry(line: int, **changes) -> LeftOut:
    given = {"file": "a.csv", "lines": str(line), "count": 1, "by": "rule", "rule": "outlying-reading"}
    return LeftOut(**given | {"channel": "Mz", "why": f"{line} Nm too much"} | changes)


def test_many_readings_of_one_rule_share_an_entry_with_all_lines():
    many = [entry(line) for line in (3, 9, 27, 81)]
    others = [entry(4, channel="Fy"), entry(5, file="b.csv"), entry(6, weight=0.3)]
    (one, *rest) = together([*many[:2], *others, *many[2:]], most=3)
    assert (one.lines, one.count, one.why) == ("3, 9, 27, 81", 4, "3 Nm too much; and 3 more like it")
    assert rest == others
    assert together(many, most=4) == many
