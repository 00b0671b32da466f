"""Diagnosis of a simulation: its gap to the measurement, the regions of the gap, the missing effects, and the corrected model.

The modules in the order of the method (:mod:`engine` is the sequence):

1. ``strangers``, ``conditions``: check that points and model belong together, and cut sweeps at their conditions.
2. ``stated``, ``noise``: stated covariance of the readings. ``inexact``, ``priors``: priors of coefficients and rig.
3. ``where``: regions in which measurement and simulation disagree.
4. ``needs``, ``problem``, ``hypothesis``: candidates, and the fit and evidence of a set of effects.
5. ``search``, ``explain``: all effects fitted together, then the noise around them: ``scatter``, ``tails``
   estimate its size, its autocorrelation and offsets of runs. ``selection`` finds the most probable set of effects from the
   evidence of all sets (``subsets``), in competition with unnamed structure (``smooth``, ``bumps``).
6. ``estimated``: the numbers of the effects and their standard errors. ``rest``: what remains with them, the four answers.
7. ``validation``, ``repair``: the gap on left-out sweeps, and the effects and the file that are corrected.
8. ``ties``, ``limits``: rivals of each effect, the run that separates them, sizes that are excluded.
9. ``answer``, ``result``, ``notes``, ``wording``: the record, corrected points, sentences.

Every build uses ``remains`` on the linear model of its own fit, to test every effect together with all fitted numbers.
"""

from typing import TYPE_CHECKING

from mffit.on_demand import on_demand

if TYPE_CHECKING:
    from mffit.diagnosis.engine import diagnose
    from mffit.diagnosis.result import AcceptedEffect, Diagnosis, corrected_points
    from mffit.diagnosis.search import Asked
    from mffit.diagnosis.validation import Gap, gap, validate

__getattr__ = on_demand(__name__)
