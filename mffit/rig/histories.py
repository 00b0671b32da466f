"""What a point owes to the points before it: distance rolled, sense of the sweep, usual path and usual speed."""

from __future__ import annotations

import numpy as np

from mffit.points import Points, main_path
from mffit.rig import constants


def usual_radius(points: Points) -> float:
    """Path radius [m] declared for most points; very large on a straight path."""
    return 1.0 / max(abs(main_path(points)), 1e-12)


def path_radii(points: Points) -> np.ndarray:
    """Declared path radius (n,) of every point [m]; very large on a straight path."""
    return 1.0 / np.maximum(np.abs(points.phi_t), 1e-12)


def reference_speed(points: Points) -> float:
    """The most frequent speed of the data [m/s], to 0.1 m/s."""
    values, counts = np.unique(np.round(points.V[np.isfinite(points.V)], 1), return_counts=True)
    return float(values[counts.argmax()])


def sense(points: Points) -> np.ndarray:
    """Sense (n,) in which the sideslip was moving along its sweep: 1 up, -1 down, 0 held."""
    out = np.zeros(len(points))
    for k in np.unique(points.sweep):
        rows = np.flatnonzero(points.sweep == k)
        if len(rows) > 1:
            moving = np.gradient(points.alpha[rows])
            out[rows] = np.where(np.abs(moving) > constants.HELD_ANGLE.rad, np.sign(moving), 0.0)
    return out


def distance_km(points: Points) -> np.ndarray:
    """Distance (n,) rolled since time zero [km], the speed linear between points; 0 where times are not known."""
    out = np.zeros(len(points))
    rows = np.flatnonzero(np.isfinite(points.t))
    rows = rows[np.argsort(points.t[rows], kind="stable")]
    t, V = points.t[rows], points.V[rows]
    if len(rows):
        steps = np.diff(t) * 0.5 * (V[1:] + V[:-1])
        out[rows] = 1e-3 * (max(t[0], 0.0) * V[0] + np.concatenate([[0.0], np.cumsum(steps)]))
    return out


def of_part(points: Points, name: str) -> np.ndarray:
    """1 at the points (n,) of the set-up, the file or the sweep of that name, the first of the three that has it; else 0."""
    counted = ((points.setups, points.setup), (points.files, points.file), (points.sweep_names, points.sweep))
    names, index = next((pair for pair in counted if name in pair[0]), counted[0])
    return np.array([float(other == name) for other in names])[index]
