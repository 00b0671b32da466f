"""Whether the declared errors of a rig can explain what its readings differ from a file by, or only the tyre can."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from mffit.as_json import keys
from mffit.config import Config
from mffit.config.rig_declaration import declared_rig
from mffit.constants import (
    COVERAGE_FACTOR_95,
    EXPLAINED_SHARE,
    FALSE_ALARM,
    TWO_SIGMA,
    USUAL_CORNERING_STIFFNESS,
)
from mffit.fit.plan import channels_of
from mffit.linearised.gaussian import Informed
from mffit.points import Points
from mffit.points.noise import estimated_noise, stating
from mffit.rig import Simulation
from mffit.rig_errors import BY_NAME, OF_RUN, ZEROS
from mffit.scatter import rms
from tir import Quantity


@dataclass(frozen=True, slots=True)
class ExplainedByRig:
    """The gap between readings and a file, with the errors of the rig at their most probable values.

    Each error counts with what is declared of it, all together, to first order; coefficients of the tyre stay as in the file.
    """

    errors: Mapping[str, Quantity]
    """Those that differ from what is declared, in units of their key, the clearest first."""
    beyond: tuple[str, ...]  #: those of these that are larger than declared, the farthest first
    left: Mapping[str, float]  #: rms of every channel that remains with them
    share: float  #: of what exceeds the noise, the part (of chi-square) that they leave
    is_noise: bool  #: whether chance alone makes such a gap
    is_plausible: bool  #: whether errors of this size agree with what is declared
    leaves_noise: bool  #: whether chance alone makes what remains
    of_formula: bool = False  #: whether what the build of the file states that it misses counts as noise

    @property
    def suffices(self) -> bool:
        """Whether the errors explain all of the gap."""
        return self.is_plausible and self.leaves_noise

    @property
    def fits(self) -> bool:
        """Whether errors of any size explain most of the gap."""
        return self.leaves_noise or self.share < EXPLAINED_SHARE

    @property
    def mostly(self) -> bool:
        """Whether the errors explain most of the gap."""
        return self.is_plausible and self.fits


keys(ExplainedByRig, "errors beyond left share is_noise suffices mostly")


def declared_errors(config: Config, setups: Sequence[str], channels: Collection[str]) -> dict[str, float]:
    """Standard uncertainty of every error that the rig may have in some channels; several set-ups have zeros of their own."""
    declared = declared_rig(config.rig, USUAL_CORNERING_STIFFNESS * config.tyre.nominal_load)
    spreads = {name: one.u for name, one in declared.items()}
    spreads |= {error.name: error.spread for error in ZEROS if not error.declared}
    found: dict[str, float] = {}
    for name, u in spreads.items():
        if BY_NAME[name].shows_in(channels):
            several = BY_NAME[name].of_setup and len(setups) > 1
            found |= dict.fromkeys([f"{name}{OF_RUN}{one}" for one in setups] if several else [name], u)
    return found


def explained_by_rig(
    points: Points,
    simulation: Simulation,
    declared: Mapping[str, float],
    missed: Mapping[str, float] | None = None,
) -> ExplainedByRig | None:
    """How far errors of the rig explain the readings; None if none is declared.

    ``declared`` has the standard uncertainty of each error by name, in its unit; ``missed``, by channel, the rms by which the
    file is known to miss readings, which counts as noise.
    """
    if not declared:
        return None
    read, slopes = simulation.sensitivities(points, [*declared], channels_of(points))
    spread = np.array([*declared.values()])
    apart = {name: points.channel(name) - model for name, model in read.items()}
    silent = estimated_noise(points, read)
    gap, columns = [], []
    for name, rest in apart.items():
        u = np.where(stating(points.u(name)), points.u(name), silent[name])
        u = np.hypot(u, (missed or {}).get(name, 0.0))
        known = np.isfinite(rest) & stating(u)
        gap.append(rest[known] / u[known])
        columns.append(slopes[name][known] * spread / u[known, None])
    seen, moved = np.concatenate(gap), np.concatenate(columns)
    found = Informed.of_rows(moved, seen)
    size, n, before = found.mean, len(seen), float(seen @ seen)
    after = before - float(found.pull @ size)
    errors = {
        name: Quantity(float(x * u), float(u_x * u), "")
        for name, x, u_x, u in zip(declared, size, found.u, spread, strict=True)
        if abs(x) > COVERAGE_FACTOR_95 * u_x
    }
    errors = dict(sorted(errors.items(), key=lambda item: -abs(item[1].value) / item[1].u))
    over = {name: abs(one.value) / declared[name] for name, one in errors.items()}
    return ExplainedByRig(
        errors=errors,
        beyond=tuple(
            sorted((name for name in errors if over[name] > TWO_SIGMA), key=lambda name: -over[name])
        ),
        left={name: rms(rest - slopes[name] @ (size * spread)) for name, rest in apart.items()},
        share=max(after - n, 0.0) / max(before - n, 1.0),
        is_noise=bool(chdtrc(n, before) > FALSE_ALARM),
        is_plausible=bool(chdtrc(len(size), size @ size) > FALSE_ALARM),
        leaves_noise=bool(chdtrc(n, after) > FALSE_ALARM),
        of_formula=bool(missed),
    )
