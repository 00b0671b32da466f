"""Predicted forces at any conditions, with the uncertainty for the tyre and for a new run."""

from mffit.prediction.conditions import write_table
from mffit.prediction.correction import CorrectionTable, correction, write_correction
from mffit.prediction.predictor import Predictor, predictor
from mffit.prediction.region import MissedAtReadings, missed_at_readings
from mffit.prediction.road import OnRoad, road_of
from mffit.prediction.stored import FILE, load, predict, write
from mffit.prediction.wording import missed_sentence, road_sentences
