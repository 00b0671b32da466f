"""The fit of the plain file, and the fit with all chosen influences of :mod:`mffit.fit.influences.nuisances`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mffit.config import Config
from mffit.fit.coverage import UNSEEN
from mffit.fit.fitted import Fitted, left_by
from mffit.fit.influences.nuisance_choice import NuisanceChoice, at_reference, choose
from mffit.fit.influences.nuisances import TEMPERATURE, Nuisance
from mffit.fit.outlying import without_outliers
from mffit.fit.plan import FitPlan
from mffit.fit.polish import first_fit, polish, with_known_zeros
from mffit.fit.problem import FitProblem
from mffit.linearised import LinearisedFit
from mffit.linearised.components import CERTAIN_EVIDENCE
from mffit.points import Points
from mffit.progress import FITTING, FITTING_AGAIN, Progress
from mffit.rig import Simulation
from tir.evaluate import CONICITY


@dataclass(frozen=True, slots=True)
class NuisanceFit:
    """Two fits to the same points; they are the same object if temperature is not modelled."""

    plain: Fitted  #: fit without temperature as an input: its coefficients absorb the warming
    full: Fitted  #: fit with every modelled influence
    choice: NuisanceChoice
    plan: FitPlan  #: of the free and the held numbers, but for the influences
    stated: FitProblem  #: with stated weights, none for outliers
    left: LinearisedFit  #: linear model of the residuals of a similar fit

    @property
    def at_temperature(self) -> bool:
        """Whether the full fit models the temperature."""
        return self.full is not self.plain


def fit_with_nuisances(
    config: Config, problem: FitProblem, start: Mapping[str, float], plan: FitPlan, progress: Progress
) -> NuisanceFit:
    """The first fit without outliers, then the choice of influences, then the joint fit with the chosen ones."""
    progress(FITTING)
    fitted, problem, left = without_outliers(first_fit(problem, start, plan), problem)
    one_mount = len(np.unique(problem.points.mount)) < 2
    if not config.rig.on_disc and len(problem.points.used_setups) < 2 and one_mount:
        fitted, plan = with_known_zeros(fitted, problem, plan, left)
    found = _with_influences(config, problem, plan, fitted, left, progress)
    if not config.rig.on_disc:
        return found
    left = left_by(found.full, near=left)
    unseen = _untold(plan, left, problem.points)
    if not unseen:
        return replace(found, left=left)
    plan = plan.holding(unseen, UNSEEN)
    symmetric = {name: plan.expected.get(name, problem.value(name)) for name in unseen}
    begin = first_fit(problem.with_values(symmetric), {**start, **symmetric}, plan)
    return _with_influences(config, problem, plan, begin, left, progress)


def _untold(plan: FitPlan, left: LinearisedFit, points: Points) -> list[str]:
    """Free numbers of a disc that the readings do not tell from the model error: asymmetries together, and errors of the rig.

    One side of a disc never tells an asymmetry from what the formula misses of turn slip; with the tyre turned on its rim it
    tells those that change sign.
    """
    if left.is_exact:
        return []
    odd, flipped = plan.asymmetries, len(np.unique(points.mount)) > 1
    shown = [n for n in odd if n in CONICITY and flipped] if points.one_sided else odd
    others = [n.name for n in plan.rig if n.name not in odd and n.name not in plan.hand.names]
    groups = [shown, *([name] for name in others)]
    told = {name for group in groups if left.evidence_of(group) > CERTAIN_EVIDENCE for name in group}
    return [name for name in (*odd, *others) if name not in told]


def _with_influences(
    config: Config,
    problem: FitProblem,
    plan: FitPlan,
    fitted: Fitted,
    left: LinearisedFit,
    progress: Progress,
) -> NuisanceFit:
    """The fit with the chosen influences, and the ``fitted`` one without them."""
    choice = choose(config, fitted, left)
    if choice.modelled:
        progress(f"{FITTING_AGAIN} {', '.join(nuisance.name for nuisance in choice.modelled)}")
    full = _polished(config, problem, plan, choice, choice.modelled, fitted, choice.near.problem.simulation)
    if not any(nuisance.key == TEMPERATURE for nuisance in choice.modelled):
        return NuisanceFit(full, full, choice, plan, problem, left)
    # Random effects of the runs would absorb the usual warming, which the plain file's coefficients are to contain.
    others = [n for n in choice.modelled if n.key != TEMPERATURE and not n.per_run]
    plain = _polished(config, problem, plan, choice, others, fitted)
    return NuisanceFit(plain, full, choice, plan, problem, left)


def _polished(
    config: Config,
    problem: FitProblem,
    plan: FitPlan,
    choice: NuisanceChoice,
    added: Sequence[Nuisance],
    fitted: Fitted,
    near: Simulation | None = None,
) -> Fitted:
    """The joint fit with the influences ``added``, started from ``fitted``; ``fitted`` itself if none is added.

    ``near`` is a better starting point that already has these influences.
    """
    if not added:
        return fitted
    numbers = tuple(n for nuisance in added for n in nuisance.free(problem.points, choice.scatter))
    here = at_reference(config, replace(problem, simulation=near or fitted.simulation))
    plan = replace(plan, rig=(*plan.rig, *numbers))
    return polish(here.with_noise_of_misfit(), plan)
