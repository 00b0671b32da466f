"""A plain tyre on a disc, every stiffness of which is known; nothing here comes from ``mffit`` but the record."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mffit import config
from mffit.config import Config
from mffit.points import Points, make_points

R, R_E = 1.3, 0.29  # m
U_R, U_R_E = 0.002, 0.0005
SLIP = np.radians([-6.0, -4.0, -3.0, -2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0])
LEAN = np.radians([-40.0, -30.0, -20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0])
ZEROS = np.radians([-0.1, 0.0, 0.1])
NEWTON, NEWTON_METRE = 3.0, 0.3
"""Standard uncertainty of a point; no noise is added."""


@dataclass(frozen=True)
class Plain:
    """Slopes at zero per load, ISO-W, and what is wrong with the rig."""

    cornering: float = 12.0  #: -C_alpha per load [1/rad]
    camber: float = 0.9  #: -C_gamma per load [1/rad]
    epsilon: float = -0.15  #: eps_gamma
    epsilon_moment: float = -0.4  #: what the moments say of it
    side: int = -1  #: sign of phi_t
    alpha_0: float = 0.0  #: true sideslip minus reading [rad]
    play: float = 0.0  #: full play of the sideslip axis [rad]
    skew: float = 0.0  #: sideslip that leaning adds, over sin(gamma) [rad]

    def turn_slip_force(self, Fz: Any) -> Any:
        """[N]: C_phit phi_t with C_phit from (17), eps = 1 + r_e C_gamma / C_phit."""
        return self.side / R * R_E * self.camber * Fz / (1.0 - self.epsilon)

    def readings(self, alpha: Any, gamma: Any, Fz: Any, direction: Any) -> tuple[Any, Any]:
        """Fy [N] and Mz [Nm] at read angles; the moment, far from zero everywhere, takes up the play."""
        spin_moment = self.side / R * R_E * 0.03 * Fz / (1.0 - self.epsilon_moment)
        Mz = 0.02 * np.tanh(alpha / 0.05) * Fz - 0.03 * gamma * Fz + direction * spin_moment
        true = alpha + self.alpha_0 + self.skew * np.sin(gamma) - 0.5 * self.play * np.sign(Mz)
        slip = -np.tanh(self.cornering * true / 2.0) * 2.0 * Fz  # slope -cornering at zero
        return direction * slip - self.camber * gamma * Fz + self.turn_slip_force(Fz), Mz

    def campaign(
        self,
        loads=(1500.0,),
        *,
        backward: bool = True,
        p: float = 250e3,
        backward_camber: tuple[float, ...] = (),
        **given: Any,
    ) -> Points:
        """Sideslip, camber and zeros at every load, and a backward camber sweep at some."""
        rows = []
        for Fz in loads:
            rows += [(a, 0.0, Fz, 1, 0) for a in SLIP] + [(0.0, g, Fz, 1, 1) for g in LEAN]
            rows += [(a, 0.0, Fz, 1, 2) for a in ZEROS]
            rows += [(a, 0.0, Fz, -1, 3) for a in ZEROS] if backward else []
            rows += [(0.0, g, Fz, -1, 4) for g in LEAN] if Fz in backward_camber else []
        alpha, gamma, Fz, direction, sweep = np.array(rows).T
        direction = direction.astype(int)
        Fy, Mz = self.readings(alpha, gamma, Fz, direction)
        return make_points(
            alpha, gamma, Fz, p=p, V=6.0, phi_t=self.side / R, Fy=Fy, Mz=Mz, direction=direction,
            sweep=sweep.astype(int), sweep_names=("sideslip", "camber", "forward", "backward", "backward camber"),
            **{"u_Fy": NEWTON, "u_Mz": NEWTON_METRE} | given,
        )  # fmt: skip


def settings(*, tyre=None, camber_stiffness=None, spin=None, radius=True, **rig: Any) -> Config:
    """A configuration of the disc: hardly a doubt about the rig but what is given."""
    sure = {
        "u_loadcell_offset_N": 0.0, "u_camber_alignment_deg": 0.0, "u_slip_alignment_N": 1.0, "u_camber_skew_deg": 0.0,
    }  # fmt: skip
    content = {
        "tyre": {"name": "plain", "unloaded_radius": 0.3, "nominal_load": 1500.0, "nominal_pressure": 250.0}
        | (tyre or {}),
        "rig": {"path_radius": R, "u_path_radius": U_R} | sure | rig,
        "rolling_radius": [{"effective_radius": R_E, "u_effective_radius": U_R_E}] if radius else [],
        "camber_stiffness": camber_stiffness or {},
        "spin": spin or {},
        "sweep": [{"file": "all.csv"}],
    }
    return config.load(content)


def share(u_force: float, tyre: Plain, Fz: float = 1500.0) -> float:
    """What a doubt about the turn-slip force [N] makes of eps_gamma: d eps / dF = (1 - eps) / F."""
    return abs(u_force * (1.0 - tyre.epsilon) / tyre.turn_slip_force(Fz))


DEGREE = math.radians(1.0)
