"""The workflows: one screen each, one call per step."""

from mffit.pipeline.building import build
from mffit.pipeline.diagnosing import diagnose
from mffit.pipeline.exporting import write_tydex
from mffit.pipeline.intake import init_from, write_sniffed
from mffit.pipeline.measuring import align, spin

__all__ = ["align", "build", "diagnose", "init_from", "spin", "write_sniffed", "write_tydex"]
