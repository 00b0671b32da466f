"""What `import mffit` says where two distributions own the package tir."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def imported(folder: Path) -> str:
    """What Python says on importing mffit from a folder like that of installed packages."""
    command = [
        sys.executable,
        "-I",
        "-S",
        "-c",
        f"import sys; sys.path[:] = [{str(folder)!r}, *sys.path]; import mffit",
    ]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False).stderr


@pytest.fixture
def site(tmp_path) -> Path:
    for name in ("mffit", "tir"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_bytes(
            (ROOT / name / "__init__.py").read_bytes() * (name == "mffit")
        )
    return tmp_path


def test_mffit_alone_says_nothing(site):
    (site / "mffit-0.2.0.dist-info").mkdir()
    assert imported(site) == ""


def test_both_distributions_are_pointed_out(site):
    (site / "mffit_tir-0.2.0.dist-info").mkdir()
    assert (
        "removing one breaks the other: pip uninstall mffit-tir, then pip install --force-reinstall"
        in imported(site)
    )


@pytest.mark.parametrize("folder_stays", [True, False])
def test_a_removed_tir_is_one_sentence_with_the_remedy(site, folder_stays):
    (site / "tir" / "__init__.py").unlink()
    if not folder_stays:
        (site / "tir").rmdir()
    last = imported(site).splitlines()[-1]
    assert last.startswith("ImportError: the package tir is missing")
    assert last.endswith("pip install --force-reinstall --no-deps mffit")
