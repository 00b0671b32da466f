"""Steering torque and sideslip of a motorcycle in a steady corner, for two values of the camber reduction factor.

``python motorcycle_cornering.py front.tir rear.tir [--lean 45] [--picture FILE.png]``

The model is one rigid body of machine and rider with two wheels, a steered front wheel and toroidal tyres. All six force
and moment equations hold, including gyroscopic moments of the wheels. Neglected: pitch from steering, offset of the
fork's mass from the steering axis, aerodynamic drag. x forwards along the rear wheel's track, y left, z up; in a left-hand
corner, yaw rate, lean, steering angle and steering torque are positive.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import root

import tir

G = 9.81
UP = np.array([0.0, 0.0, 1.0])
DEFAULT = 0.5
"""Camber reduction factor of nearly all files in which it was not measured."""


@dataclass(frozen=True)
class Motorcycle:
    """A sports motorcycle with its rider."""

    front: tir.Tyre
    rear: tir.Tyre
    mass: float = 265.0  #: [kg]
    inertia: tuple[float, float, float] = (26.0, 42.0, 30.0)  #: about x, y, z of the machine [kg m2]
    wheelbase: float = 1.41  #: [m]
    b: float = 0.70  #: centre of gravity in front of the rear contact [m]
    h: float = 0.62  #: and above the road [m]
    caster: float = math.radians(24.0)  #: [rad]
    trail: float = 0.09  #: of the front contact behind the steering axis, across it [m]
    crowns: tuple[float, float] = (0.055, 0.085)  #: radius of the tyres' cross-sections, front and rear [m]
    spins: tuple[float, float] = (0.50, 0.75)  #: moment of inertia of the wheels about their axles [kg m2]


class Corner(NamedTuple):
    """A steady corner."""

    yaw_rate: float  #: [rad/s]
    steer: float  #: steering angle [rad]
    torque: float  #: torque that the rider applies, > 0 to the left [Nm]
    sideslip: tuple[float, float]  #: front and rear [rad]
    loads: tuple[float, float]  #: front and rear [N]
    residuals: np.ndarray  #: of the force and moment equations (6,) [N, Nm]


def corner(machine: Motorcycle, speed: float, lean: float) -> Corner:
    """The steady corner at a speed [m/s] and lean [rad].

    Raises
    ------
    ValueError
        If no steady corner was found.
    """
    yaw_rate = G * math.tan(lean) / speed
    steer = machine.wheelbase * yaw_rate / speed * math.cos(lean)
    weight = machine.mass * G
    share = machine.b / machine.wheelbase
    start = [0.0, yaw_rate, steer, 0.0, share * weight, (1.0 - share) * weight]
    scale = np.array([speed / 100.0, 1.0, 0.1, 0.01, weight, weight])
    found = root(
        lambda x: _balance(machine, speed, lean, *(x * scale))[0] / weight, np.array(start) / scale, tol=1e-13
    )
    if not found.success and np.max(np.abs(found.fun)) > 1e-9:
        raise ValueError(f"no steady corner at {speed:g} m/s and {math.degrees(lean):g} deg: {found.message}")
    left, details = _balance(machine, speed, lean, *(found.x * scale))
    _, yaw_rate, steer, _, front, rear = (float(x) for x in found.x * scale)
    return Corner(yaw_rate, steer, details[0], details[1], (front, rear), left)


def _balance(
    machine: Motorcycle, speed: float, lean: float, slide, yaw_rate, steer, kappa, load_front, load_rear
):
    """Residuals of the force and moment equations (6,), and steering torque with the sideslip angles.

    slide: lateral speed of the rear contact, to the left; kappa: longitudinal slip of the rear tyre, which drives the machine.
    """
    leaning = _rotation(np.array([1.0, 0.0, 0.0]), -lean)
    front_radius, rear_radius = machine.front["UNLOADED_RADIUS"], machine.rear["UNLOADED_RADIUS"]
    # positions of the upright machine, from the centre of the rear wheel
    middle = np.array([machine.b, 0.0, machine.h - rear_radius])
    hub = np.array([machine.wheelbase, 0.0, front_radius - rear_radius])
    axis = np.array([-math.sin(machine.caster), 0.0, math.cos(machine.caster)])
    head = (
        hub
        - front_radius * UP
        + machine.trail * np.array([math.cos(machine.caster), 0.0, math.sin(machine.caster)])
    )
    turned = _rotation(axis, steer)
    hub = head + turned @ (hub - head)
    axles = [leaning @ turned @ np.array([0.0, 1.0, 0.0]), leaning @ np.array([0.0, 1.0, 0.0])]
    middle, hub, head, axis = (leaning @ x for x in (middle, hub, head, axis))
    contacts = [
        hub + _lowest(axles[0], front_radius, machine.crowns[0]),
        _lowest(axles[1], rear_radius, machine.crowns[1]),
    ]

    turning = yaw_rate * UP
    force, moment = -machine.mass * G * UP, np.zeros(3)
    momentum = leaning @ np.diag(machine.inertia) @ leaning.T @ turning
    torque, angles = 0.0, []
    wheels = zip(
        (machine.front, machine.rear),
        contacts,
        axles,
        (load_front, load_rear),
        (0.0, kappa),
        machine.spins,
        strict=True,
    )
    for i, (tyre, contact, axle, load, slip, spin) in enumerate(wheels):
        ahead = np.cross(axle, UP) / np.linalg.norm(np.cross(axle, UP))
        across = np.cross(UP, ahead)
        velocity = np.array([speed, slide, 0.0]) + np.cross(turning, contact - contacts[1])
        along, sliding = float(velocity @ ahead), float(velocity @ across)
        alpha, gamma = math.atan(sliding / along), math.asin(axle[2])
        condition = (
            float(load),
            alpha,
            gamma,
            float(slip),
            float(-yaw_rate / math.hypot(along, sliding)),
            along,
        )
        out = tyre(*condition)
        pull = out.Fx * ahead + out.Fy * across + load * UP
        twist = out.Mx * ahead + out.My * across + out.Mz * UP
        wheel = spin * tyre.state(*condition).omega * axle
        force = force + pull
        moment = moment + np.cross(contact - middle, pull) + twist
        momentum = momentum + wheel
        angles.append(alpha)
        if i == 0:
            torque = axis @ (np.cross(turning, wheel) - np.cross(contact - head, pull) - twist)
    velocity = np.array([speed, slide, 0.0]) + np.cross(turning, middle - contacts[1])
    left = [force - machine.mass * np.cross(turning, velocity), moment - np.cross(turning, momentum)]
    return np.concatenate(left), (float(torque), tuple(angles))


def _rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation matrix for angle [rad] about a unit vector (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


def _lowest(axle: np.ndarray, radius: float, crown: float) -> np.ndarray:
    """Vector from the centre of a wheel to its contact point; the tyre is a torus."""
    upwards = UP - (UP @ axle) * axle
    return -(radius - crown) * upwards / np.linalg.norm(upwards) - crown * UP


def with_factor(machine: Motorcycle, front: float, rear: float) -> Motorcycle:
    """The same machine on tyres with these camber reduction factors."""
    return Motorcycle(machine.front.replace(PECP1=front), machine.rear.replace(PECP1=rear))


def picture(speeds: np.ndarray, runs: dict[str, list[Corner]], path: str) -> None:
    """Draw steering torque and sideslip over speed."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(9, 2.8), layout="constrained")
    for name, found in runs.items():
        axes[0].plot(speeds, [c.torque for c in found], label=name)
        for k in (0, 1):
            axes[1 + k].plot(speeds, [math.degrees(c.sideslip[k]) for c in found])
    labels = ("steering torque [Nm]", "sideslip of the front tyre [deg]", "sideslip of the rear tyre [deg]")
    for each, label in zip(axes, labels, strict=True):
        each.set(xlabel="speed [m/s]", ylabel=label)
        each.grid(alpha=0.3)
    axes[0].legend(frameon=False)
    figure.savefig(path, dpi=90)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("front")
    parser.add_argument("rear")
    parser.add_argument("--lean", type=float, default=45.0, help="deg")
    parser.add_argument("--picture")
    given = parser.parse_args()
    machine = Motorcycle(tir.read(given.front), tir.read(given.rear))
    machines = {"measured": machine, f"default {DEFAULT:g}": with_factor(machine, DEFAULT, DEFAULT)}
    speeds = np.arange(10.0, 31.0, 2.5)
    runs = {name: [corner(m, v, math.radians(given.lean)) for v in speeds] for name, m in machines.items()}
    print(f"{'eps_gamma':<13} speed  radius  torque  sideslip front, rear")
    for name, found in runs.items():
        for v, c in list(zip(speeds, found, strict=True))[:: len(speeds) // 2]:
            alpha = ", ".join(f"{math.degrees(a):.2f}" for a in c.sideslip)
            print(f"{name:<13} {v:>3g} m/s {v / c.yaw_rate:>5.1f} m {c.torque:>5.1f} Nm {alpha} deg")
    if given.picture:
        picture(speeds, runs, given.picture)


if __name__ == "__main__":
    main()
