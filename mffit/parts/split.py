"""Symmetric decomposition (4), (25): the part of the readings that changes sign with the angles, and the rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mffit.brief import Brief
from mffit.constants import NAMED_IN_SENTENCE
from mffit.parts.mirror import find_mirrors
from mffit.points import Points


@dataclass(frozen=True, slots=True, repr=False)
class Parts(Brief):
    """Odd and even part at every point; arrays (n,), NaN where a point has no mirror."""

    Fy_odd: np.ndarray  #: [F(a, g) - F(-a, -g)] / 2 [N]
    Fy_even: np.ndarray  #: F - odd part [N]
    Mz_odd: np.ndarray  #: [Nm]
    Mz_even: np.ndarray  #: [Nm]
    u_Fy_odd: np.ndarray  #: standard uncertainty of either part [N]
    u_Mz_odd: np.ndarray  #: [Nm]
    paired: np.ndarray  #: "exact" | "interpolated" | "unpaired"
    partner: np.ndarray  #: index of the mirror, -1 if interpolated or unpaired
    unpaired: tuple[str, ...]  #: one sentence per sweep with unpaired points
    alpha_odd: np.ndarray  #: sideslip of the odd part [rad]: the reading, corrected for known play

    def among(self, points: Points, rows: np.ndarray) -> Parts:
        """The parts of a larger set of ``points`` (n,) that contains these (mask (n,)); the others have no mirror."""

        def spread(name: str, others: Any) -> np.ndarray:
            own = getattr(self, name)
            out = np.full(len(points), others, dtype=own.dtype)
            out[rows] = own
            return out

        index = np.flatnonzero(rows)
        return Parts(
            **{name: spread(name, np.nan) for name in NUMBERS},
            paired=spread("paired", "unpaired"),
            partner=np.where((partner := spread("partner", -1)) < 0, -1, index[partner]),
            unpaired=self.unpaired,
            alpha_odd=np.where(rows, spread("alpha_odd", 0.0), points.alpha),
        )


NUMBERS = ("Fy_odd", "Fy_even", "Mz_odd", "Mz_even", "u_Fy_odd", "u_Mz_odd")
"""Fields of :class:`Parts` that are NaN without a mirror."""


def split(points: Points) -> Parts:
    """Decompose Fy and Mz of every point by mirror symmetry.

    On a straight path all points stay unpaired, without a remark.
    """
    mirrors = find_mirrors(points)
    Fy_odd, Mz_odd = (points.Fy - mirrors.Fy) / 2.0, (points.Mz - mirrors.Mz) / 2.0
    unpaired = (mirrors.paired == "unpaired") & bool(np.any(points.phi_t))
    return Parts(
        Fy_odd=Fy_odd,
        Fy_even=points.Fy - Fy_odd,
        Mz_odd=Mz_odd,
        Mz_even=points.Mz - Mz_odd,
        u_Fy_odd=np.hypot(points.u_Fy, mirrors.u_Fy) / 2.0,
        u_Mz_odd=np.hypot(points.u_Mz, mirrors.u_Mz) / 2.0,
        paired=mirrors.paired,
        partner=mirrors.partner,
        unpaired=_sentences(points, unpaired),
        alpha_odd=points.alpha,
    )


def _sentences(points: Points, unpaired: np.ndarray) -> tuple[str, ...]:
    """A sentence per sweep about the points of the mask (n,)."""
    out, most = [], NAMED_IN_SENTENCE
    for k in np.unique(points.sweep[unpaired]):
        rows = np.flatnonzero(unpaired & (points.sweep == k))
        shown = ", ".join(
            f"({np.degrees(points.alpha[i]):.2g}, {np.degrees(points.gamma[i]):.2g})" for i in rows[:most]
        )
        more = f" and {len(rows) - most} more" if len(rows) > most else ""
        out.append(
            f"{points.sweep_names[k]}: {len(rows)} points have no mirror (-alpha, -gamma) and count only as raw points: "
            f"(alpha, gamma) = {shown}{more} deg"
        )
    return tuple(out)
