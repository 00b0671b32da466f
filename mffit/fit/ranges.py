"""The ranges of a tyre: those that the data cover, and those that the written file allows."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.fit.constraints import MARGIN, Envelope, violations
from mffit.points import Points
from tir.evaluate import evaluate

SHARES = (1.0, 0.75, 0.5, 0.25)
"""Shares of the way from the tested end of a range to the wished one that are tried, the longest first."""
SIDESLIP, CAMBER = math.radians(20.0), math.radians(45.0)
LOW_LOAD, HIGH_LOAD, PRESSURE = 0.1, 1.5, 0.2
REMAINING = 0.5
"""Share of its peak that the side force keeps up to the end of the sideslip range of a plausible tyre."""
NAMES = ("PRESMIN", "PRESMAX", "FZMIN", "FZMAX", "ALPMIN", "ALPMAX", "CAMMIN", "CAMMAX")


def tested_ranges(points: Points) -> dict[str, float]:
    """FZ, ALP, CAM and PRES limits [N, rad, Pa] of the set-points, exactly as run."""
    alpha, gamma = float(np.max(np.abs(points.alpha))), float(np.max(np.abs(points.gamma)))
    return {
        "PRESMIN": float(np.min(points.p)),
        "PRESMAX": float(np.max(points.p)),
        "FZMIN": float(np.min(points.Fz)),
        "FZMAX": float(np.max(points.Fz)),
        "ALPMIN": -alpha,
        "ALPMAX": alpha,
        "CAMMIN": -gamma,
        "CAMMAX": gamma,
    }


def covered_ranges(points: Points) -> dict[str, float]:
    """The tested ranges for the fit's own limits; a pressure run alone gets 10 % either way."""
    ranges = tested_ranges(points)
    low, high = ranges["PRESMIN"], ranges["PRESMAX"]
    if high - low < 0.05 * high:
        ranges["PRESMIN"], ranges["PRESMAX"] = 0.9 * low, 1.1 * high
    return ranges


def envelope(ranges: Mapping[str, float]) -> Envelope:
    """The same ranges for the physical limits of the fit."""
    return Envelope(
        Fz=(ranges["FZMIN"], ranges["FZMAX"]),
        gamma=ranges["CAMMAX"],
        alpha=ranges["ALPMAX"],
        pressure=(ranges["PRESMIN"], ranges["PRESMAX"]),
    )


def plausible_ranges(
    values: Mapping[str, Any], tested: Mapping[str, float], *, turn_slip: bool
) -> dict[str, float]:
    """The ranges to write: as far beyond the tested ones as the model stays plausible.

    Simulations hold their inputs to the ranges of the file or fade forces out beyond them, so that tested ranges would
    make a wheel with 9 degrees of sideslip stop answering. Wished are a tenth of the smallest and one and a half of the
    largest load, 20 degrees of sideslip, a fifth of the pressure either way. Camber grows by half, to 45 degrees at most,
    and not at all beyond: there the quadratic term of the curvature makes the formula worse inside for what it wins
    outside. Each end goes as far as the limits of :mod:`mffit.fit.constraints` hold and the side force neither reverses
    nor falls below half its peak.

    Parameters
    ----------
    values : every value of the file
    tested : from :func:`tested_ranges`
    turn_slip : whether the model is right with turn slip on
    """
    model = SimpleNamespace(**values)
    alpha, gamma = tested["ALPMAX"], tested["CAMMAX"]
    wished = {
        "FZMIN": LOW_LOAD * tested["FZMIN"],
        "FZMAX": HIGH_LOAD * tested["FZMAX"],
        "PRESMIN": (1.0 - PRESSURE) * tested["PRESMIN"],
        "PRESMAX": (1.0 + PRESSURE) * tested["PRESMAX"],
        "CAMMAX": max(gamma, min(1.5 * gamma, CAMBER)),
        "ALPMAX": max(SIDESLIP, alpha),
    }
    ranges = dict(tested)
    breach = max(MARGIN, _breach(model, ranges)) + 1e-9
    for name, end in wished.items():
        for share in SHARES:
            wider = _with_end(ranges, name, tested[name] + share * (end - tested[name]))
            if _breach(model, wider) <= breach and _holds_its_force(model, wider, alpha, turn_slip):
                ranges = wider
                break
    return ranges


def _with_end(ranges: Mapping[str, float], name: str, value: float) -> dict[str, float]:
    mirrored = {name.replace("MAX", "MIN"): -value} if name in ("CAMMAX", "ALPMAX") else {}
    return {**ranges, name: value, **mirrored}


def _breach(model: Any, ranges: Mapping[str, float]) -> float:
    """The worst violation of a physical limit, the loads below and above the middle looked at in turn."""
    low, high = ranges["FZMIN"], ranges["FZMAX"]
    middle = 0.5 * (low + high)
    halves = ((low, middle), (middle, high))
    return max(float(violations(model, envelope(ranges)._replace(Fz=loads)).max()) for loads in halves)


def _holds_its_force(model: Any, ranges: Mapping[str, float], tested_alpha: float, turn_slip: bool) -> bool:
    """Whether the side force opposes large sideslip up to the end of the range, at every load, upright and leant."""
    slip = np.linspace(min(tested_alpha, 0.07), ranges["ALPMAX"], 13)
    alpha, gamma, Fz = np.meshgrid(
        np.concatenate([-slip[::-1], slip]),
        np.array([-0.5, 0.0, 0.5]) * ranges["CAMMAX"],
        np.linspace(ranges["FZMIN"], ranges["FZMAX"], 3),
        indexing="ij",
    )
    Fy = evaluate(model, Fz, alpha, gamma, turn_slip=turn_slip)[0].Fy
    span = Fy[: len(slip)][::-1] - Fy[len(slip) :]  # of opposite sideslip, so that camber thrust cancels
    return bool(np.all(span > 0.0) and np.all(span[-1] >= REMAINING * span.max(axis=0)))
