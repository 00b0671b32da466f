"""What a fit leaves of the readings, as one linear Gaussian model that every later question asks."""

from mffit.linearised.fitted import LinearisedChannel, LinearisedFit, Uncertain, linearised

__all__ = ["LinearisedChannel", "LinearisedFit", "Uncertain", "linearised"]
