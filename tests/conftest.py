"""Settings of every test."""

from __future__ import annotations

import gc
import os

# Before numpy is loaded: the matrices are small, and threads of several test processes only wait for each other.
for library in ("OPENBLAS", "OMP", "MKL"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

from hypothesis import settings  # noqa: E402

# How long an example takes says how busy the machine is, not whether the code is right.
settings.register_profile("mffit", deadline=None)
settings.load_profile("mffit")


def pytest_collection_finish() -> None:
    """Leave modules and collected tests out of garbage collections, which took an eighth of all time."""
    gc.freeze()
    gc.set_threshold(10_000, 20, 20)
