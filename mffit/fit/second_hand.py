"""Mx with the side force as read: what the formula misses of Mx must not bend the side force, which is measured itself."""

from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np

from mffit.points import Points
from mffit.rig import Simulation
from mffit.rig_errors import BY_NAME as BY_ERROR
from tir.derivatives import gradient, plain, traced
from tir.equations import normalise, overturning
from tir.parameters import BY_NAME

SIDE_FORCE, ARM, PRESSURE = "Fy", "k_p_arm_per_kPa", "p_ref_kPa"


def by_force_read(
    simulation: Simulation, points: Points, forces: tuple[np.ndarray, np.ndarray], names: Sequence[str]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Change of Mx (n,) [Nm] if the side force is the one that was read, not the one of the model.

    ``forces`` are both, (n,) [N] each, that which was read first. Also returned: the derivatives of the change by the named
    numbers (n, k) at these forces, and by the force of the model (n,).
    """
    own = [name for name in names if name == ARM or (name in BY_NAME and BY_NAME[name].channel == "Mx")]
    at = traced({**{name: simulation.number(name, points) for name in own}, SIDE_FORCE: forces[1]})
    values = {**simulation.values, **{name: at[name] for name in own if name != ARM}}
    reference = simulation.number(PRESSURE, points)
    if not np.isnan(reference):
        (arm,) = BY_ERROR[ARM].acts_on
        k = at.get(ARM, simulation.number(ARM, points))
        values[arm] = values[arm] + k * (1e-3 * points.p - reference)
    p = SimpleNamespace(**values)
    q = normalise.inputs(p, normalise.OperatingCondition(points.Fz, gamma=points.gamma, pressure=points.p))
    read, model = (overturning.moment(p, q, points.Fz, Fy) for Fy in (forces[0], at[SIDE_FORCE]))
    by_number = np.zeros((len(points), len(names)))
    slopes = gradient(read - model, list(at.values()))
    by_number[:, [names.index(name) for name in own]] = slopes[:, :-1]
    return np.asarray(plain(read - model)), by_number, slopes[:, -1]
