"""Where the targets of a run go: it does not depend on who watches them, and takes longer to work out than watching.

So it is worked out once for all controllers of a world, and the chain's moves once for all worlds of a site.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from threading import get_ident

from surveillance_domain.experiments.runs import TruthKind, simulated_world
from surveillance_domain.experiments.setup import Case, Setup, site_of, surveillance_of
from surveillance_domain.model.build import motion_parameters
from surveillance_domain.world.grid_chain import GridChain
from surveillance_domain.world.remembered import Remembered
from surveillance_domain.world.truth import Truth
from surveillance_domain.world.truth_grid import GridTruth

__all__ = ["way_of"]

_WORLDS = 16
"""How many are remembered: more than a job has runs, so that the next controller's job meets the same."""
_MOST_STEPS = 5_000
_MOST_POSITIONS = 100_000
"""Steps, and positions of all targets in them, up to which a world is remembered; a few hundred megabytes for all."""


def way_of(case: Case, number: int) -> Truth | None:
    """The first states of a run's targets, remembering what follows; ``None`` for a run too long to remember."""
    targets = case.setup.targets
    if case.steps > _MOST_STEPS or case.steps * targets > _MOST_POSITIONS:
        return None
    return _way(case.setup.site, targets, case.truth, case.seed, number, get_ident())


@lru_cache(maxsize=_WORLDS)
def _way(site: str, targets: int, truth: TruthKind, seed: int, number: int, _thread: int) -> Remembered:
    """Every thread (a worker of a cluster may have several) has its own: what draws random numbers changes by it."""
    start = simulated_world(surveillance_of(Setup(site, targets)), truth, seed, number).truth
    return Remembered(replace(start, chain=_chain(site)) if isinstance(start, GridTruth) else start)


@lru_cache(maxsize=4)
def _chain(site: str) -> GridChain:
    found = site_of(Setup(site, 1))
    return GridChain(found.grid, motion_parameters(found))
