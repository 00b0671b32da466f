"""Units that make numbers look plausible one by one and impossible together."""

from __future__ import annotations

import numpy as np

from mffit.errors import InputError
from mffit.points.points import Points
from mffit.points.signatures import slope
from mffit.sweeps.units import factor

STEEPEST = {"alpha": 120.0, "gamma": 12.0}
"""Slopes of side force per load [1/rad] that no tyre comes near; radians read as degrees are 57-fold."""
SLIP_THAT_SHOWS = np.radians(2.0)
CAMBER_THAT_SHOWS = np.radians(5.0)
SMALLEST_FRICTION = 0.02
"""Side force per load that any tyre exceeds at those angles."""
LARGEST_FRICTION = 4.0
"""Side force per load that no tyre reaches."""
LONGEST_ARM = 1.0
"""|Mz| / Fz [m] that no tyre reaches."""
LOW = 0.35
"""Share of the nominal pressure below which no tyre is tested."""
FEWEST_DEAD = 4
"""Rows of one and the same number that make a dead channel."""
WILD = 5.0
"""How many times all the others one load may not be."""


def check_magnitudes(points: Points) -> None:
    """Refuse angles in radians, side forces in kN and moments in N mm, file by file.

    The angles are judged by how steeply the force follows them, so that a file of small angles is not
    suspected.

    Raises
    ------
    InputError
        Names the file and the column.
    """
    for index in np.unique(points.file):
        part = points.select(points.file == index)
        name = points.files[index]
        for angle, steepest in STEEPEST.items():
            for way in (1, -1):
                found = slope(part, part.Fy, angle, part.direction == way)
                if found.sign and abs(found.value) > steepest:
                    raise _radians(name, angle, getattr(part, angle), found.value)
        _check_dead(name, part)
        _check_friction(name, part)
        _check_single_load(name, part)
        _check_largest_friction(name, part)
        arm = np.abs(part.Mz) / part.Fz
        if np.any(arm > LONGEST_ARM):
            raise InputError(
                f"reaches {np.nanmax(arm):.0f} m times the load, which looks like N mm; name its unit under "
                "[sweep.columns]",
                file=name,
                column="Mz_Nm",
            )


def _check_largest_friction(name: str, part: Points) -> None:
    """A load in another unit lifts the friction of a whole file, a wild reading that of one row."""
    friction = np.abs(part.Fy) / part.Fz
    wild = friction > LARGEST_FRICTION
    if not np.any(wild):
        return
    row = int(np.argmax(friction))
    if np.sum(wild) < 3:
        raise InputError(
            f"{part.Fy[row]:.6g} N is {friction[row]:.0f} times the load, which no tyre reaches; correct or remove the row",
            file=name,
            line=int(part.line[row]) or None,
            column="Fy_N",
        )
    raise InputError(
        f"side forces reach {friction[row]:.0f} times the load ({part.Fz[row]:.0f} N), which no tyre does: the load looks like "
        'kgf, or the force like another unit; map it with its unit, Fz_N = { column = "Fz_N", unit = "kgf" } in [sweep.columns]',
        file=name,
        column="Fz_N",
    )


def _check_single_load(name: str, part: Points) -> None:
    """A load that stands alone far above the others of its file is a wild reading, as no programme has one point there."""
    if len(part) < FEWEST_DEAD:
        return
    largest, others = np.argmax(part.Fz), np.sort(part.Fz)[:-1]
    if part.Fz[largest] > WILD * others[-1]:
        raise InputError(
            f"{part.Fz[largest]:.6g} N stands alone, as all other loads of the file are at most {others[-1]:.6g} N; correct or "
            "remove the row",
            file=name,
            line=int(part.line[largest]) or None,
            column="Fz_N",
        )


def _check_dead(name: str, part: Points) -> None:
    """A channel that gives one and the same number while the angles change is not connected."""
    if len(part) < FEWEST_DEAD or np.ptp(part.alpha) + np.ptp(part.gamma) == 0.0:
        return
    for column, reading in (("Mz_Nm", part.Mz), ("Fy_N", part.Fy)):
        if np.all(reading == reading[0]):
            remedy = "leave the column out of this file" if column == "Mz_Nm" else "leave this file out"
            raise InputError(
                f"is {reading[0]:g} in every row, so the channel was dead; {remedy}", file=name, column=column
            )


def check_pressures(points: Points, nominal: float) -> None:
    """Refuse files whose pressure is in psi, as it is far below the nominal one [Pa] as declared and not in psi.

    Raises
    ------
    InputError
        Names the file.
    """
    psi = factor("psi", "kPa")
    for index in np.unique(points.file):
        pressure = float(np.median(points.p[points.file == index]))
        if pressure < LOW * nominal and LOW * nominal < psi * pressure < nominal / LOW:
            raise InputError(
                f"is {pressure / 1e3:.3g} kPa, far from the nominal {nominal / 1e3:.3g} kPa, and looks like psi; write kPa, or "
                'p_kPa = { column = "p_kPa", unit = "psi" } under [sweep.columns]',
                file=points.files[index],
                column="p_kPa",
            )


def _radians(name: str, angle: str, values: np.ndarray, steepness: float) -> InputError:
    largest = np.degrees(np.max(np.abs(values)))
    return InputError(
        f"reaches only {largest:.3g} deg, over which the side force changes by {abs(steepness):.0f} "
        "times the load per "
        f'radian; the angles look like radians: write degrees, or {angle}_deg = {{ column = "{angle}_deg", '
        'unit = "rad" } under [sweep.columns]',
        file=name,
        column=f"{angle}_deg",
    )


def _check_friction(name: str, part: Points) -> None:
    shows = (np.abs(part.alpha) > SLIP_THAT_SHOWS) | (np.abs(part.gamma) > CAMBER_THAT_SHOWS)
    if np.sum(shows) < 3:
        return
    friction = np.max(np.abs(part.Fy[shows]) / part.Fz[shows])
    if friction < SMALLEST_FRICTION:
        raise InputError(
            f"is at most {np.max(np.abs(part.Fy[shows])):.3g} N at loads of {np.median(part.Fz):.0f} "
            "N, which looks like "
            'kN; write newtons, or Fy_N = { column = "Fy_N", unit = "kN" } under [sweep.columns]',
            file=name,
            column="Fy_N",
        )
