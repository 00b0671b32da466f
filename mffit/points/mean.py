"""The mean of a noisy record and its standard error if neighbouring samples are correlated."""

from __future__ import annotations

import numpy as np

from mffit.points import constants


def mean_and_error(x: np.ndarray) -> tuple[float, float]:
    """Mean of a stationary series (n,) and its standard error, autocorrelation included.

    Parameters
    ----------
    x : (n,) equidistant samples; NaN anywhere gives NaN

    Returns
    -------
    mean, error
        The error of a constant series is 0, of fewer than two samples NaN.

    Notes
    -----
    Var(mean) = g sigma^2 / n, where g, the statistical inefficiency, is the number of samples that count as
    one. It is the spectral density at zero frequency of an autoregressive process, e / (1 - sum a_k)^2 over
    sigma^2, whose coefficients come from Burg's recursion and whose order from the Bayesian information
    criterion. A window over the autocorrelation function needs twice the record for the same certainty.
    Estimating the mean from the same record costs ``g`` of its ``n`` samples, in the variance and in ``g`` itself.
    """
    n, mean = len(x), float(np.mean(x))
    if n < 2 or not np.isfinite(mean):
        return mean, float("nan")
    centred = x - mean
    variance = float(np.mean(centred**2))
    if variance <= (1e-12 * max(abs(mean), 1e-300)) ** 2:
        return mean, 0.0
    coefficients, innovation = autoregression(centred)
    g = innovation / (1.0 - float(np.sum(coefficients))) ** 2 / variance
    g = min(max(g, 1.0), n / 4.0)
    if len(coefficients):
        g *= 1.0 + 2.0 * g / n
    return mean, float(np.sqrt(variance / (1.0 - g / n) * g / n))


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
