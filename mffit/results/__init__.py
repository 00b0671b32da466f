"""The results of the workflows, and their JSON."""

from mffit.results.records import CORRECTION, BuildOutcome, BuildResult

__all__ = ["CORRECTION", "BuildOutcome", "BuildResult"]
