"""Results as pages, pictures and text; computes nothing beyond what is needed to draw. See docs/report.md."""

from typing import TYPE_CHECKING

from mffit.on_demand import on_demand

if TYPE_CHECKING:
    from mffit.report.build import write_build
    from mffit.report.compare import write_comparison
    from mffit.report.diagnosis import write_diagnosis
    from mffit.report.fleet import write_fleet
    from mffit.report.plan import write_plan

__getattr__ = on_demand(__name__)
