"""Tables of the rig: columns with the names and units of docs/files.md, in the rig's own axes and frame."""

import numpy as np
import pandas as pd

from mffit.virtual_rig.machine import Channels
from mffit.virtual_rig.plan import RigPlan
from mffit.virtual_rig.recording import Recording
from mffit.virtual_rig.settings import Settings
from tir.conventions import from_iso

DECIMALS = {
    "time_s": 3, "alpha_deg": 3, "gamma_deg": 3, "Fz_N": 1, "p_kPa": 1, "V_mps": 2, "T_degC": 1, "t_s": 1,
    "Fy_N": 2, "Mz_Nm": 3, "My_Nm": 3, "kappa": 5, "Fx_N": 2, "Mx_Nm": 3, "RL_m": 6, "omega_radps": 4,
}  # fmt: skip
RECORDED_DECIMALS = {
    "alpha_deg": 2, "gamma_deg": 2, "Fz_N": 0, "Fy_N": 0, "Mz_Nm": 1, "My_Nm": 1, "kappa": 4, "Fx_N": 0, "Mx_Nm": 1,
}  # fmt: skip
"""Decimals of recordings: far finer than the noise, and a third of the file size."""


def point_table(plan: RigPlan, settings: Settings, forces: Channels) -> pd.DataFrame:
    """Table with one row per finished point (n,); ``forces`` is in ISO-W axes and includes noise."""
    table = _channels(plan, settings, forces)
    noise = plan.tables.noise
    if noise.declared and (noise.Fy_N or noise.Mz_Nm):
        table["u_Fy_N"], table["u_Mz_Nm"] = noise.Fy_N, noise.Mz_Nm
        for name in (*noise.added, *(("My_Nm",) if noise.added and noise.My_Nm else ())):
            if noise.of(name):
                table[f"u_{name}"] = noise.of(name)
    if plan.tables.conditions.seconds_per_point is not None:
        table["t_s"] = settings.t
    return table.round(DECIMALS)


def recorded_table(plan: RigPlan, recording: Recording) -> pd.DataFrame:
    """Table with one row per sample of a recorded sweep (m,)."""
    table = _channels(plan, recording.settings, recording.forces)
    table.insert(0, "time_s", recording.time)
    return table.round(DECIMALS | RECORDED_DECIMALS)


def _channels(plan: RigPlan, settings: Settings, forces: Channels) -> pd.DataFrame:
    rig = plan.declared.rig
    if rig.force_frame == "C":
        forces = in_wheel_carrier(forces, settings.gamma)

    def turned(channel: str, values: np.ndarray) -> np.ndarray:
        # Adding zero replaces -0.0, which would appear in the CSV, by 0.0.
        return np.asarray(from_iso(rig.axes, channel, values) + 0.0)

    table = pd.DataFrame(
        {
            "alpha_deg": np.degrees(turned("alpha", settings.alpha)),
            "gamma_deg": np.degrees(turned("gamma", settings.gamma)),
            "Fz_N": turned("Fz", forces.Fz),
            "p_kPa": settings.p / 1e3,
            "V_mps": settings.V,
            "T_degC": settings.T,
            "Fy_N": turned("Fy", forces.Fy),
            "Mz_Nm": turned("Mz", forces.Mz),
        }
    )
    # Mz can be turned from the wheel carrier to the contact frame only with My.
    if plan.tables.noise.My_Nm is not None or rig.force_frame == "C":
        table["My_Nm"] = turned("My", forces.My)
    if plan.reports_slip:
        table.insert(2, "kappa", np.broadcast_to(forces.slip, len(table)))
    for name in plan.tables.noise.added:
        channel = name.partition("_")[0]
        table[name] = turned(channel, np.asarray(getattr(forces, channel)))
    return table


def in_wheel_carrier(forces: Channels, gamma: np.ndarray) -> Channels:
    """The channels in the wheel-carrier frame C: frame W turned about x by the camber ``gamma`` (n,) [rad].

    Moments still refer to the contact point; a lever to the wheel's centre would not change Mz.
    """
    c, s = np.cos(gamma), np.sin(gamma)
    return forces._replace(
        Fy=c * forces.Fy + s * forces.Fz,
        Fz=c * forces.Fz - s * forces.Fy,
        My=c * forces.My + s * forces.Mz,
        Mz=c * forces.Mz - s * forces.My,
    )
