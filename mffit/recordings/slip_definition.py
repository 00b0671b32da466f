"""The column of longitudinal slip with its unit, sign and reference radius, found from the slip at which Fx is zero."""

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
from mffit.recordings.unstated import Choice, FoundChannel, Guess, Remark
from mffit.scatter import finite_median
from mffit.sweeps.units import converted

SLIP = "kappa"


class SlipColumn(NamedTuple):
    """The column to take as slip, None without any, with remarks."""

    guess: Guess | None
    remarks: tuple[Remark, ...]
    force_reversed: str = ""  #: why Fx has the other sign in the file; "" if it has not


class _Channels(NamedTuple):
    """The channels of a file without its slip, and the units of their readings."""

    found: Mapping[str, FoundChannel]
    unit_of: Callable[[str], str]

    def driven(self, slip: np.ndarray) -> Driven | None:
        """The readings with this slip (n,) [-], in SI; None without Fx."""
        n = len(slip)
        if "Fx_N" not in self.found:
            return None
        return Driven(
            kappa=slip,
            Fx=self._in("N", "Fx_N", n),
            Fz=self._in("N", "Fz_N", n),
            alpha=self._in("rad", "alpha_deg", n),
            gamma=self._in("rad", "gamma_deg", n),
            p=self._in("Pa", "p_kPa", n),
            RL=np.full(n, np.nan),
            V=np.abs(self._in("m/s", "V_mps", n)),
        )

    def turning(self, slip: np.ndarray) -> tuple[Driven, np.ndarray] | None:
        """The readings with this slip, and the speed of rotation (n,) [rad/s]; None if one was not measured."""
        readings = self.driven(slip)
        if readings is None or not {"omega_radps", "V_mps"} <= self.found.keys():
            return None
        return readings, self._in("rad/s", "omega_radps", len(slip))

    def zero(self, slip: np.ndarray) -> SlipZero | None:
        """The slip at which Fx is zero; None without Fx, or if it cannot be found."""
        readings = self.driven(slip)
        return None if readings is None else slip_zero(readings)

    def form(self, slip: np.ndarray) -> tuple[SlipForm | None, SlipZero | None]:
        """The form of a slip of the right sign and unit, and its zero over the road's speed; None where they cannot be found."""
        turning = self.turning(slip)
        form = None if turning is None else form_of(*turning)
        if form is None or form.over is None:
            return form, None
        return form, self.zero(over_road(slip, form.over))

    def _in(self, unit: str, name: str, n: int) -> np.ndarray:
        """The readings (n,) of a channel in this unit; zeros if it was not measured."""
        if name not in self.found:
            return np.zeros(n)
        return converted(self.found[name].values, self.unit_of(name), unit)


def slip_definition(
    candidates: Sequence[FoundChannel], found: Mapping[str, FoundChannel], unit_of: Callable[[str], str]
) -> SlipColumn:
    """The column to take as slip: the one whose slip at Fx = 0 is closest to zero.

    ``candidates`` are columns with a heading of slip, ``found`` the other channels, whose units ``unit_of`` gives.
    """
    file = _Channels(found, unit_of)
    remarks, judged = [], []
    live = [column for column in candidates if np.ptp(column.values[np.isfinite(column.values)]) > 0.0]
    for column in candidates:
        if why := _no_slip(column, live, file):
            remarks.append(Remark(f"{column.heading} is left out: {why}"))
        else:
            judged.append(_judged(column, file))
    known = [(guess, zero, why) for guess, zero, why in judged if zero is not None]
    if not judged:
        return SlipColumn(None, tuple(remarks), _force_reversed(file))
    if not known:
        return SlipColumn(judged[0][0], tuple(remarks))
    chosen, nearest, force_reversed = min(known, key=lambda one: one[1].largest)
    remarks += [
        Remark(
            f"{chosen.heading} is taken, not {guess.heading}: in the latter Fx = 0 lies at slip {zero.said}"
        )
        for guess, zero, _ in known
        if guess is not chosen
    ]
    if asked := _only_positive(chosen, found["Fx_N"]):
        remarks.append(asked)
    chosen = chosen.because(sentence(chosen.heading, chosen.against, nearest))
    return SlipColumn(chosen, tuple(remarks), force_reversed)


