"""The camber reduction factors of published tyres, and likely causes of one that is far from them."""

import math
import statistics
from collections.abc import Iterator
from typing import NamedTuple

from mffit.measured import LoadResult


class Published(NamedTuple):
    """One measured tyre."""

    name: str
    epsilon_gamma: float  #: [-]
    u: float  #: [-], k = 1


SOURCE = "Mottola, M.; Massaro, M. Machines 2022, 10, 921, Table 2 (CC BY 4.0), doi:10.3390/machines10100921"
TYRES = (
    Published("Front 1 (120/70-17)", -0.0609, 0.0863),
    Published("Front 2", -0.1245, 0.0951),
    Published("Front 3", -0.1870, 0.1089),
    Published("Rear 1 (190/55-17)", 0.0174, 0.0642),
    Published("Rear 2", -0.0064, 0.0702),
    Published("Rear 3", 0.0178, 0.0646),
)
OF_MOTORCYCLES = statistics.NormalDist.from_samples([tyre.epsilon_gamma for tyre in TYRES])
"""Mean and standard deviation of their factors."""


def causes(row: LoadResult, *, radius_counts: bool) -> str:
    """The likely causes in words, each with its required size or with eps_gamma after correction.

    1 - eps_gamma = -C_gamma r_e / C_phit and C_phit = |F_phit| R. Hence an error of R scales 1 - eps_gamma unless r_e was
    measured along the path; a wrong sign of the camber or of the path's centre reverses it; and a skew adds C_alpha times its
    angle to C_gamma.
    """
    assert row.epsilon_gamma is not None
    rest, usual = 1.0 - row.epsilon_gamma.value, 1.0 - OF_MOTORCYCLES.mean
    sign = f"a reversed sign of camber or path_centre (with the other sign it would be {1.0 + rest:.2f})"
    found = [*_radius(row, rest, usual, radius_counts), *_skew(row, rest, usual)]
    return "; ".join([sign, *found] if rest < 0.0 else [*found[:1], sign, *found[1:]])


def _radius(row: LoadResult, rest: float, usual: float, counts: bool) -> Iterator[str]:
    if row.R is None:
        return
    R = abs(row.R.value)
    if not counts:
        yield "a path radius that is off does not change it, because the rolling radius was measured along the path"
        return
    doubled = abs(rest) < usual
    entered = (
        "a diameter entered as the path radius" if doubled else "a path radius that was halved by mistake"
    )
    scale = 0.5 if doubled else 2.0
    yield (
        f"{entered} (with a path radius of {scale * R:.3g} m instead of {R:.3g} m it would be "
        f"{1.0 - rest / scale:.2f})"
    )


def _skew(row: LoadResult, rest: float, usual: float) -> Iterator[str]:
    if row.C_gamma is not None and row.C_alpha is not None and rest > 0.0:
        skew = math.degrees(row.C_gamma.value * (1.0 - usual / rest) / row.C_alpha.value)
        yield (
            f"a camber axis that is not square to the steering axis (camber_skew_deg would have to be {skew:+.1f} for a usual "
            f"{OF_MOTORCYCLES.mean:.2f}; a backward camber sweep measures it)"
        )
