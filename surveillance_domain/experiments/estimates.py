"""Means over runs, and paired differences over common runs, with 95 % confidence intervals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveillance_domain.control.percent_obs import confidence_interval
from surveillance_domain.experiments.runs import Run

__all__ = ["Estimate", "decision_times", "estimate", "paired", "percent_obs_of"]


@dataclass(frozen=True)
class Estimate:
    """A mean.

    Attributes
    ----------
    mean : float
        nan where there is nothing to average.
    low, high : float
        Student's 95 % interval; infinite where there are fewer than two runs.
    samples : tuple of float
        One a run, in order of the runs' numbers.
    """

    mean: float
    low: float
    high: float
    samples: tuple[float, ...]

    @property
    def verdict(self) -> int:
        """1: above zero, -1: below zero, 0: the interval holds zero."""
        return int(self.low > 0) - int(self.high < 0)

    @property
    def half_width(self) -> float:
        """Half of the interval's length."""
        return (self.high - self.low) / 2

    def ends(self, least: float = -math.inf, most: float = math.inf) -> list[float | None]:
        """The interval as far as a mean can be, between ``least`` and ``most``; ``None`` for infinite ends."""
        return [min(max(end, least), most) if math.isfinite(end) else None for end in (self.low, self.high)]


def estimate(samples: Iterable[float]) -> Estimate:
    """Mean and interval; runs without a number (nan) are left out."""
    numbers = tuple(float(number) for number in samples if not math.isnan(number))
    if not numbers:
        return Estimate(math.nan, -math.inf, math.inf, ())
    return Estimate(float(np.mean(numbers)), *confidence_interval(numbers), numbers)


def percent_obs_of(runs: Mapping[int, Run]) -> Estimate:
    """PercentObs over runs."""
    return estimate(runs[number].percent_obs for number in sorted(runs))


def paired(runs: Mapping[int, Run], others: Mapping[int, Run]) -> Estimate:
    """PercentObs of the first minus that of the second, run by run over those that both have."""
    common = sorted(runs.keys() & others.keys())
    return estimate(runs[number].percent_obs - others[number].percent_obs for number in common)


def decision_times(runs: Iterable[Run]) -> tuple[float, float]:
    """Median and 99th percentile of the decision time in milliseconds; nan without steps."""
    times: Sequence[float] = [time for run in runs for time in run.decision_ms]
    if not times:
        return math.nan, math.nan
    median, late = np.percentile(times, [50, 99])
    return float(median), float(late)
