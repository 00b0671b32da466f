"""An independent disc rig for blind cases: its programme, its faults and its noise.

It uses nothing of ``mffit``. The faults are coded again from their definitions, so that a mistake in :mod:`mffit.rig` causes a
wrong diagnosis. Only the tyre's forces come from ``tir``, which has its own reference tests.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace
from zlib import crc32

import numpy as np

from tir import Tyre
from tir.evaluate import evaluate

SIDESLIP = (-8, -6, -5, -4, -3, -2, -1.5, -1, -0.5, 0, 0.5, 1, 1.5, 2, 3, 4, 5, 6, 8)  # deg
CAMBER = (-50, -40, -30, -20, -15, -10, -5, 0, 5, 10, 15, 20, 30, 40, 50)  # deg
ZEROS = (-1.0, -0.5, 0.0, 0.5, 1.0)  # deg
TURNS_WITH_THE_RIM = ("PVY1", "PVY2", "PEY3", "QDZ6", "QDZ7")
SECONDS_PER_POINT = 90.0
USUAL_SPEED = 6.0  # m/s
USUAL_TEMPERATURE = 34.0  # degC, about which the programme varies
WALK = 8  # steps through half the play
BISECTIONS = 16


@dataclass(frozen=True)
class Programme:
    """Set-points in the order in which they were run; arrays (n,)."""

    sweep: np.ndarray  #: name of the sweep
    alpha_deg: np.ndarray
    gamma_deg: np.ndarray
    Fz: np.ndarray  #: [N]
    p_kPa: np.ndarray
    V: np.ndarray  #: [m/s]
    backward: np.ndarray  #: bool
    flipped: np.ndarray  #: bool
    t: np.ndarray  #: [s]
    T: np.ndarray  #: [degC]

    def __len__(self) -> int:
        return len(self.alpha_deg)

    def where(self, mask: np.ndarray) -> Programme:
        """Some of the set-points, with their times and temperatures."""
        return replace(self, **{name: values[mask] for name, values in vars(self).items()})


def disc_programme(nominal: float, rng: np.random.Generator) -> Programme:
    """Three loads with sideslip, camber and zeros in both directions; coupled sweeps; two more pressures and speeds."""
    light, heavy = round(0.6 * nominal), round(1.5 * nominal)
    rows: list[tuple] = []

    def run(name, load, alphas=(0.0,), gammas=(0.0,), p=250.0, V=USUAL_SPEED, backward=False):
        rows.extend((name, a, g, float(load), p, V, backward) for g in gammas for a in alphas)

    for load in (light, nominal, heavy):
        run(f"sideslip_{load:.0f}", load, SIDESLIP)
        run(f"camber_{load:.0f}", load, gammas=CAMBER)
        run(f"zeros_{load:.0f}_forward", load, ZEROS)
        run(f"zeros_{load:.0f}_backward", load, ZEROS, backward=True)
    for gamma, load in ((10, nominal), (20, nominal), (35, nominal), (20, heavy)):
        run(f"coupled_{load:.0f}_{gamma}", load, SIDESLIP, (gamma, -gamma))
    for p in (200.0, 300.0):
        run(f"sideslip_{light}_{p:.0f}kPa", light, SIDESLIP, p=p)
        run(f"camber_{light}_{p:.0f}kPa", light, gammas=CAMBER, p=p)
    for V in (3.0, 12.0):
        run(f"sideslip_{light}_{V:.0f}mps", light, SIDESLIP, V=V)
    name, alpha, gamma, Fz, p, V, backward = map(np.array, zip(*rows, strict=True))
    t = SECONDS_PER_POINT * np.arange(len(rows))
    T = USUAL_TEMPERATURE + 7.0 * np.sin(t / rng.uniform(300.0, 900.0)) + rng.normal(0.0, 0.3, len(rows))
    flipped = np.zeros(len(rows), dtype=bool)
    return Programme(
        name, alpha.astype(float), gamma.astype(float), Fz, p, V, backward, flipped, t, np.round(T, 2)
    )


@dataclass(frozen=True)
class Machine:
    """Errors of the rig, ISO-W; the default is a perfect rig."""

    R: float = 1.323  #: true path radius [m], centre to the left
    alpha_0_deg: float = 0.0
    gamma_0_deg: float = 0.0
    gain: float = 1.0
    F0: float = 0.0  #: [N]
    M0: float = 0.0  #: [Nm]
    crosstalk: float = 0.0
    backlash_deg: float = 0.0
    k_T: float = 0.0  #: [1/K]
    k_V: float = 0.0  #: [s/m]
    k_t: float = 0.0  #: [1/s]
    compliance: float = 0.0  #: of the steering: the moment turns the wheel by this [deg/Nm]

    run_Fy: float = 0.0  #: standard deviation of the load cell's zero from run to run [N]
    run_Mz: float = 0.0  #: [Nm]
    run_alpha_deg: float = 0.0  #: of the sideslip axis' zero
    draw: int = 0  #: of what differs from run to run

    def with_faults(self, faults: Mapping[str, float]) -> Machine:
        return replace(self, **faults)


def of_each_run(run: Programme, size: float, seed: int) -> np.ndarray:
    """An offset (n,) for every run, drawn from its name, so that the same run always has the same offset."""
    names = run.sweep.tolist()
    drawn = {
        n: np.random.default_rng((seed, crc32(n.encode()))).normal() if size else 0.0 for n in set(names)
    }
    middle = np.mean(list(drawn.values()))  # what all runs have in common is another cause
    return size * np.array([drawn[name] - middle for name in names])


def report(
    tyre: Tyre, machine: Machine, run: Programme, *, turn_slip: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Fy [N] and Mz [Nm] that the rig reports without noise; arrays (n,)."""
    alpha = np.deg2rad(
        run.alpha_deg + machine.alpha_0_deg + of_each_run(run, machine.run_alpha_deg, machine.draw)
    )
    Fy, Mz = _at_the_tyre(tyre, machine, run, alpha, turn_slip)
    for _ in range(40 if machine.compliance else 0):  # halves its error in each round, or better
        yielding = alpha + np.deg2rad(machine.compliance) * Mz
        Fy, Mz = _at_the_tyre(tyre, machine, run, yielding, turn_slip)
    if machine.backlash_deg > 0.0:
        play = np.deg2rad(machine.backlash_deg)
        at_rest = resting(lambda x: _at_the_tyre(tyre, machine, run, x, turn_slip)[1], alpha, play, Mz)
        Fy, Mz = _at_the_tyre(tyre, machine, run, at_rest, turn_slip)
    surroundings = (1.0 + machine.k_T * (run.T - USUAL_TEMPERATURE)) * (
        1.0 + machine.k_V * (run.V - USUAL_SPEED)
    )
    surroundings = surroundings * (1.0 + machine.k_t * run.t)
    return (
        machine.gain * surroundings * Fy
        + machine.F0
        + machine.crosstalk * run.Fz
        + of_each_run(run, machine.run_Fy, machine.draw),
        surroundings * Mz + machine.M0 + of_each_run(run, machine.run_Mz, machine.draw),
    )


