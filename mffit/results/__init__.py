"""The results of the workflows, and their JSON."""

from mffit.results.records import BuildOutcome, BuildResult
from mffit.results.verification import Verification

__all__ = ["BuildOutcome", "BuildResult", "Verification"]
