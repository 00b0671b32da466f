"""The mean of a record with autocorrelated noise, and its standard error."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import digamma, polygamma

from mffit.points import constants


def errors_of_means(records: Sequence[np.ndarray]) -> np.ndarray:
    """Standard error (k,) of the mean of each of k records of one channel, all of one recording.

    A record only a few correlation times long hardly determines its own noise. The noise of each record is therefore averaged
    with the common noise of all records, weighted by degrees of freedom. The weight of the common noise follows from the scatter
    of the estimates beyond chance (Smyth, Stat. Appl. Genet. Mol. Biol. 3, 2004, article 3); without such scatter it is used
    alone.
    """
    found = [mean_and_error(x) for x in records]
    errors = np.array([one.error for one in found])
    known = np.flatnonzero(np.isfinite(errors) & (errors > 0.0)).tolist()
    if len(known) < 2:
        return errors
    n = np.array([len(x) for x in records])[known]
    freedom = n / (1.0 + 2.0 * np.array([one.inefficiency for one in found])[known])
    noise = errors[known] ** 2 * n  # variance per sample, autocorrelation included
    logs = np.log(noise) - digamma(0.5 * freedom) + np.log(0.5 * freedom)
    beyond_chance = float(np.var(logs, ddof=1) - np.mean(polygamma(1, 0.5 * freedom)))
    if beyond_chance <= 0.0:
        noise = np.full(len(n), math.exp(np.mean(logs)))
    else:
        shared = 2.0 * _inverse_trigamma(beyond_chance)
        common = math.exp(np.mean(logs) + digamma(0.5 * shared) - math.log(0.5 * shared))
        noise = (shared * common + freedom * noise) / (shared + freedom)
    errors[known] = np.sqrt(noise / n)
    return errors


class MeanOfRecord(NamedTuple):
    """Mean of a series, its standard error and its statistical inefficiency."""

    mean: float
    error: float  #: standard error of the mean
    inefficiency: float  #: number of samples that count as one


def mean_and_error(x: np.ndarray) -> MeanOfRecord:
    """Mean of a stationary series (n,) of equidistant samples and its standard error, autocorrelation included.

    NaN anywhere gives NaN. The error of a constant series is 0, of fewer than two samples NaN.

    Var(mean) = g sigma^2 / n, where g, the statistical inefficiency, is the number of samples that count as one. g is the
    spectral density at zero frequency of an autoregressive process, e / (1 - sum a_k)^2 over sigma^2, with coefficients from
    Burg's recursion and the order from the Bayesian information criterion. Windowing the autocorrelation function would need
    twice the record for the same accuracy. Estimating the mean from the same record costs ``g`` of its ``n`` samples, in the
    variance and in ``g`` itself.
    """
    n, mean = len(x), float(np.mean(x))
    if n < 2 or not np.isfinite(mean):
        return MeanOfRecord(mean, math.nan, 1.0)
    centred = x - mean
    variance = float(np.mean(centred**2))
    if variance <= (1e-12 * max(abs(mean), 1e-300)) ** 2:
        return MeanOfRecord(mean, 0.0, 1.0)
    coefficients, innovation = autoregression(centred)
    g = innovation / (1.0 - float(np.sum(coefficients))) ** 2 / variance
    g = min(max(g, 1.0), n / 4.0)
    if len(coefficients):
        g *= 1.0 + 2.0 * g / n
    return MeanOfRecord(mean, float(np.sqrt(variance / (1.0 - g / n) * g / n)), g)


def _inverse_trigamma(y: float) -> float:
    """The x > 0 with trigamma(x) = ``y`` > 0, by Newton's method on the reciprocal."""
    x = 0.5 + 1.0 / y
    for _ in range(20):
        value = float(polygamma(1, x))
        step = value * (1.0 - value / y) / float(polygamma(2, x))
        x += step
        if abs(step) < 1e-8 * x:
            break
    return x


def autoregression(centred: np.ndarray) -> tuple[np.ndarray, float]:
    """Coefficients (k,) and innovation variance of x_t = sum a_k x_(t-k) + e, by Burg's recursion; the mean of (n,) is zero."""
    n = len(centred)
    forward, backward = centred[1:], centred[:-1]
    coefficients = np.zeros(0)
    innovation = float(np.mean(centred**2))
    best = (n * np.log(innovation), coefficients, innovation)
    for order in range(1, min(constants.LARGEST_ORDER_OF_NOISE, n // 4) + 1):
        power = float(np.dot(forward, forward) + np.dot(backward, backward))
        if power <= 1e-24 * n * innovation:
            break
        reflection = 2.0 * float(np.dot(forward, backward)) / power
        coefficients = np.append(coefficients - reflection * coefficients[::-1], reflection)
        innovation *= 1.0 - reflection**2
        if innovation <= 0.0:
            break
        forward, backward = (
            forward[1:] - reflection * backward[1:],
            backward[:-1] - reflection * forward[:-1],
        )
        best = min(
            best,
            (n * np.log(innovation) + order * np.log(n), coefficients, innovation),
            key=lambda found: found[0],
        )
    return best[1], best[2]
