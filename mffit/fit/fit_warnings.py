"""Warnings of a fit in sentences."""

from __future__ import annotations

from collections.abc import Sequence

from mffit.fit.fitted import Fitted
from mffit.suspicion import Doubt, Outlier, outliers_sentence


def warnings(
    fitted: Fitted, distrusted: Sequence[str], doubts: Sequence[Doubt], outlying: Sequence[Outlier]
) -> tuple[str, ...]:
    """All warnings of a fit, the most important first."""
    out = [*distrusted]
    if fitted.attempts:
        attempts = ", ".join(fitted.attempts)
        out.append(f"the fit was started again from {attempts}; the best of all fits is kept")
    if fitted.at_bound:
        names = ", ".join(sorted(fitted.at_bound))
        out.append(f"at the bound of plausible values: {names}; check the sweeps that determine them")
    out += [doubt.sentence for doubt in doubts]
    if outlying:
        out.append(outliers_sentence(outlying))
    return tuple(out)
