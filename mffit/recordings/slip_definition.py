"""The column of longitudinal slip with its unit, sign and reference radius, found from the slip at which Fx is zero."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from mffit.points.constants import CORE, SMALLEST_SWEEP_OF_SLIP, SOFTEST_SLIP_STIFFNESS
from mffit.points.slip_form import ROAD, SlipForm, over_road
from mffit.points.slip_zero import (
    FROM_SPEEDS,
    Driven,
    SlipZero,
    form_of,
    sentence,
    slip_from_speeds,
    slip_zero,
    unexplained_drive,
)
from mffit.recordings.by_unit import BRAKING
from mffit.recordings.unstated import Choice, FoundChannel, Guess
from mffit.scatter import finite_median
from mffit.sweeps.units import converted

SLIP = "kappa"


class SlipColumn(NamedTuple):
    """The column to take as slip, None without any, with remarks."""

    guess: Guess | None
    remarks: tuple[str, ...]
    force_reversed: str = ""  #: why Fx has the other sign in the file; "" if it has not


def slip_definition(
    candidates: Sequence[FoundChannel], found: Mapping[str, FoundChannel], unit_of: Callable[[str], str]
) -> SlipColumn:
    """The column to take as slip: that whose slip at Fx = 0 is closest to zero.

    ``candidates`` are columns with a heading of slip, ``found`` those of the other channels, whose units ``unit_of`` gives.
    """
    remarks, judged = [], []
    live = [column for column in candidates if np.ptp(column.values[np.isfinite(column.values)]) > 0.0]
    for column in candidates:
        if why := _no_slip(column, live, found, unit_of):
            remarks.append(f"{column.heading} is left out: {why}")
        else:
            judged.append(_judged(column, found, unit_of))
    known = [(guess, zero, why) for guess, zero, why in judged if zero is not None]
    if not judged:
        return SlipColumn(None, tuple(remarks), _force_reversed(found, unit_of))
    if not known:
        return SlipColumn(judged[0][0], tuple(remarks))
    chosen, nearest, force_reversed = min(known, key=lambda one: one[1].largest)
    remarks += [
        f"{chosen.heading} is taken, not {guess.heading}: in the latter Fx = 0 lies at slip {zero.said}"
        for guess, zero, _ in known
        if guess is not chosen
    ]
    if asked := _only_positive(chosen, found["Fx_N"]):
        remarks.append(asked)
    said = sentence(chosen.heading, chosen.against, nearest)
    chosen = chosen._replace(why="; ".join(filter(None, (chosen.why, said))))
    return SlipColumn(chosen, tuple(remarks), force_reversed)


def _only_positive(slip: Guess, force: FoundChannel) -> str:
    """The question about a slip and a force that both have positive readings only, as absolute values of braking have."""
    limit = SMALLEST_SWEEP_OF_SLIP * slip.upper
    below = float(np.nanpercentile(force.values, CORE[0])) + SMALLEST_SWEEP_OF_SLIP * force.size
    if slip.scale < 0.0 or slip.lower < -limit or below < 0.0:
        return ""
    return (
        f"{slip.heading} and {force.heading} are never negative: was the wheel driven? If it was braked, these are absolute "
        "values: write scale = -1 for kappa and for Fx_N under [columns]"
    )


def _force_reversed(found: Mapping[str, FoundChannel], unit_of: Callable[[str], str]) -> str:
    """Why Fx has the other sign in a file without a column of slip; "" if it has not, or the speeds do not show it."""
    if not {"Fx_N", "omega_radps", "V_mps"} <= found.keys():
        return ""
    readings = _readings(np.zeros(len(found["Fx_N"].values)), found, unit_of)
    if readings is None:
        return ""
    omega = converted(found["omega_radps"].values, unit_of("omega_radps"), "rad/s")
    rolls = readings.V > 0.0
    turns = finite_median(np.abs(omega[rolls]) / readings.V[rolls])
    if not turns > 0.0:
        return ""
    slip = slip_from_speeds(readings, omega, 1.0 / turns)
    zero = None if slip is None else slip_zero(readings._replace(kappa=slip))
    return f"Fx falls with {FROM_SPEEDS}" if zero is not None and zero.slope < 0.0 else ""


def _no_slip(
    column: FoundChannel,
    live: Sequence[FoundChannel],
    found: Mapping[str, FoundChannel],
    unit_of: Callable[[str], str],
) -> str:
    """Why a column with a heading of slip holds none; "" if it may. ``live`` are the columns that are not constant."""
    usual = f"it is {np.nanmedian(column.values):.3g} throughout"
    if _wheel_not_recorded(column):
        return f"{usual}, as of a wheel at rest, so the speed of the wheel was not recorded"
    if live and column not in live:
        return f"{usual}, and {live[0].heading} is not"
    readings = _readings(
        converted(column.values, column.unit, "") if column.unit else column.values, found, unit_of
    )
    drive = 0.0 if readings is None else unexplained_drive(readings)
    return f"it hardly moves while Fx changes by {drive:.2g} times the load straight ahead" if drive else ""


def _wheel_not_recorded(column: FoundChannel) -> bool:
    """Whether every sample has the slip of a wheel at rest: -1 or -100 %, within the noise of the road speed."""
    seen = column.values[np.isfinite(column.values)]
    return any(
        bool(len(seen)) and float(np.max(np.abs(seen / one + 1.0))) < SMALLEST_SWEEP_OF_SLIP
        for one in (1.0, 100.0)
    )


def _judged(
    column: FoundChannel, found: Mapping[str, FoundChannel], unit_of: Callable[[str], str]
) -> tuple[Guess, SlipZero | None, str]:
    """A candidate with its unit, sign and reference radius; its slip at Fx = 0, None if that cannot be found; and why Fx, not
    the slip, has the other sign, "" if it has not.
    """
    zero = _zero(converted(column.values, column.unit, "") if column.unit else column.values, found, unit_of)
    choice = None
    if _is_plain(column.unit):  # "none" or "-" often stands over per cent
        if column.size > column.channel.upper:
            choice = Choice("%", f"{column.range} look like %")
        elif zero is not None and abs(zero.slope) < SOFTEST_SLIP_STIFFNESS:
            rises = f"Fx rises by {abs(zero.slope):.2g} times the load per unit of {column.heading}"
            choice = Choice("%", f"{rises}, so {column.range} are in %")
    if choice is not None:
        zero = _zero(0.01 * column.values, found, unit_of)
    guess = column.guess(choice)
    if zero is None:
        return guess, None, ""
    slip = 0.01 * column.values
    if choice is None:
        slip = converted(column.values, column.unit, "") if column.unit else column.values
    form, in_form = _form(slip, found, unit_of)
    force_reversed = ""
    if zero.slope > 0.0 and BRAKING.search(column.heading) and BRAKING.search(found["Fx_N"].heading):
        force_reversed = "braking is positive in the file, as in the slip"
        guess = guess.reversed("braking is positive in the file, as in the force")
    elif zero.slope < 0.0:
        zero = zero.reversed
        confirmed = form is not None and form.over is not None
        if confirmed or BRAKING.search(found["Fx_N"].heading):
            force_reversed = f"Fx falls with {column.heading}"
            force_reversed += ", which the recorded speeds confirm" if confirmed else ", as a braking force"
            in_form = None if in_form is None else in_form.reversed
        else:
            guess = guess.reversed("braking is positive in the file, as Fx falls with it")
            form, in_form = _form(-slip, found, unit_of)
    if form is not None and form.over not in (None, ROAD):
        why = "; ".join(filter(None, (guess.why, form.said(column.heading))))
        guess, zero = guess._replace(over=form.over, why=why), in_form or zero
    return guess._replace(against=zero.against), zero, force_reversed


def _is_plain(unit: str) -> bool:
    """Whether a column has no unit, or that of a plain number."""
    return not unit or float(converted(np.ones(1), unit, "")[0]) == 1.0


def _form(
    slip: np.ndarray, found: Mapping[str, FoundChannel], unit_of: Callable[[str], str]
) -> tuple[SlipForm | None, SlipZero | None]:
    """The form of a slip of the right sign and unit, and its zero over the road's speed; None where they cannot be found."""
    readings = _readings(slip, found, unit_of)
    if readings is None or not {"omega_radps", "V_mps"} <= found.keys():
        return None, None
    omega = converted(found["omega_radps"].values, unit_of("omega_radps"), "rad/s")
    form = form_of(readings, omega)
    if form is None or form.over is None:
        return form, None
    return form, slip_zero(readings._replace(kappa=over_road(slip, form.over)))


def _zero(
    slip: np.ndarray, found: Mapping[str, FoundChannel], unit_of: Callable[[str], str]
) -> SlipZero | None:
    """The slip at which Fx is zero, from the columns of a file; None without Fx, or if it cannot be found."""
    readings = _readings(slip, found, unit_of)
    return None if readings is None else slip_zero(readings)


def _readings(
    slip: np.ndarray, found: Mapping[str, FoundChannel], unit_of: Callable[[str], str]
) -> Driven | None:
    """The readings of a file with this slip [-], in SI; None without Fx."""
    if "Fx_N" not in found:
        return None

    def in_si(name: str, unit: str) -> np.ndarray:
        if name not in found:
            return np.zeros(len(slip))
        return converted(found[name].values, unit_of(name), unit)

    return Driven(
        kappa=slip,
        Fx=in_si("Fx_N", "N"),
        Fz=in_si("Fz_N", "N"),
        alpha=in_si("alpha_deg", "rad"),
        gamma=in_si("gamma_deg", "rad"),
        p=in_si("p_kPa", "Pa"),
        RL=np.full(len(slip), np.nan),
        V=np.abs(in_si("V_mps", "m/s")),
    )
