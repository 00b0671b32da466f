"""The results of the workflows, and their JSON."""

from mffit.results.records import BuildResult, Outcome

__all__ = ["BuildResult", "Outcome"]
