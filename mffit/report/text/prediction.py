"""What ``mffit predict`` prints."""

from pathlib import Path

import numpy as np
import pandas as pd

from mffit.constants import COVERAGE_FACTOR_95
from mffit.prediction.conditions import PATH
from mffit.quantities import CHANNELS, column, u_column
from mffit.scatter import rms
from tir.errors import counted


def prediction_summary(found: pd.DataFrame, out: Path) -> str:
    """A line per channel: how far a new run may lie from the file and from the best estimate."""
    lines = []
    for name, quantity in CHANNELS.items():
        if column(name, "best") not in found:
            continue
        of_file, of_best = (
            COVERAGE_FACTOR_95 * rms(found[key].to_numpy())
            for key in (u_column(name), f"u_{column(name, 'run')}")
        )
        missed = rms((found[column(name, "best")] - found[column(name)]).to_numpy())
        lines.append(
            f"{name}: a new run lies within {of_file:.3g} {quantity.unit} of the file, within {of_best:.3g} {quantity.unit} of "
            f"the best estimate (95 %, rms over the conditions); the file misses that estimate by {missed:.3g} {quantity.unit}"
        )
    path = found[PATH].to_numpy(dtype=float) if PATH in found else np.zeros(0)
    turning = path[path != 0.0]
    if len(turning):
        lines.append(
            f"on a curved path, as on the disc: {len(turning)} of {counted(len(found), 'condition')} ({PATH}, first "
            f"{turning[0]:.3g}); the straight road has {PATH} = 0"
        )
    return "\n".join([*lines, f"written to {out}"])
