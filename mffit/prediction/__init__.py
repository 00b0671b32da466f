"""Forces at any conditions, with how far a new run of the tyre may lie from them."""

from mffit.prediction.conditions import write_table
from mffit.prediction.predictor import Predictor, predictor
from mffit.prediction.stored import FILE, load, predict, write

__all__ = ["FILE", "Predictor", "load", "predict", "predictor", "write", "write_table"]
