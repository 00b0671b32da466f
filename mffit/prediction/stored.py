"""``prediction.json``: what ``mffit predict`` needs of a build, in its folder."""

from __future__ import annotations

import base64
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import tir
from mffit.errors import InputError
from mffit.linearised.components import Components
from mffit.linearised.inputs import Input
from mffit.linearised.smooth import Smooth
from mffit.prediction.predictor import MissedChannel, Predictor
from tir import Tyre

FILE = "prediction.json"
ABOUT = "What mffit predict needs; arrays are base64 of little-endian numbers, row after row."


def write(path: Path, found: Predictor, file: str, fitted: str) -> None:
    """Write what is known; ``file`` is the plain property file in the same folder, ``fitted`` that of the fitted model."""
    content = {
        "about": ABOUT,
        "file": file,
        "fitted": fitted,
        "phi_t_per_m": found.path,
        "coefficients": found.names,
        "channels": {
            name: {
                "inputs": [asdict(one) for one in own.smooth.inputs],
                "orders": own.smooth.orders.tolist(),
                "components": asdict(own.components),
                "missed": own.missed.tolist(),
                "coefficients": len(own.root) - len(own.missed),
                "root": _text(own.root),
                "noise": own.noise,
                "size": own.size,
            }
            for name, own in found.channels.items()
        },
    }
    path.write_text(json.dumps(content) + "\n", encoding="utf-8")


def load(folder: Path) -> tuple[Predictor, Tyre, Tyre]:
    """What is known, the plain file and that of the fitted model, of the folder of a build.

    Raises
    ------
    InputError
        The folder is not that of a build that states what it knows.
    """
    path = folder / FILE
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        file, fitted = (tir.read(folder / str(content[key])) for key in ("file", "fitted"))
        return _predictor(content), file, fitted
    except FileNotFoundError:
        raise InputError(
            f"there is no {FILE} in {folder}; name the folder of a build, and build again if it is of an earlier version"
        ) from None
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        raise InputError(f"{path} cannot be used; build the tyre again") from None


def _predictor(content: dict[str, Any]) -> Predictor:
    return Predictor(
        path=float(content["phi_t_per_m"]),
        names=tuple(map(str, content["coefficients"])),
        channels={name: _channel(own) for name, own in content["channels"].items()},
    )


def _channel(own: dict[str, Any]) -> MissedChannel:
    inputs = tuple(Input(**{**one, "settings": tuple(one["settings"])}) for one in own["inputs"])
    orders = np.array(own["orders"], dtype=int).reshape(-1, len(inputs))
    components = Components(**{**own["components"], "lengths": tuple(own["components"]["lengths"])})
    return MissedChannel(
        smooth=Smooth(inputs, orders),
        components=components,
        missed=np.array(own["missed"], dtype=float),
        root=_array(own["root"], len(orders) + int(own["coefficients"])),
        noise=float(own["noise"]),
        size=float(own["size"]),
    )


def _text(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")


def _array(text: str, rows: int) -> np.ndarray:
    values = np.frombuffer(base64.b64decode(text), dtype="<f4").astype(float)
    return values.reshape(rows, -1) if rows else np.zeros((0, 0))
