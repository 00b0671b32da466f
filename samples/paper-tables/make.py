"""Writes the six cases of the direct method: the tyres of Mottola and Massaro, Machines 2022, 10, 921, Tables 1 and 2.

The paper prints the turn-slip force and its u (Table 1), and eps_gamma and its u (Table 2). C_gamma follows from u_F by
(24), r_e then from eps_gamma by (17); with these the sweeps below hold just what the method reads. Run it in this folder.
"""

from __future__ import annotations

import math
from pathlib import Path

R = 1.323
CASES = {  # F [N], C_gamma [N/rad], r_e [m], R0 [m], load [N]
    "front-1": (385.7, 1851.0, 0.2924, 0.300, 1400.0),
    "front-2": (373.5, 1895.0, 0.2932, 0.300, 1400.0),
    "front-3": (340.6, 1806.0, 0.2961, 0.302, 1400.0),
    "rear-1": (493.7, 2024.0, 0.3172, 0.323, 1500.0),
    "rear-2": (454.8, 1917.0, 0.3159, 0.322, 1500.0),
    "rear-3": (488.5, 2003.0, 0.3170, 0.323, 1500.0),
}

CONFIGURATION = """\
# {name}: one of the six published tyres, as the numbers that the direct method needs
[tyre]
name = "{name}"
unloaded_radius = {R0}
nominal_load = {load}
nominal_pressure = 250

[rig]
type = "rotating-disk"
axes = "iso"
path_centre = "left"
path_radius = {R}
u_path_radius = 0.0018
backlash_deg = 0.0            # the printed force has it removed
u_loadcell_offset_N = 10
u_camber_alignment_deg = 0.5
u_slip_alignment_N = 25
u_Fy_gain = 0.0               # the published budgets have no calibrations
u_Fz_gain = 0.0
u_gamma_gain = 0.0

[rolling_radius]
effective_radius = {r_e}
u_effective_radius = 0.0001

[camber_stiffness]
method = "secant"             # the paper's (20)
angle_deg = 15

[[sweep]]
file = "camber.csv"
"""


def main(folder: Path) -> None:
    """Write one folder per tyre."""
    for name, (force, C_gamma, r_e, R0, load) in CASES.items():
        case = folder / name
        case.mkdir(exist_ok=True)
        text = CONFIGURATION.format(name=name, R0=R0, load=load, R=R, r_e=r_e)
        (case / "tyre.toml").write_text(text, encoding="utf-8")
        rows = ["alpha_deg,gamma_deg,Fz_N,Fy_N,u_Fy_N"]
        for gamma in (-15.0, 0.0, 15.0):
            rows.append(f"0.0,{gamma},{load},{-force - C_gamma * math.radians(gamma):.4f},0.001")
        (case / "camber.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(__file__).parent)
