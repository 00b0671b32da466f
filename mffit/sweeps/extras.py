"""Libraries that only some file formats need: imported when such a file comes."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from mffit.errors import InputError


def needed(module: str, what: str, path: Path) -> Any:
    """The module, or a sentence that says how to get it."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise InputError(
            f'{what} are read with {module}, which is not installed; run pip install "mffit[formats]"',
            file=path,
        ) from None
