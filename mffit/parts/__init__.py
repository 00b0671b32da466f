"""Mirror symmetry: which point is the reflection of which, and the odd and even part of what was measured."""

from mffit.parts.mirror import Mirrors, Tolerance, find_mirrors
from mffit.parts.split import Parts, split

__all__ = ["Mirrors", "Parts", "Tolerance", "find_mirrors", "split"]
