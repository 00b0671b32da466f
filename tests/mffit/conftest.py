"""A disc rig in a folder, for tests that start from files."""

from __future__ import annotations

from pathlib import Path

import pytest
from disc_project import Project, disc_project


@pytest.fixture
def project(tmp_path: Path) -> Project:
    """A healthy campaign on a disc, ISO axes, not yet written."""
    return disc_project(tmp_path / "rig")