def resting(moment: Callable[[np.ndarray], np.ndarray], alpha: np.ndarray, play: float, Mz: np.ndarray):
    """Angles (n,) at which wheels come to rest that have play about ``alpha`` and start there with the moment ``Mz``.

    A positive moment turns the wheel to smaller angles, a negative one to larger, until it meets the end of the play or
    a point where the moment changes sign; there it floats without moment.
    """
    way = np.where(Mz > 0.0, -1.0, 1.0)
    start, turned = np.zeros(len(alpha)), np.full(len(alpha), np.nan)
    # Walked in small steps, so that the first turning point on the way is the one that stops the wheel.
    for share in np.linspace(0.0, 0.5, WALK + 1)[1:]:
        pushed = moment(alpha + way * share * play) * way < 0.0
        new = np.isnan(turned) & ~pushed
        turned[new] = share
        start[np.isnan(turned)] = share
    floats = np.isfinite(turned)
    near, far = start.copy(), np.where(floats, turned, 0.5)
    for _ in range(BISECTIONS if floats.any() else 0):
        middle = 0.5 * (near + far)
        pushed = moment(alpha + way * middle * play) * way < 0.0
        near, far = np.where(pushed, middle, near), np.where(pushed, far, middle)
    return alpha + way * np.where(floats, 0.5 * (near + far), 0.5) * play


def _at_the_tyre(
    tyre, machine: Machine, run: Programme, alpha, turn_slip: bool
) -> tuple[np.ndarray, np.ndarray]:
    """True Fy and Mz at true sideslip, for every mount and direction."""
    Fy, Mz = np.empty(len(run)), np.empty(len(run))
    gamma = np.deg2rad(run.gamma_deg + machine.gamma_0_deg)
    for flipped in (False, True):
        chosen = run.flipped == flipped
        if not chosen.any():
            continue
        values = SimpleNamespace(**tyre.values)
        for name in TURNS_WITH_THE_RIM if flipped else ():
            setattr(values, name, -getattr(values, name))
        V = np.where(run.backward, -run.V, run.V)[chosen]
        out, _ = evaluate(
            values, run.Fz[chosen], alpha[chosen], gamma[chosen], 0.0, -1.0 / machine.R, V, 1e3 * run.p_kPa[chosen],
            turn_slip=turn_slip,
        )  # fmt: skip
        Fy[chosen], Mz[chosen] = out.Fy, out.Mz
    return Fy, Mz
