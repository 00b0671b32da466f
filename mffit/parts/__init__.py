"""Mirror symmetry: pairs of mirrored points, and the odd and even part of the readings."""

from mffit.parts.split import Parts, split
