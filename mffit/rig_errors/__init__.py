"""Errors of readings from a rig, its environment and its motion: one record per error."""

from mffit.rig_errors.catalog import AFTER as AFTER
from mffit.rig_errors.catalog import BEFORE as BEFORE
from mffit.rig_errors.catalog import BESIDE as BESIDE
from mffit.rig_errors.catalog import BY_NAME as BY_NAME
from mffit.rig_errors.catalog import CALIBRATED as CALIBRATED
from mffit.rig_errors.catalog import DECLARED as DECLARED
from mffit.rig_errors.catalog import RIG_ERRORS as RIG_ERRORS
from mffit.rig_errors.catalog import T_REF as T_REF
from mffit.rig_errors.catalog import ZEROS as ZEROS
from mffit.rig_errors.faults import NO_FAULTS as NO_FAULTS
from mffit.rig_errors.faults import OF_RUN as OF_RUN
from mffit.rig_errors.faults import Faults as Faults
from mffit.rig_errors.faults import error_of as error_of
from mffit.rig_errors.faults import meaning_of as meaning_of
from mffit.rig_errors.faults import number_of as number_of
from mffit.rig_errors.faults import rig_estimates as rig_estimates
from mffit.rig_errors.faults import shown as shown
from mffit.rig_errors.faults import unit_of as unit_of
from mffit.rig_errors.faults import words_of as words_of
from mffit.rig_errors.record import Appearance as Appearance
from mffit.rig_errors.record import AtLoad as AtLoad
from mffit.rig_errors.record import AtZero as AtZero
from mffit.rig_errors.record import Declared as Declared
from mffit.rig_errors.record import Place as Place
from mffit.rig_errors.record import RigError as RigError
from mffit.rig_errors.record import Slopes as Slopes
