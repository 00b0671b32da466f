"""Response of a single-track car to a step of the steering angle, with and without the lag of the tyres.

``python step_steer.py front.tir [rear.tir] [--picture FILE.png]``

Two axles, each with a pair of mirrored tyres; constant speed, no roll. x forwards, y left; yaw to the left is positive.
The lag is that of ``tir.transient``.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass

import numpy as np

import tir
from tir.transient import Contact, step

G = 9.81


@dataclass(frozen=True)
class Car:
    """Tyres, mass, yaw inertia and distances of the axles from the centre of gravity."""

    front: tir.Tyre
    rear: tir.Tyre
    mass: float = 1400.0  #: [kg]
    inertia: float = 2200.0  #: [kg m2]
    a: float = 1.1  #: to the front axle [m]
    b: float = 1.6  #: to the rear axle [m]

    @property
    def loads(self) -> tuple[float, float]:
        """Load of a front and a rear tyre [N]."""
        half = 0.5 * self.mass * G / (self.a + self.b)
        return half * self.b, half * self.a


def axle_force(tyre: tir.Tyre, load: float, alpha: float, Vx: float) -> float:
    """Steady side force [N] of a pair of mirrored tyres at sideslip alpha [rad]."""
    return tyre(load, alpha, Vx=Vx).Fy - tyre(load, -alpha, Vx=Vx).Fy


def axle_stiffnesses(car: Car, Vx: float, small: float = 1e-5) -> tuple[float, float]:
    """Cornering stiffness of front and rear axle [N/rad]: magnitude of the slope of the side force at zero."""
    pairs = zip((car.front, car.rear), car.loads, strict=True)
    front, rear = (-axle_force(tyre, load, small, Vx) / small for tyre, load in pairs)
    return front, rear


def understeer_gradient(car: Car, Vx: float) -> float:
    """Understeer gradient K [rad s2/m] in delta = L/R + K ay: K = m/L (b/C_front - a/C_rear)."""
    front, rear = axle_stiffnesses(car, Vx)
    return car.mass / (car.a + car.b) * (car.b / front - car.a / rear)


def simulate(
    car: Car, Vx: float, delta: float, seconds: float, *, lag: bool = True, dt: float = 1e-3
) -> dict[str, np.ndarray]:
    """Motion of the car after a step of the steering angle by delta [rad] at speed Vx [m/s].

    Returns
    -------
    dict
        ``t`` [s], ``yaw_rate`` [rad/s], ``ay`` [m/s2], ``sideslip`` [rad] of the car: arrays (n,).
    """
    vy = yaw_rate = 0.0
    contacts = [Contact(), Contact()]
    mirrored = [Contact(), Contact()]
    cos, sin = math.cos(delta), math.sin(delta)
    out: dict[str, list[float]] = {"t": [], "yaw_rate": [], "ay": [], "sideslip": []}
    for i in range(round(seconds / dt)):
        lateral_front = vy + car.a * yaw_rate
        speeds = (  # along and across each wheel
            (Vx * cos + lateral_front * sin, lateral_front * cos - Vx * sin),
            (Vx, vy - car.b * yaw_rate),
        )
        forces = []
        for k, (tyre, load) in enumerate(zip((car.front, car.rear), car.loads, strict=True)):
            along, across = speeds[k]
            if lag:
                contacts[k], left = step(tyre, contacts[k], dt, load, along, Vsy=across)
                mirrored[k], right = step(tyre, mirrored[k], dt, load, along, Vsy=-across)
                forces.append(left.Fy - right.Fy)
            else:
                forces.append(axle_force(tyre, load, math.atan(across / along), along))
        front, rear = forces[0] * cos, forces[1]
        ay = (front + rear) / car.mass
        for name, value in zip(out, (i * dt, yaw_rate, ay, math.atan2(vy, Vx)), strict=True):
            out[name].append(value)
        vy += dt * (ay - Vx * yaw_rate)
        yaw_rate += dt * (car.a * front - car.b * rear) / car.inertia
    return {name: np.array(values) for name, values in out.items()}


def picture(runs: dict[str, dict[str, np.ndarray]], path: str) -> None:
    """Draw yaw rate and lateral acceleration over time."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(8, 2.8), layout="constrained")
    for name, run in runs.items():
        axes[0].plot(run["t"], np.degrees(run["yaw_rate"]), label=name)
        axes[1].plot(run["t"], run["ay"])
    axes[0].set(xlabel="time [s]", ylabel="yaw rate [deg/s]")
    axes[1].set(xlabel="time [s]", ylabel="lateral acceleration [m/s²]")
    axes[0].legend(frameon=False)
    for each in axes:
        each.grid(alpha=0.3)
    figure.savefig(path, dpi=90)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("front")
    parser.add_argument("rear", nargs="?")
    parser.add_argument("--picture")
    given = parser.parse_args()
    front = tir.read(given.front)
    car = Car(front, tir.read(given.rear) if given.rear else front)
    Vx, wanted = 25.0, 4.0
    K = understeer_gradient(car, Vx)
    delta = wanted * ((car.a + car.b) / Vx**2 + K)
    runs = {"with lag": simulate(car, Vx, delta, 0.8), "without": simulate(car, Vx, delta, 0.8, lag=False)}
    print(
        f"understeer gradient {math.degrees(K) * G:.2f} deg/g, steer {math.degrees(delta):.2f} deg at {Vx:g} m/s"
    )
    for name, run in runs.items():
        rate = np.degrees(run["yaw_rate"])
        half = run["t"][np.argmax(rate > rate[-1] / 2)]
        print(
            f"{name:<9} yaw rate {rate[-1]:.2f} deg/s, peak {rate.max():.2f} deg/s, half of it after {half:.3f} s"
        )
    if given.picture:
        picture(runs, given.picture)


if __name__ == "__main__":
    main()
