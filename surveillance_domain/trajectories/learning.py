"""Everything that is learned from tracks in one go: the motion model, how well it foretells, where people are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from surveillance_domain.trajectories.far_away import refuse_far_people
from surveillance_domain.trajectories.fitting import MotionFit, fit_motion
from surveillance_domain.trajectories.held_out import HeldOut, held_out_log_likelihood
from surveillance_domain.trajectories.on_grid import check_grid_model
from surveillance_domain.trajectories.prior import CellPrior, cell_prior
from surveillance_domain.trajectories.tracks import Track
from surveillance_domain.trajectories.transitions import Transitions, in_order_of_content, split_people, transitions

__all__ = ["Learned", "Wanted", "learn_motion"]


@dataclass(frozen=True)
class Wanted:
    """What is to be learned.

    Attributes
    ----------
    step_s, cell_m : float
    speeds : int
        How many speeds the set is to hold.
    directions : int
        Of the model on the grid.
    held_out : float
        Share of the people that are held out.
    prior : bool
        Whether positions of different tracks stand in one frame, so that there is a prior over cells.
    """

    step_s: float
    cell_m: float
    speeds: int = 3
    directions: int = 8
    held_out: float = 0.3
    prior: bool = True


@dataclass(frozen=True, eq=False)
class Learned:
    """What was learned.

    Attributes
    ----------
    fit : MotionFit
        From everybody.
    everyone : Transitions
    judged_fit : MotionFit
        From those who are not held out; it is the one that is judged.
    judging : Transitions
        Of those who are.
    judged : HeldOut
    prior : CellPrior or None
    """

    fit: MotionFit
    everyone: Transitions
    judged_fit: MotionFit
    judging: Transitions
    judged: HeldOut
    prior: CellPrior | None


def learn_motion(
    tracks: Sequence[Track],
    wanted: Wanted,
    rng: np.random.Generator,
    advance: Callable[[float, str], object] | None = None,
) -> Learned:
    """Learn from all, and judge what is learned from some by the others; the order of the tracks does not matter.

    Parameters
    ----------
    rng : numpy.random.Generator
        Draws who is held out.
    advance : callable, optional
        Told which share of the work has been done since it was told last, and what is being done.

    Raises
    ------
    ValueError
        If nobody walks two steps on end, people are too far apart for a prior over cells, or the cells are too small to
        be judged on.
    """
    told = advance or (lambda share, doing: None)
    told(0.0, "taking steps")
    ordered = in_order_of_content(tracks)
    everyone = transitions(ordered, wanted.step_s)
    if wanted.prior and ordered:
        refuse_far_people(ordered, wanted.cell_m)
    prior = cell_prior(everyone.points_m, wanted.cell_m) if wanted.prior and len(everyone.points_m) else None
    training, rest = split_people(ordered, wanted.held_out, rng)
    told(0.2, "fitting")
    fit = fit_motion(everyone, wanted.speeds)
    check_grid_model(fit, everyone, wanted.cell_m, wanted.directions)
    told(0.2, "fitting without those held out")
    judged_fit, judging = (
        fit_motion(transitions(training, wanted.step_s), wanted.speeds),
        transitions(rest, wanted.step_s),
    )
    told(0.2, "judging by those held out")
    total = max(len(judging.people), 1)
    judged = held_out_log_likelihood(
        judged_fit,
        judging,
        wanted.cell_m,
        wanted.directions,
        lambda pairs: told(0.4 * pairs / total, "judging by those held out"),
    )
    return Learned(fit, everyone, judged_fit, judging, judged, prior)
