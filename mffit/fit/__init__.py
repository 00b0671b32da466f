"""Fit of an MF-6.2 tyre, with standard errors, to points and direct measurements."""

from typing import TYPE_CHECKING

from mffit.on_demand import on_demand

if TYPE_CHECKING:
    from mffit.fit.agreement import Agreement
    from mffit.fit.beginning import begin, sketch
    from mffit.fit.coefficients import Coefficient
    from mffit.fit.drawn import ensemble
    from mffit.fit.fitted import with_free_epsilon
    from mffit.fit.fitting import fit
    from mffit.fit.result import FitResult
    from mffit.fit.straight import straight_cornering_stiffness
    from mffit.fit.wording import zeros_listed
    from mffit.fit.written.files import file_names, fitted_use, name_at_temperature, plain_use

__getattr__ = on_demand(__name__)