def _only_positive(slip: Guess, force: FoundChannel) -> Remark | None:
    """The question about a slip and a force that are both never negative, as absolute values of braking are."""
    limit = SMALLEST_SWEEP_OF_SLIP * slip.upper
    below = float(np.nanpercentile(force.values, CORE[0])) + SMALLEST_SWEEP_OF_SLIP * force.size
    if slip.scale < 0.0 or slip.lower < -limit or below < 0.0:
        return None
    return Remark(
        f"{slip.heading} and {force.heading} are never negative: was the wheel driven? If it was braked, these are absolute "
        "values",
        ": write scale = -1 for kappa and for Fx_N under [columns]",
    )


def _force_reversed(file: _Channels) -> str:
    """Why Fx has the other sign in a file without a column of slip; "" if it has not, or the speeds do not show it."""
    force = file.found.get("Fx_N")
    turning = None if force is None else file.turning(np.zeros(len(force.values)))
    if turning is None:
        return ""
    readings, omega = turning
    rolls = readings.V > 0.0
    turns = finite_median(np.abs(omega[rolls]) / readings.V[rolls])
    slip = slip_from_speeds(readings, omega, 1.0 / turns) if turns > 0.0 else None
    zero = None if slip is None else slip_zero(readings._replace(kappa=slip))
    return f"Fx falls with {FROM_SPEEDS}" if zero is not None and zero.slope < 0.0 else ""


def _no_slip(column: FoundChannel, live: Sequence[FoundChannel], file: _Channels) -> str:
    """Why a column with a heading of slip holds none; "" if it may. ``live`` are the columns that are not constant."""
    usual = f"it is {np.nanmedian(column.values):.3g} throughout"
    seen = column.values[np.isfinite(column.values)]
    at_rest = (float(np.max(np.abs(seen / one + 1.0), initial=0.0)) for one in (1.0, 100.0))  # -1, or -100 %
    if len(seen) and min(at_rest) < SMALLEST_SWEEP_OF_SLIP:
        return f"{usual}, as of a wheel at rest, so the speed of the wheel was not recorded"
    if live and column not in live:
        return f"{usual}, and {live[0].heading} is not"
    readings = file.driven(_plain(column))
    drive = 0.0 if readings is None else unexplained_drive(readings)
    return f"it hardly moves while Fx changes by {drive:.2g} times the load straight ahead" if drive else ""


def _plain(column: FoundChannel) -> np.ndarray:
    """The slip (n,) [-], in the stated unit, else as a plain number."""
    return converted(column.values, column.unit, "") if column.unit else column.values


def _judged(column: FoundChannel, file: _Channels) -> tuple[Guess, SlipZero | None, str]:
    """A candidate with its unit, sign and reference radius; its slip at Fx = 0, None if that cannot be found; and why Fx, not
    the slip, has the other sign, "" if it has not.
    """
    slip, choice = _plain(column), None
    zero = file.zero(slip)
    if not column.unit or converted(np.ones(1), column.unit, "")[0] == 1.0:  # "-" often stands over per cent
        if column.size > column.channel.upper:
            choice = Choice("%", f"{column.range} look like %")
        elif zero is not None and abs(zero.slope) < SOFTEST_SLIP_STIFFNESS:
            rises = f"Fx rises by {abs(zero.slope):.2g} times the load per unit of {column.heading}"
            choice = Choice("%", f"{rises}, so {column.range} are in %")
    if choice is not None:
        slip = 0.01 * column.values
        zero = file.zero(slip)
    guess = column.guess(choice)
    if zero is None:
        return guess, None, ""
    form, in_form = file.form(slip)
    braking, force_reversed = BRAKING.search(file.found["Fx_N"].heading), ""
    if zero.slope > 0.0 and braking and BRAKING.search(column.heading):
        force_reversed = "braking is positive in the file, as in the slip"
        guess = guess.reversed("braking is positive in the file, as in the force")
    elif zero.slope < 0.0:
        zero = zero.reversed
        confirmed = form is not None and form.over is not None
        if confirmed or braking:
            why = "which the recorded speeds confirm" if confirmed else "as a braking force"
            force_reversed = f"Fx falls with {column.heading}, {why}"
            in_form = None if in_form is None else in_form.reversed
        else:
            guess = guess.reversed("braking is positive in the file, as Fx falls with it")
            form, in_form = file.form(-slip)
    if form is not None and form.over not in (None, ROAD):
        guess, zero = guess.because(form.said(column.heading))._replace(over=form.over), in_form or zero
    return guess._replace(against=zero.against), zero, force_reversed
