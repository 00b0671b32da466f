"""Forces at any conditions, with how far a new run of the tyre may lie from them."""

from mffit.prediction.conditions import checked, read_conditions, write_table
from mffit.prediction.predictor import Predictor, predictor
from mffit.prediction.stored import FILE, load, write

__all__ = ["FILE", "Predictor", "checked", "load", "predictor", "read_conditions", "write", "write_table"]
