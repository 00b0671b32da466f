"""Forces at any conditions, with how far a new run of the tyre may lie from them."""

from mffit.prediction.conditions import write_table
from mffit.prediction.correction import CorrectionTable, correction, write_correction
from mffit.prediction.predictor import Predictor, predictor
from mffit.prediction.stored import FILE, load, predict, write

__all__ = [
    "FILE",
    "CorrectionTable",
    "Predictor",
    "correction",
    "load",
    "predict",
    "predictor",
    "write",
    "write_correction",
    "write_table",
]
