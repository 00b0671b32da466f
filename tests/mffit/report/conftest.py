"""One build for all tests that only look at it."""

from __future__ import annotations

import pytest
from report_toys import made_result

from mffit.pipeline import Result


@pytest.fixture(scope="session")
def result() -> Result:
    """A build on a rotating disc."""
    return made_result()
