"""The results of the workflows, and their JSON."""

from mffit.results.records import BuildOutcome, BuildResult

__all__ = ["BuildOutcome", "BuildResult"]
