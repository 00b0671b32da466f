"""Mirror symmetry: pairs of mirrored points, and the odd and even part of the readings."""

from mffit.parts.mirror import Mirrors, Tolerance, find_mirrors
from mffit.parts.split import Parts, split

__all__ = ["Mirrors", "Parts", "Tolerance", "find_mirrors", "split"]
