"""A set of effects, fitted together, with its evidence."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from mffit.diagnosis.smooth import NO_SMOOTH, Smooth
from mffit.effects import Effect
from mffit.rig import Simulation
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True)
class Hypothesis(ReadOnlyArrays):
    """A set of effects with fitted numbers."""

    effects: tuple[Effect, ...]
    numbers: Mapping[str, float]  #: fitted value of every freed number
    stderr: Mapping[str, float]
    chi2: float
    log_evidence: float
    """Up to a constant common to all hypotheses about the same data; includes smooth structure, if that is allowed."""
    state: Simulation
    residual: np.ndarray  #: whitened residual (m,)
    jacobian: np.ndarray  #: whitened derivatives (m, k) by the free numbers
    smooth: Smooth = NO_SMOOTH  #: the most likely smooth structure in addition to the effects
    alone: float = -math.inf  #: log evidence without smooth structure

    @property
    def ids(self) -> frozenset[str]:
        """The ids of the effects, without order."""
        return frozenset(effect.id for effect in self.effects)

    @property
    def axes(self) -> np.ndarray:
        """Orthonormal basis (m, k) of the changes of whitened readings that the fitted numbers can produce."""
        return np.linalg.qr(self.jacobian)[0] if self.jacobian.shape[1] else self.jacobian

    def apart(self, rival: Hypothesis) -> float:
        """Expected chi2 by which these readings separate two fitted hypotheses, if one of them is true."""
        return float(np.sum((self.residual - rival.residual) ** 2))

    def ahead(self, rival: Hypothesis) -> float:
        """Log likelihood less that of a rival, with the penalty of BIC: half the log number of readings per free number.

        Unlike the evidence it does not depend on priors, that is on usual sizes of effects and declarations.
        """
        more = len(rival.stderr) - len(self.stderr)
        return 0.5 * (rival.chi2 - self.chi2 + more * math.log(max(len(self.residual), 1)))

    def excludes(self, rival: Hypothesis, chance: float) -> bool:
        """Whether the readings exclude a rival: if it were true, it would fall so far behind with at most this probability.

        If the rival is true, twice its lead is normal with mean d and variance 4 d, where d is the chi2 between the two.
        """
        d = self.apart(rival)
        return 2.0 * self.ahead(rival) + d > -2.0 * float(ndtri(chance)) * math.sqrt(d)

    def others(self, effect: Effect) -> tuple[Effect, ...]:
        """All effects except one."""
        return tuple(other for other in self.effects if other.id != effect.id)

    def numbers_of(self, effects: Sequence[Effect]) -> dict[str, float]:
        """The fitted numbers of some of the effects."""
        names = {name for effect in effects for name in effect.parameters}
        return {name: value for name, value in self.numbers.items() if name in names}
