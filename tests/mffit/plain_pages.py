"""Reports for tests that read only their text."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from mffit.report.build import BUILD
from mffit.report.diagnosis import DIAGNOSIS
from mffit.report.drawing.records import Sheet

NONE = Sheet(rows=(), height=1.0)


@contextmanager
def without_pictures() -> Iterator[None]:
    """Every picture of a report is as one that has no panel: to draw them takes most of the time of a small build."""
    with pytest.MonkeyPatch.context() as patch:
        for table in (BUILD, DIAGNOSIS):
            for name in table:
                patch.setitem(table, name, lambda view: NONE)  # type: ignore[arg-type]
        yield
