"""The results of the workflows, and their JSON."""

from mffit.results.build import BuildResult
from mffit.results.many import Outcome

__all__ = ["BuildResult", "Outcome"]
