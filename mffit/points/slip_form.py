"""What a slip column is divided by, found from the recorded speeds of wheel and road.

Slip of the Magic Formula is ``omega r / V - 1``. Laboratories also divide by the speed of the wheel, ``1 - V / (omega r)``, or by
the larger of both speeds. In the right form, the radius ``r`` that slip and speeds imply does not change with the slip.
"""

from typing import Literal, NamedTuple, get_args

import numpy as np

from mffit.points import constants
from mffit.scatter import finite_median

Over = Literal["road", "wheel", "larger"]
"""Speed that slip is divided by: of the road, of the wheel, or the larger of both."""
ROAD, *OTHERS = get_args(Over)
FORMULAS = {
    "road": "omega r / V - 1",
    "wheel": "1 - V / (omega r)",
    "larger": "(omega r - V) over the larger of both speeds",
}


class SlipForm(NamedTuple):
    """The form of a slip column that its recording shows."""

    over: Over | None  #: None: no form fits the recorded speeds
    before: (
        float  #: change of the implied radius over the slip, relative, if the slip is over the road's speed
    )
    after: float  #: the same in the form found

    def said(self, heading: str) -> str:
        """A sentence on a column that is not over the road's speed."""
        changes = f"the radius r that V and omega imply changes by {100.0 * self.before:.2g} % over the slip"
        if self.over is None:
            return (
                f"{heading} contradicts the recorded speeds: {changes}, and no other definition of slip fits; check V_mps and "
                "omega_radps"
            )
        return (
            f"{heading} is {FORMULAS[self.over]}, not {FORMULAS[ROAD]}: for the latter, {changes}, for the former by "
            f"{100.0 * self.after:.2g} %"
        )


def over_road(slip: np.ndarray, over: Over) -> np.ndarray:
    """Slip over the road's speed (n,), from slip in another form."""
    if over == ROAD:
        return slip
    with np.errstate(divide="ignore", invalid="ignore"):
        driven = np.where(slip < 1.0, slip / (1.0 - slip), np.nan)
    return driven if over == "wheel" else np.where(slip > 0.0, driven, slip)


def slip_form(slip: np.ndarray, turns: np.ndarray, conditions: np.ndarray) -> SlipForm | None:
    """The form of a slip column (n,); None without wheel speed, or if slip hardly varies.

    ``turns`` are ``|omega| / V`` [1/m] along the wheel's plane, ``conditions`` (n, k) columns that the radius may follow, the
    first of them constant.
    """
    known = np.isfinite(slip) & np.isfinite(turns) & (turns > 0.0) & np.all(np.isfinite(conditions), axis=1)
    known &= slip > -constants.LARGEST_BRAKE_SLIP_OF_FORM
    if np.sum(known) < constants.FEWEST_POINTS * conditions.shape[1]:
        return None
    s, q, c = slip[known], turns[known], conditions[known]
    if np.ptp(np.percentile(s, constants.CORE)) < constants.SMALLEST_SWEEP_OF_SLIP:
        return None
    changes = {over: _change((1.0 + over_road(s, over)) / q, s, c) for over in (ROAD, *OTHERS)}
    before, best = changes[ROAD], min(changes, key=lambda over: changes[over])
    if before <= constants.SLIP_OF_ZERO_FORCE:
        return SlipForm(ROAD, before, before)
    after = changes[best]
    if after <= min(constants.SLIP_OF_ZERO_FORCE, before - constants.SLIP_OF_ZERO_FORCE):
        return SlipForm(best, before, after)
    return SlipForm(ROAD if before < constants.SLIP else None, before, after)


def _change(radius: np.ndarray, slip: np.ndarray, conditions: np.ndarray) -> float:
    """Range of the part of the implied radius (n,) that follows the slip, over the radius."""
    powers = np.column_stack([slip, np.abs(slip), slip**2])
    design = np.column_stack([conditions, powers])
    size = np.linalg.norm(design, axis=0)
    used = size > 0.0
    factors = np.zeros(design.shape[1])
    factors[used], *_ = np.linalg.lstsq(design[:, used] / size[used], radius, rcond=1e-6)
    factors[used] /= size[used]
    part = powers @ factors[conditions.shape[1] :]
    return float(np.ptp(np.percentile(part, constants.CORE)) / abs(finite_median(radius)))
