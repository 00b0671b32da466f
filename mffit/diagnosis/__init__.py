"""What a simulation lacks: its gap to the measurement, where it is, the missing effects, and the corrected model.

The modules in the order of the method (:mod:`engine` is the sequence):

1. ``strangers``, ``conditions``: points and model belong together;
   sweeps are cut at their conditions.
2. ``stated``, ``noise``: the covariance of the readings as stated. ``inexact``, ``priors``: priors of coefficients and rig.
3. ``where``: regions in which measurement and simulation disagree.
4. ``needs``, ``problem``, ``hypothesis``: candidates, and the fit and evidence of a set of effects.
5. ``explain``: the rounds. ``learning``, ``scatter``, ``tails`` find the real noise, its memory, and whether runs are
   offset; ``selection`` the effects, each beside the structure without a name that it leaves (``smooth``, ``bumps``);
   ``prediction`` judges effects by left-out sweeps.
6. ``validation``: the part that left-out sweeps confirm.
7. ``ties``, ``limits``: rivals of each effect, the run that separates them, sizes that are ruled out.
8. ``answer``, ``result``, ``notes``, ``wording``: the record, corrected points, sentences.

Every build uses ``remains`` on the linear model of its own fit: it tests every effect beside all that was fitted.
"""

from mffit.diagnosis.engine import diagnose
from mffit.diagnosis.result import AcceptedEffect, Diagnosis, corrected_points
from mffit.diagnosis.validation import Gap, gap, validate
from mffit.diagnosis.where import where

__all__ = ["AcceptedEffect", "Diagnosis", "Gap", "corrected_points", "diagnose", "gap", "validate", "where"]
