"""Numbers and text of standard JSON, without NaN."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tir import Quantity


def text(content: Any) -> str:
    """A document as text; non-finite numbers become null."""
    return json.dumps(plain(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write(path: Path, content: Mapping[str, Any]) -> None:
    """Write a document as UTF-8."""
    path.write_text(text(content), encoding="utf-8")


def plain(value: Any) -> Any:
    """The value in types of standard JSON, null for NaN and infinity."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def picked(record: Any, *names: str) -> dict[str, Any]:
    """Some attributes of a record by their names."""
    return {name: getattr(record, name) for name in names}


def stated(key: str, number: Quantity | None, scale: float = 1.0) -> dict[str, float | None]:
    """A number under ``key`` and its standard uncertainty under ``u_`` + key, both times ``scale``."""
    if number is None:
        return {key: None, f"u_{key}": None}
    return {key: scale * number.value, f"u_{key}": scale * number.u}


def value_of(number: Quantity | None) -> dict[str, Any] | None:
    """A number and its standard uncertainty."""
    return None if number is None else {"value": number.value, "u": number.u}
