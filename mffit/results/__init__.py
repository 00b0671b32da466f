"""What the workflows return, and the JSON that is made of it."""

from mffit.results.build import BuildResult

__all__ = ["BuildResult"]
