"""The results of the workflows, and their JSON."""

from typing import TYPE_CHECKING

from mffit.on_demand import on_demand

if TYPE_CHECKING:
    from mffit.results.records import CORRECTION, TEMPERATURE, BuildOutcome, BuildResult

__getattr__ = on_demand(__name__)
