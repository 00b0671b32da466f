"""Measured points as TYDEX files, release 1.3: one per sweep, with all digits of the numbers."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from mffit import __version__
from mffit.config import Config
from mffit.errors import InputError
from mffit.made import now
from mffit.points import Points
from mffit.sweeps import tydex_format
from mffit.sweeps.tydex_format import MARK, MISSING, REMARK, fixed_row


class TydexChannel(NamedTuple):
    """A channel of TYDEX: its name of at most ten letters, and its numbers."""

    name: str
    words: str
    unit: str
    of: Callable[[Points], np.ndarray]


TYDEX_CHANNELS = (
    TydexChannel("SLIPANGL", "slip angle", "rad", lambda p: p.alpha),
    TydexChannel("INCLANGL", "inclination angle", "rad", lambda p: p.gamma),
    TydexChannel("FZW", "vertical force", "N", lambda p: p.Fz),
    TydexChannel("LONGSLIP", "longitudinal slip", "-", lambda p: p.kappa),
    TydexChannel("FXW", "longitudinal force", "N", lambda p: p.Fx),
    TydexChannel("FYW", "lateral force", "N", lambda p: p.Fy),
    TydexChannel("MXW", "overturning moment", "Nm", lambda p: p.Mx),
    TydexChannel("MYW", "rolling resistance moment", "Nm", lambda p: p.My),
    TydexChannel("MZW", "self aligning moment", "Nm", lambda p: p.Mz),
    TydexChannel("INFLPRES", "inflation pressure", "Pa", lambda p: p.p),
    TydexChannel("TRAJVELW", "trajectory velocity", "m/s", lambda p: p.V),
    TydexChannel("WHROTSPD", "wheel rotation speed", "rad/s", lambda p: p.omega),
    TydexChannel("TYRETEMP", "tyre temperature", "degC", lambda p: p.T),
)
"""In TYDEX W axes, which are the ISO axes; channels that were not measured are left out."""


def tydex_texts(points: Points, config: Config) -> dict[str, str]:
    """The text of a file for each sweep and direction of rolling, by a name without folders.

    A sweep with both directions gives ``<name>-forward`` and ``<name>-backward``. Reading the files with ``axes = "iso"`` gives
    the same points to rounding. Direction, mount and path curvature are in the comments, as TYDEX has no channels for them.

    Raises InputError if two sweeps would get the same name.
    """
    texts: dict[str, str] = {}
    for k in np.unique(points.sweep):
        plain = "".join(c if c.isalnum() or c in "-_." else "_" for c in points.sweep_names[k])
        for name, part in _by_direction(plain, points.select(points.sweep == k)):
            if name in texts:
                raise InputError(
                    f'two sweeps have the same file name "{name}.tdx"; rename one of their files'
                )
            texts[name] = "\n".join([*_lines(name, part, config), ""])
    return texts


def _by_direction(name: str, points: Points) -> Iterator[tuple[str, Points]]:
    """The points of each direction of rolling, with a name of their own if there are both."""
    forward = points.direction > 0
    if np.all(forward) or not np.any(forward):
        yield name, points
        return
    yield f"{name}-forward", points.select(forward)
    yield f"{name}-backward", points.select(~forward)


def _lines(name: str, points: Points, config: Config) -> Iterator[str]:
    measured = [channel for channel in TYDEX_CHANNELS if _measured(channel, points)]
    yield f"{MARK}{tydex_format.HEADER}"
    yield fixed_row("RELEASE", "Release of TYDEX-Format", "", tydex_format.RELEASE)
    yield fixed_row("MEASID", "Measurement ID", "", name)
    yield fixed_row("SUPPLIER", "Data supplier", "", f"mffit {__version__}")
    yield fixed_row("DATE", "Date", "", f"{now():%d-%b-%y}")
    yield f"{MARK}{tydex_format.COMMENTS}"
    for remark in _remarks(points, config):
        yield f"{REMARK} {remark}"
    yield f"{MARK}{tydex_format.CONSTANTS}"
    yield fixed_row("OVALLDIA", "Overall diameter", "m", repr(2.0 * config.tyre.unloaded_radius))
    yield f"{MARK}{tydex_format.CHANNEL_SECTION}"
    for channel in measured:
        yield fixed_row(channel.name, channel.words, channel.unit, "1", "0", "0")
    # Some programs write the number of rows after **MEASURDATA; not all readers accept it.
    yield f"{MARK}{tydex_format.DATA}"
    for row in np.column_stack([channel.of(points) for channel in measured]).tolist():
        yield " ".join(repr(x) if np.isfinite(x) else MISSING for x in row)
    yield f"{MARK}{tydex_format.END}"


def _measured(channel: TydexChannel, points: Points) -> bool:
    """Whether a channel has readings; slip that is zero throughout was not measured, or the wheel rolled freely."""
    values = channel.of(points)
    return bool(np.any(np.isfinite(values)) and (channel.name != "LONGSLIP" or np.any(values)))


def _remarks(points: Points, config: Config) -> Iterator[str]:
    yield f"{config.tyre.name}: steady points, ISO-W axes, forces in the contact frame, nothing corrected"
    yield f"rolling {'forwards' if np.all(points.direction > 0) else 'backwards'}"
    if np.any(points.mount < 0):
        yield "tyre turned on its rim"
    if np.any(points.phi_t):
        yield f"on a path of {1.0 / np.max(np.abs(points.phi_t)):.6g} m radius, turn slip {points.phi_t[0]:+.6g} 1/m"
