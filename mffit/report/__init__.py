"""Results as pages, pictures and text; computes nothing beyond what is needed to draw. See docs/report.md."""

from mffit.report.build import write_build
from mffit.report.diagnosis import write_diagnosis

__all__ = ["write_build", "write_diagnosis"]
