"""Which column of a file is longitudinal slip, in which unit and sign, and what it is against: decided by where Fx is zero."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from mffit.points.constants import SMALLEST_SWEEP_OF_SLIP, SOFTEST_SLIP_STIFFNESS
from mffit.points.slip_zero import FREE, LOADED, Driven, SlipZero, sentence, slip_zero
from mffit.recordings.unstated import FoundChannel
from mffit.sweeps.units import converted

SLIP = "kappa"


class SlipDefinition(NamedTuple):
    """A column of slip, and how it becomes slip as a ratio, positive when driven, against free rolling."""

    column: FoundChannel
    unit: str = ""  #: to write to ``tyre.toml``; "" if the file states it or the readings are ratios
    scale: float = 1.0  #: -1 if braking is positive
    against: str | None = None  #: None if Fx does not show it
    why: str = ""
    remarks: tuple[str, ...] = ()


def slip_definition(
    candidates: Sequence[FoundChannel], found: Mapping[str, FoundChannel], unit_of: Callable[[str], str]
) -> SlipDefinition | None:
    """The column to take as slip: the one against free rolling, else one that can be shifted; None if none holds slip.

    Parameters
    ----------
    candidates : columns with a heading of slip
    found : columns of the other channels
    unit_of : unit of the readings of a channel, by its name
    """
    silent = [column for column in candidates if wheel_not_recorded(column)]
    remarks = [
        f"{column.heading} is {np.nanmedian(column.values):.3g} throughout, as of a wheel at rest, so the speed of the wheel "
        "was not recorded: left out"
        for column in silent
    ]
    readable = [column for column in candidates if column not in silent]
    if not readable:
        return None if not remarks else SlipDefinition(candidates[0], remarks=tuple(remarks))
    judged = [_judged(column, found, unit_of) for column in readable]
    known = [(definition, zero) for definition, zero in judged if zero is not None]
    if not known:
        return judged[0][0]._replace(remarks=tuple(remarks))
    chosen, zero = min(known, key=lambda pair: pair[1].largest)
    for definition, other in known:
        if definition is not chosen:
            remarks.append(
                f"{chosen.column.heading} is taken, not {definition.column.heading}: in the latter {_zero_said(other)}"
            )
    said = sentence(chosen.column.heading, chosen.against, zero)
    why = "; ".join(part for part in (chosen.why, said) if part)
    return chosen._replace(why=why, remarks=tuple(remarks))


def _zero_said(zero: SlipZero) -> str:
    return f"Fx = 0 lies at slip {zero.said}"


def wheel_not_recorded(column: FoundChannel) -> bool:
    """Whether the slip is that of a wheel at rest in every sample: -1 or -100 % but for the noise of the road speed."""
    seen = column.values[np.isfinite(column.values)]
    return any(
        bool(len(seen)) and float(np.max(np.abs(seen / one + 1.0))) < SMALLEST_SWEEP_OF_SLIP
        for one in (1.0, 100.0)
    )


def _judged(
    column: FoundChannel, found: Mapping[str, FoundChannel], unit_of: Callable[[str], str]
) -> tuple[SlipDefinition, SlipZero | None]:
    """One candidate with unit, sign and zero."""
    ratio = converted(column.values, column.unit, "") if column.unit else column.values
    zero = _zero(ratio, found, unit_of)
    unit = why = ""
    if not column.unit:
        if column.size > column.channel.upper:
            unit, why = "%", f"{column.range} look like %"
        elif zero is not None and abs(zero.slope) < SOFTEST_SLIP_STIFFNESS:
            unit, why = (
                "%",
                f"Fx rises by {abs(zero.slope):.2g} times the load per unit of {column.heading}, so {column.range} are in %",
            )
    if unit:
        zero = _zero(0.01 * column.values, found, unit_of)
    if zero is None:
        return SlipDefinition(column, unit, why=why), None
    scale = 1.0
    if zero.slope < 0.0:
        scale = -1.0
        why = "; ".join(
            part for part in (why, "braking is positive in the file, as Fx falls with it") if part
        )
        zero = zero.reversed
    against = FREE if zero.is_free_rolling else LOADED if zero.falls else None
    return SlipDefinition(column, unit, scale, against, why), zero


def _zero(
    slip: np.ndarray, found: Mapping[str, FoundChannel], unit_of: Callable[[str], str]
) -> SlipZero | None:
    """Where Fx is zero, from the columns of a file; None without Fx."""
    if "Fx_N" not in found:
        return None

    def in_si(name: str, unit: str, factor: float = 1.0) -> np.ndarray:
        if name not in found:
            return np.zeros(len(slip))
        return factor * converted(found[name].values, unit_of(name), unit)

    return slip_zero(
        Driven(
            slip=slip,
            Fx=in_si("Fx_N", "N"),
            Fz=in_si("Fz_N", "N"),
            alpha=in_si("alpha_deg", "rad"),
            gamma=in_si("gamma_deg", "rad"),
            p=in_si("p_kPa", "Pa"),
            RL=np.full(len(slip), np.nan),
            V=np.abs(in_si("V_mps", "m/s")),
        )
    )
