"""One build for all tests that only look at it."""

from __future__ import annotations

import pytest
from report_toys import made_result

from mffit.results import BuildResult


@pytest.fixture(scope="session")
def result() -> BuildResult:
    """A build on a rotating disc."""
    return made_result()
