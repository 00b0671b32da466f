"""Results as pages, pictures and text; computes nothing beyond what is needed to draw. See docs/report.md."""

from mffit.report.build import write_build
from mffit.report.diagnosis import write_diagnosis
from mffit.report.fleet import write_fleet

__all__ = ["write_build", "write_diagnosis", "write_fleet"]
