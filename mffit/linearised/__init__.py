"""Linear Gaussian models of what readings hold beyond the tyre, for the residuals of a fit and for a diagnosis.

``gaussian`` is the estimate of numbers with known priors, ``mixed`` adds random effects of groups, ``chained`` is a sum of
declared terms with errors that are autocorrelated; ``components`` declares the terms of a fit's residuals, ``search`` finds
the most probable parameters.
"""

from mffit.linearised.channel import LinearisedChannel, Uncertain
from mffit.linearised.fitted import LinearisedFit, linearised
