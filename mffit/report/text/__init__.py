"""Plain text for a terminal: functions of records that return str."""

from typing import TYPE_CHECKING

from mffit.on_demand import on_demand

if TYPE_CHECKING:
    from mffit.report.text.build import build_explained, build_summary, few, warnings_beside
    from mffit.report.text.compare import comparison_table
    from mffit.report.text.convert import conversion_summary
    from mffit.report.text.diagnosis import diagnosis_summary, models_written
    from mffit.report.text.direct import alignment_table, budget_table, spin_summary
    from mffit.report.text.layout import steps
    from mffit.report.text.many import fleet_summary, lacking, many_line, many_summary
    from mffit.report.text.plan import plan_summary
    from mffit.report.text.prediction import prediction_summary
    from mffit.report.text.recordings import sniff_summary
    from mffit.report.text.watching import arrival_line, campaign_lines, campaign_text

__getattr__ = on_demand(__name__)
