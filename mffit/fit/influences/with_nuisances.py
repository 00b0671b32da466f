"""The fit of the plain file, and the fit with the influences of :mod:`mffit.fit.influences.nuisances` that are modelled."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mffit.config import Config
from mffit.fit.fitted import Fitted
from mffit.fit.influences.nuisance_choice import NuisanceChoice, at_reference, choose
from mffit.fit.influences.nuisances import TEMPERATURE, Nuisance
from mffit.fit.influences.runaways import without_runaways
from mffit.fit.plan import FitPlan
from mffit.fit.polish import first_fit, polish
from mffit.fit.problem import FitProblem
from mffit.progress import Progress
from mffit.rig import Simulation


@dataclass(frozen=True, slots=True)
class NuisanceFit:
    """Two fits of the same points; they are one if no temperature is modelled."""

    plain: Fitted  #: without temperature as an input: its coefficients take up the warming
    full: Fitted  #: with every influence that is modelled
    choice: NuisanceChoice
    refit: Callable[[np.ndarray], Fitted]  #: the full fit to some of the points (rows)
    plan: FitPlan  #: without the coefficients that turned out not to be determined

    @property
    def at_temperature(self) -> bool:
        """Whether the full fit knows the temperature."""
        return self.full is not self.plain


def fit_with_nuisances(
    config: Config, problem: FitProblem, start: Mapping[str, float], plan: FitPlan, progress: Progress
) -> NuisanceFit:
    """The staged fit, then the influences that it should model, then the joint polish with these."""
    progress("fitting tyre and rig")
    fitted = first_fit(problem, start, plan)
    choice = choose(config, fitted)
    known, near = without_runaways(fitted, plan, choice), choice.near.problem
    held = {name: plan.expected[name] for name in plan.free if name not in known.free}
    if held:
        fitted, near = polish(fitted.problem.with_values(held), known), near.with_values(held)

    def refit(rows: np.ndarray) -> Fitted:
        part = problem.select(rows)
        return _polished(config, part, known, choice, choice.modelled, first_fit(part, start, known))

    if choice.modelled:
        progress(f"fitting again with {', '.join(nuisance.name for nuisance in choice.modelled)}")
    full = _polished(config, problem, known, choice, choice.modelled, fitted, near.simulation)
    if not any(nuisance.key == TEMPERATURE for nuisance in choice.modelled):
        return NuisanceFit(full, full, choice, refit, known)
    # Numbers of every run would take up what the coefficients of the plain file are to contain: the usual warming.
    others = [n for n in choice.modelled if n.key != TEMPERATURE and not n.per_run]
    plain = _polished(config, problem, known, choice, others, fitted)
    return NuisanceFit(plain, full, choice, refit, known)


def with_doubt(found: NuisanceFit) -> NuisanceFit:
    """The fits, the plain one with its distance from the full one."""
    plain = _doubted(found.plain, found.full) if found.at_temperature else found.full
    return replace(found, plain=plain)


def _polished(
    config: Config,
    problem: FitProblem,
    plan: FitPlan,
    choice: NuisanceChoice,
    added: Sequence[Nuisance],
    fitted: Fitted,
    near: Simulation | None = None,
) -> Fitted:
    """The polish with further numbers, from the end of a fit; that fit itself if there are none.

    ``near`` is a better place to start from, with these numbers.
    """
    if not added:
        return fitted
    numbers = tuple(n for nuisance in added for n in nuisance.free(problem.points, choice.scatter))
    here = at_reference(config, replace(problem, simulation=near or fitted.simulation))
    plan = replace(plan, rig=(*plan.rig, *numbers))
    return polish(here.with_noise_of_misfit(), plan)


def _doubted(plain: Fitted, full: Fitted) -> Fitted:
    """The plain fit, its uncertainty with the shift of its coefficients from those at one temperature.

    The shift of all coefficients together is one more error of known size.
    """
    names = plain.posterior.names
    shift = {name: plain.values[name] - full.values[name] for name in names if name in full.values}
    return replace(
        plain,
        posterior=plain.posterior.shifted(np.array([shift.get(name, 0.0) for name in names])),
        stderr={name: math.hypot(u, shift.get(name, 0.0)) for name, u in plain.stderr.items()},
    )
