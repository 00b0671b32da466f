"""Choice of the stretches of a recording that become points, without their transients; reasons for dropping the others."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.constants import FALSE_ALARM
from mffit.points import constants
from mffit.points.faulty import Fault, bridged, faults, short_gaps
from mffit.points.mean import mean_and_error
from mffit.points.steady import Scale, SteadySettings, stretches
from mffit.points.stretch import MOVE, PLATEAU, SWEEP, Stretch
from mffit.scatter import beyond
from mffit.sweeps import Sweep

ROLLING_IN = f"the first {constants.TRANSIENT_ROLL:g} m of rolling behind a gap or a change"


def settings_of(sweep: Sweep) -> SteadySettings:
    """The settings of a time series."""
    return SteadySettings(**{name: getattr(sweep, name) for name in SteadySettings._fields})


def chosen(
    sweep: Sweep, wrong: list[Fault], scale: Scale | None, whole: Sweep | None = None
) -> list[Stretch]:
    """All stretches of a recording in time order, without their transients, or with the reason for dropping them.

    ``scale`` is the usual size of the settings in the whole campaign; if None, that of this series. ``whole`` is the recording
    with the lines that are left out by hand, which divides it: what a rig did does not depend on what is left out.
    """
    # Only to divide the recording: means take no sample that is bridged.
    sweep = bridged(sweep, (*SteadySettings._fields[1:], "Fy", "Mz"))
    if whole is None:
        whole = sweep
    else:
        whole = bridged(
            _without_glitches(whole, ~np.isin(whole.line, sweep.line)), SteadySettings._fields[1:]
        )
        wrong = faults(whole)
    found = _behind_their_start(_stretches(whole, wrong, scale), settings_of(whole))
    begins = np.searchsorted(sweep.line, whole.line[[stretch.begin for stretch in found]])
    ends = np.searchsorted(sweep.line, whole.line[[stretch.end - 1 for stretch in found]], "right")
    kept = zip(found, begins.tolist(), ends.tolist(), strict=True)
    return _judged(
        sweep,
        [
            s._replace(begin=begin, end=end, recorded=(s.begin, s.end))
            for s, begin, end in kept
            if end > begin
        ],
    )


def _without_glitches(whole: Sweep, left_out: np.ndarray) -> Sweep:
    """The recording without the angles that are left out (n,) for a short time, so that :func:`bridged` fills them in."""
    alpha, gamma = (np.where(short_gaps(whole.time, left_out), np.nan, x) for x in (whole.alpha, whole.gamma))
    return replace(whole, alpha=alpha, gamma=gamma)


def _stretches(sweep: Sweep, wrong: list[Fault], scale: Scale | None) -> list[Stretch]:
    """The stretches between faults that end a stretch, and the faulty stretches themselves."""
    n = len(sweep)
    if n < 2:
        return [Stretch(0, n, "only one sample", MOVE)]
    ends = [fault for fault in wrong if fault.ends_stretch]
    reason = np.full(n, -1)
    for k, fault in enumerate(ends):
        reason[fault.which & (reason < 0)] = k
    if np.all(reason >= 0):
        return [Stretch(0, n, ends[reason[0]].reason, MOVE)]
    cuts = np.r_[np.flatnonzero(np.diff(reason)) + 1, np.flatnonzero(np.diff(sweep.direction)) + 1]
    settings = settings_of(sweep)
    if np.any(reason >= 0):
        settings = SteadySettings(*(np.where(np.isfinite(x), x, 0.0) for x in settings))
    found = []
    for stretch in stretches(settings, sweep.point, cuts.tolist(), scale):
        k = int(reason[stretch.begin]) if sweep.point is None else -1
        found.append(stretch if k < 0 else Stretch(stretch.begin, stretch.end, ends[k].reason, MOVE))
    return sorted(found)


def _behind_their_start(found: list[Stretch], settings: SteadySettings) -> list[Stretch]:
    """The stretches, each sweep without its first metres of rolling, which are a move."""
    parted = []
    for stretch in found:
        begin = stretch.begin
        if stretch.kind == SWEEP and not stretch.dropped:
            begin = min(_rolled_from(begin, settings, stretch.end), stretch.end - 1)
        if begin > stretch.begin:
            parted.append(Stretch(stretch.begin, begin, ROLLING_IN, MOVE))
        parted.append(stretch._replace(begin=begin))
    return parted


def _judged(sweep: Sweep, found: list[Stretch]) -> list[Stretch]:
    """The stretches, plateaus without their transients or with the reason for dropping them."""
    settings = settings_of(sweep)
    harmless = constants.HARMLESS_DRIFT * float(np.nanmedian(sweep.Fz))
    responses = [(sweep.Fy, harmless, "N")]
    if np.all(np.isfinite(sweep.Mz)):
        responses.append((sweep.Mz, constants.ARM * harmless, "Nm"))
    return [
        settled(stretch, settings, responses) if stretch.kind == PLATEAU and not stretch.dropped else stretch
        for stretch in found
    ]


def _rolled_from(begin: int, settings: SteadySettings, end: int) -> int:
    """First sample of a stretch after the first metres of rolling; 0 at the start of a recording, which counts as settled."""
    if begin == 0:
        return 0
    speed = float(np.median(settings.V[begin:end]))
    seconds = constants.TRANSIENT_ROLL / speed if speed > 0.0 else np.inf  # nothing settles at standstill
    return int(np.searchsorted(settings.time, settings.time[begin] + seconds))


def settled(
    stretch: Stretch, settings: SteadySettings, responses: Sequence[tuple[np.ndarray, float, str]]
) -> Stretch:
    """The stretch without its transient, or with the reason for dropping it.

    ``responses`` has, for each measured force or moment, the samples (n,), the acceptable drift over a stretch, and the unit.
    """
    time, begin = settings.time, _rolled_from(stretch.begin, settings, stretch.end)
    short = _too_short(settings, begin, stretch.end)
    if short:
        return stretch._replace(dropped=short)
    begin = max(begin + _transient(x[begin : stretch.end]) for x, _, _ in responses)
    short = _too_short(settings, begin, stretch.end)
    if short:
        return stretch._replace(dropped=short)
    clear = beyond(FALSE_ALARM / len(time))
    for x, harmless, unit in responses:
        drift, error = _drift(x[begin : stretch.end])
        if abs(drift) > max(clear * error, harmless):
            return stretch._replace(dropped=f"still drifting by {drift:.3g} {unit}")
    return stretch._replace(begin=begin, transient=begin - stretch.begin)


def _too_short(settings: SteadySettings, begin: int, end: int) -> str:
    if end - begin < constants.FEWEST_POINTS:
        return f"only {max(end - begin, 0)} samples after the transient"
    seconds = settings.time[end - 1] - settings.time[begin]
    rolled = seconds * float(np.median(np.abs(settings.V[begin:end])))
    long = seconds >= constants.SHORTEST_STRETCH or rolled >= constants.TRANSIENT_ROLL
    return "" if long else f"only {seconds:.1f} s steady"


def _transient(x: np.ndarray) -> int:
    """Number of leading samples that differ from the mean of the second half; at most half of all samples."""
    blocks = min(constants.BLOCKS_OF_STRETCH, len(x))
    half = blocks // 2
    edges = np.linspace(0, len(x), blocks + 1).astype(int)
    level, error, _ = mean_and_error(x[edges[half] :])
    error *= np.sqrt(blocks / 2.0 + 1.0)  # of the difference between one block and the second half
    clear = beyond(FALSE_ALARM / half) if half else 0.0
    for block in range(half):
        away = abs(float(np.mean(x[edges[block] : edges[block + 1]])) - level)
        if not away > clear * error:
            return int(edges[block])
    return int(edges[half])


def _drift(x: np.ndarray) -> tuple[float, float]:
    """Change over the record along a fitted straight line, and its standard error.

    For equidistant samples the standard error of the change is sqrt(12) times that of the mean of the residuals.
    """
    time = np.linspace(-0.5, 0.5, len(x))
    change = float(np.dot(time, x) / np.dot(time, time))
    return change, float(np.sqrt(12.0)) * mean_and_error(x - change * time).error
