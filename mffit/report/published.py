"""Published camber reduction factors, to compare a new tyre with."""

from __future__ import annotations

from typing import NamedTuple


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
