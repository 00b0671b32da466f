"""The residuals of a fit as one linear Gaussian model, which answers every later question about predictions and evidence."""

from mffit.linearised.fitted import LinearisedChannel, LinearisedFit, Uncertain, linearised

__all__ = ["LinearisedChannel", "LinearisedFit", "Uncertain", "linearised"]
