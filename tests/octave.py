"""MATLAB code run in Octave; tests that need it are skipped if it is not installed."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat, savemat

OCTAVE = shutil.which("octave-cli")
needs_octave = pytest.mark.skipif(OCTAVE is None, reason="Octave is not installed")


def run(folder: Path, script: str, **given: Any) -> dict[str, Any]:
    """The variables after a script in a folder whose functions it calls; structures as dictionaries, sizes as in MATLAB."""
    savemat(folder / "given.mat", {key: np.asarray(value) for key, value in given.items()} | {"none": 0.0})
    (folder / "steps.m").write_text(f"load given.mat\n{script}\nsave -v7 found.mat\n", encoding="ascii")
    done = subprocess.run(
        [str(OCTAVE), "-q", "--no-init-file", "steps.m"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return {key: _plain(value) for key, value in loadmat(folder / "found.mat").items() if key[:2] != "__"}


def _plain(value: Any) -> Any:
    return value if value.dtype.names is None else {name: value[name][0, 0] for name in value.dtype.names}
