"""Measured points as TYDEX files, release 1.3: one per sweep, with all digits of the numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from datetime import datetime
from typing import Any, NamedTuple

import numpy as np

from mffit import __version__
from mffit.config import Config
from mffit.errors import InputError
from mffit.points import Points

NAME_WIDTH, TEXT_WIDTH, UNIT_WIDTH = 10, 30, 10
"""Characters of the columns of a line, fixed by the format."""
MISSING = "NOTAVAIL"


class TydexChannel(NamedTuple):
    """A channel of TYDEX: its name of at most ten letters, and its numbers."""

    name: str
    words: str
    unit: str
    of: Callable[[Points], np.ndarray]


CHANNELS = (
    TydexChannel("SLIPANGL", "slip angle", "rad", lambda p: p.alpha),
    TydexChannel("INCLANGL", "inclination angle", "rad", lambda p: p.gamma),
    TydexChannel("FZW", "vertical force", "N", lambda p: p.Fz),
    TydexChannel("FYW", "lateral force", "N", lambda p: p.Fy),
    TydexChannel("MXW", "overturning moment", "Nm", lambda p: p.Mx),
    TydexChannel("MYW", "rolling resistance moment", "Nm", lambda p: p.My),
    TydexChannel("MZW", "self aligning moment", "Nm", lambda p: p.Mz),
    TydexChannel("INFLPRES", "inflation pressure", "Pa", lambda p: p.p),
    TydexChannel("TRAJVELW", "trajectory velocity", "m/s", lambda p: p.V),
    TydexChannel("TYRETEMP", "tyre temperature", "degC", lambda p: p.T),
)
"""In TYDEX W axes, which are the ISO axes; channels that were not measured are left out."""


def tydex_texts(points: Points, config: Config) -> dict[str, str]:
    """The text of a file for each sweep, by a name without folders.

    Reading the files with ``axes = "iso"`` gives the same points to rounding. Direction, mount and path curvature are in the
    comments, as TYDEX has no channels for them.

    Raises
    ------
    InputError
        Two sweeps would get the same name.
    """
    texts: dict[str, str] = {}
    for k in np.unique(points.sweep):
        name = "".join(c if c.isalnum() or c in "-_." else "_" for c in points.sweep_names[k])
        if name in texts:
            raise InputError(f'two sweeps have the same file name "{name}.tdx"; rename one of their files')
        texts[name] = "\n".join([*_lines(name, points.select(points.sweep == k), config), ""])
    return texts


def _lines(name: str, points: Points, config: Config) -> Iterator[str]:
    measured = [channel for channel in CHANNELS if np.any(np.isfinite(channel.of(points)))]
    yield "**HEADER"
    yield _row("RELEASE", "Release of TYDEX-Format", "", "1.3")
    yield _row("MEASID", "Measurement ID", "", name)
    yield _row("SUPPLIER", "Data supplier", "", f"mffit {__version__}")
    yield _row("DATE", "Date", "", f"{datetime.now():%d-%b-%y}")
    yield "**COMMENTS"
    yield from _remarks(points, config)
    yield "**CONSTANTS"
    yield _row("OVALLDIA", "Overall diameter", "m", repr(2.0 * config.tyre.unloaded_radius))
    yield "**MEASURCHANNELS"
    for channel in measured:
        yield _row(channel.name, channel.words, channel.unit, "1", "0", "0")
    yield "**MEASURDATA"  # without the number of rows, which not all readers accept
    for row in np.column_stack([channel.of(points) for channel in measured]).tolist():
        yield " ".join(repr(x) if np.isfinite(x) else MISSING for x in row)
    yield "**END"


def _remarks(points: Points, config: Config) -> Iterator[str]:
    yield f"! {config.tyre.name}: steady points, ISO-W axes, forces in the contact frame, nothing corrected"
    yield f"! rolling {'forwards' if np.all(points.direction > 0) else 'backwards'}"
    if np.any(points.mount < 0):
        yield "! tyre turned on its rim"
    if np.any(points.phi_t):
        yield f"! on a path of {1.0 / np.max(np.abs(points.phi_t)):.6g} m radius, turn slip {points.phi_t[0]:+.6g} 1/m"


def _row(name: str, words: str, unit: str, *values: Any) -> str:
    head = f"{name[:NAME_WIDTH]:<{NAME_WIDTH}}{words[:TEXT_WIDTH]:<{TEXT_WIDTH}}{unit:<{UNIT_WIDTH}}"
    return (head + " ".join(map(str, values))).rstrip()
