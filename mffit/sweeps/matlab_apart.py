"""MATLAB files of v4 to v7, read in a process of their own: scipy's reader may crash the process on a damaged file.

``python -P matlab_apart.py FILE OUT MOST`` imports nothing of mffit. It writes numbers and texts of the file to the folder OUT
for :func:`mffit.sweeps.matlab.read_mat`, or the reason why it cannot be read to OUT/trouble.txt.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np

LARGEST_TEXT = 10_000  # letters; not a record of constants.py, which this module must not import
TROUBLE, TEXTS, SIZE = "trouble.txt", "texts.json", "size.txt"


def load(path: Path) -> dict[str, Any]:
    """Column vectors (n,), texts, and the names and units of the structure ``channel``."""
    import scipy.io

    loaded = scipy.io.loadmat(path, chars_as_strings=True)
    content: dict[str, Any] = {}
    for name, value in loaded.items():
        if name.startswith("__") or not isinstance(value, np.ndarray):
            continue
        if value.dtype.names and {"name", "units"} <= set(value.dtype.names) and value.size == 1:
            entry = value.reshape(-1)[0]
            content[name] = {key: _texts(entry[key]) for key in ("name", "units")}
        elif value.dtype.kind == "U" and value.size == 1:
            content[name] = str(value.reshape(-1)[0])[:LARGEST_TEXT].strip()
        elif value.dtype.kind in "fiub" and value.size > 1 and value.size == max(value.shape):
            content[name] = value.reshape(-1).astype(float, copy=False)
    return content


def _texts(cells: Any) -> list[str]:
    """The texts of a cell array, one level deep."""
    found = []
    for cell in np.asarray(cells, dtype=object).reshape(-1):
        flat = np.asarray(cell).reshape(-1)
        found.append(str(flat[0]).strip() if flat.size else "")
    return found


def main(source: str, out: str, most: str) -> None:
    """Load the file and write its vectors as ``0.npy``, ``1.npy`` ..., in the order of ``texts.json``.

    A file with more than ``most`` numbers is not loaded; their number is written to ``size.txt``.
    """
    import scipy.io

    folder = Path(out)
    try:
        numbers = sum(math.prod(shape) for _, shape, _ in scipy.io.whosmat(source))
        if numbers > int(most):
            (folder / SIZE).write_text(str(numbers), encoding="utf-8")
            return
        content = load(Path(source))
        for k, value in enumerate(content.values()):
            if isinstance(value, np.ndarray):
                np.save(folder / f"{k}.npy", value, allow_pickle=False)
        texts = {n: None if isinstance(v, np.ndarray) else v for n, v in content.items()}
        (folder / TEXTS).write_text(json.dumps(texts), encoding="utf-8")
    except Exception as error:  # scipy fails on a damaged file in countless ways
        reason = str(error) or type(error).__name__
        (folder / TROUBLE).write_text(reason, encoding="utf-8", errors="replace")


if __name__ == "__main__":
    main(*sys.argv[1:4])
