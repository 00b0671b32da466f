"""A reader cannot return a table that later steps would misread."""

from __future__ import annotations

from pathlib import Path

import pytest

from mffit.errors import InputError
from mffit.sweeps.raw_table import RawTable


def table(headings=("a", "b"), cells=((1.0, 2.0), (3.0, 4.0)), lines=(2, 3)):
    return RawTable(
        headings=headings,
        units=("",) * len(headings),
        cells=cells,
        lines=lines,
        path=Path("run.new"),
        heading_line=1,
    )


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"cells": ((), ()), "lines": ()}, "run.new: has no rows"),
        ({"headings": (), "cells": ()}, "run.new: has no rows"),
        ({"headings": ("a", "a")}, "run.new:1: has a heading that is empty or appears twice"),
        ({"headings": ("a", "")}, "run.new:1: has a heading that is empty or appears twice"),
        ({"cells": ((1.0, 2.0), (3.0,))}, "column b: has 1 value for 2 rows"),
    ],
)
def test_a_table_without_one_value_per_row_and_heading_is_refused(wrong, said):
    assert len(table()) == 2
    with pytest.raises(InputError) as caught:
        table(**wrong)
    assert said in str(caught.value)
