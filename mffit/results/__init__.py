"""The results of the workflows, and their JSON."""

from mffit.results.records import CORRECTION, BuildOutcome, BuildResult
from mffit.results.verification import Verification

__all__ = ["CORRECTION", "BuildOutcome", "BuildResult", "Verification"]
