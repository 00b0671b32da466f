"""What the workflows return, and the JSON that is made of it."""

from mffit.results.build import BuildResult
from mffit.results.many import Outcome

__all__ = ["BuildResult", "Outcome"]
