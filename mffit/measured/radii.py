"""Path radius (19) and effective rolling radius (18), with their uncertainties."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.config import Config, wheel_turn
from mffit.config.uncertainty import shape_of
from mffit.measured.uncertain import named
from tir import Tyre


def measured_path_radius(config: Config) -> UFloat | None:
    """R [m] with its uncertainty, from the tape measures or as given; None on a flat track."""
    rig = config.rig
    if rig.radius is None:
        return None
    return named(rig.radius, rig.u("path_radius_m"), "path radius", "m")


def measured_effective_radius(config: Config, R: UFloat | None) -> dict[float, UFloat]:
    """r_e [m] by load [N]: distance of one disc revolution over the angle of the wheel (18), or as given."""
    out = {}
    for row in config.rolling_radius:
        load = row.load_N or config.tyre.nominal_load
        if not row.is_measured:
            assert row.effective_radius is not None
            out[load] = named(row.effective_radius, row.u_effective_radius or 0.0, "effective radius", "m")
            continue
        u_arcs, u_angle = np.sqrt(2.0) * row.u_arc_m, np.sqrt(2.0) * np.radians(row.u_angle_deg)
        arcs = named(0.0, u_arcs, "disc notches", "m", **shape_of(row.u_arc_m))
        assert R is not None
        angle = named(wheel_turn(row), u_angle, "wheel angle", "rad", **shape_of(row.u_angle_deg))
        out[load] = (2.0 * np.pi * R + arcs) / angle
    return out


class RadiusReading(NamedTuple):
    """A measured effective radius as a reading of the fit."""

    load: float  #: [N]
    value: float  #: radius for the declared path radius [m]
    u: float  #: standard uncertainty without the contribution of the path radius [m]
    follows_path: bool  #: True if measured by a disc revolution (18), hence proportional to R


def radius_readings(config: Config) -> tuple[RadiusReading, ...]:
    """The effective radii as readings for the joint fit of tyre and rig."""
    R = measured_path_radius(config)
    found = measured_effective_radius(config, R)
    rows = []
    for load, r_e in found.items():
        own = [u for source, u in r_e.error_components().items() if source is not R]
        follows = R is not None and R in r_e.derivatives
        rows.append(
            RadiusReading(
                load,
                float(r_e.nominal_value),
                max(float(np.hypot.reduce(own)), 1e-5),  # the fit divides by it
                follows,
            )
        )
    return tuple(rows)


def effective_radius_at(load: float, measured: Mapping[float, UFloat], base: Tyre | None) -> UFloat | None:
    """r_e [m] at a load [N]: the measurement at the nearest load, scaled by the base file's Re(Fz) if there is a base file."""
    if not measured:
        return None
    nearest = min(measured, key=lambda other: abs(np.log(other / load)))
    r_e = measured[nearest]
    if base is None:
        return r_e
    shape = base.state(np.array([nearest, load])).Re
    return r_e * float(shape[1] / shape[0])
