"""Correlation of the tyre's temperature with settings of the test plan, and the uncertainty that it causes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.fit.influences.nuisance_choice import NearSolution
from mffit.fit.influences.nuisances import NUISANCES, TEMPERATURE, Nuisance
from mffit.linearised.inputs import LEVELS
from mffit.points import Points, levels
from tir.parameters import BY_NAME

NEEDS: Mapping[str, frozenset[str]] = {
    "load": frozenset({"loads"}),
    "camber": frozenset({"camber", "coupled"}),
    "pressure": frozenset({"pressures", "pressure_loads"}),
    "longitudinal slip": frozenset({"kappa", "combined", "side_force"}),
    "sideslip": frozenset({"sideslips"}),
}
"""By setting, the needs of the coefficients that it determines; sideslip those that need nothing else."""


@dataclass(frozen=True, slots=True)
class Confounding:
    """A setting that is correlated with the tyre's temperature."""

    setting: str  #: in words, as in :data:`mffit.points.levels.KINDS`
    correlation: float  #: correlation ratio of temperature and setting, 0 to 1
    coefficient: str
    """The most affected coefficient among those that the setting determines; empty if none is fitted."""
    growth: float  #: standard uncertainty of ``coefficient`` over that with known temperature terms

    @property
    def widens(self) -> bool:
        """Whether the correlation makes a coefficient clearly more uncertain."""
        return self.growth > constants.WIDER_BANDS


def confoundings(fitted: Fitted) -> tuple[Confounding, ...]:
    """Settings correlated with the temperature that widen a coefficient or explain more than half of the temperature's variance.

    ``fitted`` may model the temperature or not; both cases are computed with the temperature terms free.
    """
    points = fitted.problem.points
    nuisance = next(n for n in NUISANCES if n.id == TEMPERATURE)
    if nuisance.lacking(points):
        return ()
    along = {kind.name: correlation_ratio(points, name) for name, kind in LEVELS.items()}
    growth = _growth(fitted, nuisance)
    out = []
    for setting, r in along.items():
        worst = max(_determined_by(setting, growth), key=lambda name: growth[name], default=None)
        found = Confounding(setting, r, worst or "", growth[worst] if worst else 1.0)
        if found.widens or r**2 > 0.5:
            out.append(found)
    return tuple(out)


def _determined_by(setting: str, names: Sequence[str] | Mapping[str, float]) -> list[str]:
    """The named coefficients that a setting determines."""
    words = {name: {need.word for need in BY_NAME[name].needs} for name in names}
    needs = NEEDS[setting]
    return [name for name, own in words.items() if (own <= needs if setting == "sideslip" else needs & own)]


def correlation_ratio(points: Points, channel: str) -> float:
    """Correlation ratio of the temperature over the levels of a setting: square root of the explained share of variance.

    Unlike a linear correlation it detects a temperature that is highest at the middle one of three pressures.
    """
    label = levels.nearest_labels(np.abs(getattr(points, channel)), LEVELS[channel])
    T = points.T
    means = {k: float(np.mean(T[label == k])) for k in np.unique(label)}
    between = np.array([means[k] for k in label])
    total = float(np.var(T))
    return float(np.sqrt(np.var(between) / total)) if total > 0.0 else 0.0


def _growth(fitted: Fitted, temperature: Nuisance) -> dict[str, float]:
    """By coefficient, its standard uncertainty with free temperature terms over that with known terms."""
    numbers = [number for number in fitted.numbers if number.name not in temperature.numbers]
    near = NearSolution(fitted.problem, numbers, ())
    joint = near.joint(fitted.problem.points.sweep, [temperature])
    free, known = (
        np.sum(joint.model.posterior(given).root ** 2, axis=1)
        for given in (joint.alike(), joint.alike(temperature.numbers))
    )
    return {
        name: float(np.sqrt(more / less))
        for name, more, less in zip(joint.names, free, known, strict=True)
        if name in fitted.values and name not in fitted.regularised
    }


def confounding_sentence(found: Confounding, *, modelled: bool) -> str:
    """A sentence: the correlated setting, the effect on coefficients, and the remedy."""
    growth = f"{found.coefficient} {found.growth:.1f} times as uncertain as at one temperature"
    if not found.widens:
        effect = (
            f"model error over the {found.setting} is taken for an effect of the temperature, and the reverse"
        )
    elif modelled:
        effect = f"this makes {growth}"
    else:
        effect = f"the coefficients may contain the warming, and temperature terms would make {growth}"
    return (
        f"the tyre's temperature runs along with the {found.setting} (correlation {found.correlation:.2f}): {effect}; "
        f"repeat one {found.setting} warm and cold, or mix the order of the runs"
    )
