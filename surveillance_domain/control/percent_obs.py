"""PercentObs, the paper's measure (sec. expdis), and its uncertainty."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from surveillance_domain.control.loop import Step

__all__ = ["confidence_interval", "percent_obs"]


def percent_obs(record: Sequence[Step]) -> float:
    """``100 / τ Σ_i M_obs(i) / M_tot(i)`` over the steps at which there are targets; nan if there are none."""
    shares = [step.observed / step.present for step in record if step.present]
    return 100 * float(np.mean(shares)) if shares else math.nan


def confidence_interval(samples: Sequence[float], level: float = 0.95) -> tuple[float, float]:
    """Student's interval of the mean of independent runs; (-inf, inf) for a single one."""
    from scipy.stats import t

    numbers = np.asarray(samples, dtype=float)
    mean = float(numbers.mean())
    if len(numbers) < 2:
        return -math.inf, math.inf
    half = float(t.ppf((1 + level) / 2, len(numbers) - 1) * numbers.std(ddof=1) / math.sqrt(len(numbers)))
    return mean - half, mean + half
