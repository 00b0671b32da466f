"""Settings of every test."""

from __future__ import annotations

import gc
import os
from pathlib import Path
from typing import Any

# Before numpy is loaded: the matrices are small, and threads of several test processes only wait for each other.
for library in ("OPENBLAS", "OMP", "MKL"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
# Texts are as wide as where there is no terminal, whatever terminal the tests run in.
os.environ.pop("COLUMNS", None)

import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402

# How long an example takes says how busy the machine is, not whether the code is right.
settings.register_profile("mffit", deadline=None)
settings.load_profile("mffit")


def pytest_collection_finish() -> None:
    """Leave modules and collected tests out of garbage collections, which took an eighth of all time."""
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """One process runs all tests of a file, or of a folder whose files share fixtures: each campaign is built once, not in every
    process."""
    from xdist.scheduler import LoadScopeScheduling

    class ByWhatIsShared(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = Path(nodeid.partition("::")[0])
            shares = len(file.parts) > 3 and (config.rootpath / file.parent / "conftest.py").exists()
            return str(file.parent if shares else file)

    return ByWhatIsShared(config, log)
