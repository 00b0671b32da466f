"""The workflows, one module each, one call per step."""

from typing import TYPE_CHECKING

from mffit.on_demand import on_demand

if TYPE_CHECKING:
    from mffit.pipeline.building import build
    from mffit.pipeline.comparing import compare
    from mffit.pipeline.diagnosing import diagnose
    from mffit.pipeline.exporting import write_tydex
    from mffit.pipeline.fleets import fleet
    from mffit.pipeline.intake import init_from, project_of
    from mffit.pipeline.many import build_many, explained, is_current
    from mffit.pipeline.measuring import align, spin
    from mffit.pipeline.planning import plan
    from mffit.pipeline.showing import show
    from mffit.pipeline.watching import watch
    from mffit.prediction import predict

__getattr__ = on_demand(__name__)
