"""Sweeps of the virtual disc rig compared with simulations that include its path and rig errors, or leave them out.

``python disc_rig.py rig.toml DIR [--picture FILE.png]`` writes the campaign to DIR, reads the files back
like those of a real rig, and simulates the same points with the forward model of ``mffit.rig``.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping

import numpy as np

import tir
from mffit import config, points, virtual_rig
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS, Faults


def models(tyre: tir.Tyre, faults: Faults) -> dict[str, Simulation]:
    """The correct simulation, one without rig errors and one without path curvature."""
    return {
        "path and rig errors": Simulation.of(tyre, faults),
        "path, no rig errors": Simulation.of(tyre, NO_FAULTS),
        "straight path": Simulation.of(tyre, faults, turn_slip=False),
    }


def compare(rig_toml: str, folder: str) -> tuple[points.Points, Mapping[str, tuple[np.ndarray, np.ndarray]]]:
    """Points of a test on the virtual rig, and the residuals of each simulation.

    Returns
    -------
    Points, mapping
        The steady points as read back, and per simulation the residuals (measured minus simulated) of Fy [N] and Mz [Nm], (n,).
    """
    truth = virtual_rig.simulate(rig_toml, folder)
    tyre = tir.read(virtual_rig.load_plan(rig_toml).tyre_path)
    measured = points.read(config.load(f"{folder}/tyre.toml")).points
    residuals = {}
    for name, simulation in models(tyre, truth.faults).items():
        found = simulation.readings(measured)
        residuals[name] = (measured.Fy - found.Fy, measured.Mz - found.Mz)
    return measured, residuals


def picture(
    measured: points.Points, residuals: Mapping[str, tuple[np.ndarray, np.ndarray]], path: str
) -> None:
    """Draw side force and aligning moment over camber at zero sideslip: points, and a line per simulation."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(8, 2.8), layout="constrained")
    load = np.median(measured.Fz)
    chosen = (
        (measured.alpha == 0.0)
        & (measured.Fz == load)
        & (measured.direction == 1)
        & (measured.p == np.median(measured.p))
    )
    gamma = np.degrees(measured.gamma)
    for channel, (values, unit) in enumerate(
        ((measured.Fy, "side force [N]"), (measured.Mz, "aligning moment [Nm]"))
    ):
        rows = np.flatnonzero(chosen)[np.argsort(gamma[chosen])]
        axes[channel].plot(gamma[rows], values[rows], "o", markersize=4, color="0.3", label="sweep")
        for name, rest in residuals.items():
            axes[channel].plot(gamma[rows], (values - rest[channel])[rows], label=name)
        axes[channel].set(xlabel="camber [deg]", ylabel=unit)
        axes[channel].grid(alpha=0.3)
    axes[0].legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=90)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("rig_toml")
    parser.add_argument("folder")
    parser.add_argument("--picture")
    given = parser.parse_args()
    measured, residuals = compare(given.rig_toml, given.folder)
    print(f"{len(measured)} points; root mean square of the residuals:")
    for name, (Fy, Mz) in residuals.items():
        print(f"{name:<20} Fy {np.sqrt(np.mean(Fy**2)):7.2f} N   Mz {np.sqrt(np.mean(Mz**2)):6.3f} Nm")
    if given.picture:
        picture(measured, residuals, given.picture)


if __name__ == "__main__":
    main()
