"""The virtual disc rig reproduces its own sweeps: a simulation that knows the path and the rig's faults, and ones that do not.

``python disc_rig.py rig.toml DIR [--picture FILE.png]`` writes the campaign to DIR, reads the files back
as those of a real rig, and asks the forward model of ``mffit.rig`` for the same points.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import asdict

import numpy as np

import tir
from mffit import config, points, virtual_rig
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS, Faults


def models(tyre: tir.Tyre, faults: Faults) -> dict[str, Simulation]:
    """The right simulation and two that lack something."""
    return {
        "path and faults": Simulation.of(tyre, faults),
        "path, a perfect rig": Simulation.of(tyre, NO_FAULTS),
        "straight path": Simulation.of(tyre, faults, turn_slip=False),
    }


def compare(rig_toml: str, folder: str) -> tuple[points.Points, Mapping[str, tuple[np.ndarray, np.ndarray]]]:
    """Test a tyre on the virtual rig and simulate the test.

    Returns
    -------
    Points, mapping
        The steady points as read back, and per model what is left of Fy [N] and Mz [Nm]: measured less simulated, (n,).
    """
    truth = virtual_rig.simulate(rig_toml, folder)
    tyre = tir.read(virtual_rig.load_plan(rig_toml).tyre_path)
    measured, _ = points.load(config.load(f"{folder}/tyre.toml"))
    left = {}
    for name, simulation in models(tyre, truth.faults).items():
        found = simulation.readings(measured)
        left[name] = (measured.Fy - found.Fy, measured.Mz - found.Mz)
    return measured, left


def picture(measured: points.Points, left: Mapping[str, tuple[np.ndarray, np.ndarray]], path: str) -> None:
    """Side force over camber at zero sideslip: points and lines."""
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
        ((measured.Fy, "side force [N]"), (measured.Mz, "self-aligning moment [Nm]"))
    ):
        rows = np.flatnonzero(chosen)[np.argsort(gamma[chosen])]
        axes[channel].plot(gamma[rows], values[rows], "o", markersize=4, color="0.3", label="sweep")
        for name, rest in left.items():
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
    measured, left = compare(given.rig_toml, given.folder)
    print(f"{len(measured)} points; root mean square of what is left:")
    for name, (Fy, Mz) in left.items():
        print(f"{name:<20} Fy {np.sqrt(np.mean(Fy**2)):7.2f} N   Mz {np.sqrt(np.mean(Mz**2)):6.3f} Nm")
    if given.picture:
        picture(measured, left, given.picture)


if __name__ == "__main__":
    main()
