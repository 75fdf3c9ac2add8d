"""Surveillance as a factored POMDP: the tuple of sec. staact, read as the design's model page settles it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count, islice
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from factored_pomdp.factors import Cause, DenseFactor, DeterministicFactor, Factor, NoisyOr, SparseFactor
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Variable
from surveillance_domain.model.confusion import confusion_kernel
from surveillance_domain.model.motion import MotionParameters, MotionTables, motion_tables
from surveillance_domain.model.parameters import DoorParameters
from surveillance_domain.model.reachability import reachable
from surveillance_domain.model.views import Views, build_views
from surveillance_domain.site.site import Site

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = [
    "OUTSIDE",
    "UNSEEN",
    "Surveillance",
    "motion_parameters",
    "starting_places",
    "surveillance_model",
    "target_names",
]

UNSEEN = "unseen"
"""The null observation φ: no camera detected the target. Its probability outside of every view is one."""

_MOST_TARGETS = 100_000

OUTSIDE = "outside"
"""Where a target is that left by a door: the last value of its location, where the site has doors."""


@dataclass(frozen=True, eq=False)
class Surveillance:
    """A model together with what it was made of.

    Attributes
    ----------
    model : FactoredPOMDP
        States ``<target>.location | .direction | .speed`` and ``<camera>.preset``; actions ``<camera>.move``;
        observations ``<target>.sighting`` (a cell, or `UNSEEN`).
    site : Site
    views : Views
    targets : tuple of str
    """

    model: FactoredPOMDP
    site: Site
    views: Views
    targets: tuple[str, ...]


def motion_parameters(site: Site) -> MotionParameters:
    """How targets move at a site."""
    return MotionParameters(
        directions=site.targets.directions,
        speeds_mps=tuple(site.targets.speeds_mps),
        sigma_direction_deg=site.targets.sigma_direction_deg,
        sigma_speed_mps=site.targets.sigma_speed_mps,
        walls=site.targets.walls,
        step_s=site.control.step_s,
        doors=tuple(DoorParameters(door.cells, door.rate_per_s) for door in site.targets.doors),
    )


def starting_places(site: Site, outside_share: float | None) -> Float[np.ndarray, " places"]:
    """P(place) of a target before the first step: by the site's prior on the map, and last, with doors, outside.

    ``outside_share`` is the share of the time, in the long run, that a target is outside (``None``: no doors).
    """
    there = 1.0 if outside_share is None else 1 - outside_share
    inside = np.full(site.grid.size, there / site.grid.size) if site.prior is None else there * site.prior
    return inside if outside_share is None else np.append(inside, outside_share)


def target_names(site: Site, targets: int) -> tuple[str, ...]:
    """Names that the site knows, then ``target<k>`` for the k-th, a name that is taken being passed over."""
    known = [target.name for target in site.targets.known[:targets]]
    others = (f"target{number}" for number in count(len(known) + 1) if f"target{number}" not in known)
    return (*known, *islice(others, targets - len(known)))


def surveillance_model(site: Site, targets: int, discount: float = 1.0) -> Surveillance:
    """Build the model of a site with a number of targets.

    Targets share their tables: m of them cost the memory of one, and one stack of arrays in the belief.

    Raises
    ------
    ValueError
        If there are no targets, or more than a hundred thousand.
    SiteError
        If a preset sees nothing.
    """
    if not 1 <= targets <= _MOST_TARGETS:
        raise ValueError(f"targets={targets}: expected 1 to {_MOST_TARGETS:,}")
    views = build_views(site)
    pattern = _Pattern(site, views, motion_tables(site.grid, motion_parameters(site)))
    names = target_names(site, targets)
    transition: dict[str, Factor] = {}
    observation: dict[str, Factor] = {}
    reward: dict[str, Factor] = {}
    initial: dict[str, Factor] = {}
    groups = []
    for name in names:
        own = pattern.renaming(name)
        transition |= {own[x]: factor.renamed(own) for x, factor in pattern.transition.items()}
        observation[own["z"]] = pattern.observation.renamed(own)
        reward[f"{name}.observed"] = pattern.reward.renamed(own)
        initial |= {own[x]: factor.renamed(own) for x, factor in pattern.initial.items()}
        groups.append([own[x] for x in ("l", "d", "v")])
    legal = {}
    for camera, preset, move in zip(site.cameras, pattern.presets, pattern.moves, strict=True):
        transition[preset.name] = DeterministicFactor([move], preset.next, np.arange(move.size))
        initial[preset.name] = DeterministicFactor([], preset, 0)
        reach = reachable(camera, site.control.step_s)
        if not reach.all():
            legal[move.name] = DenseFactor([preset, move], reach)
    model = FactoredPOMDP(
        name=f"surveillance of {site.name} with {targets} target{'s' if targets > 1 else ''}",
        states=[pattern.state[x].renamed(pattern.renaming(n)[x]) for n in names for x in ("l", "d", "v")]
        + pattern.presets,
        actions=pattern.moves,
        observations=[pattern.sighting.renamed(f"{name}.sighting") for name in names],
        transition=transition,
        observation=observation,
        reward=reward,
        initial=initial,
        discount=discount,
        groups=groups,
        legal=legal,
    )
    return Surveillance(model, site, views, names)


class _Pattern:
    """The factors of one target, over short names that every target renames."""

    def __init__(self, site: Site, views: Views, motion: MotionTables) -> None:
        cells = tuple((int(column), int(row)) for column, row in site.grid.cells)
        directions = tuple(360 * k / site.targets.directions for k in range(site.targets.directions))
        places = (*cells, OUTSIDE) if site.targets.doors else cells
        self.state = {
            "l": Variable("l", places),
            "d": Variable("d", tuple(int(d) if d.is_integer() else d for d in directions)),
            "v": Variable("v", tuple(site.targets.speeds_mps)),
        }
        self.sighting = Variable("z", (*cells, UNSEEN))
        for variable in (*self.state.values(), self.sighting):
            variable.index(variable.values[0])  # the look-up is made once, here, and shared by every renaming
        place, heading, speed = self.state.values()
        self.presets = [Variable(f"{c.name}.preset", [preset.name for preset in c.presets]) for c in site.cameras]
        self.moves = [Variable(f"{c.name}.move", [preset.name for preset in c.presets]) for c in site.cameras]
        self.transition = {
            "l": _location(motion, place, heading, speed),
            "d": _direction(motion, place, heading, speed),
            "v": DenseFactor([speed, speed.next], motion.speed),
        }
        self.observation = _sighting(site, views, place, self.sighting, self.presets)
        self.reward = DenseFactor([self.sighting], np.append(np.ones(len(cells)), 0.0))
        self.initial = {x: DenseFactor([v], np.full(v.size, 1 / v.size)) for x, v in self.state.items()}
        self.initial["l"] = DenseFactor([place], starting_places(site, motion.outside_share))

    def renaming(self, target: str) -> dict[str, str]:
        """Short names to a target's own."""
        own = {"l": f"{target}.location", "d": f"{target}.direction", "v": f"{target}.speed", "z": f"{target}.sighting"}
        return own | {f"{short}.next": f"{own[short]}.next" for short in ("l", "d", "v")}


def _location(motion: MotionTables, place: Variable, heading: Variable, speed: Variable) -> SparseFactor:
    table = motion.location
    coordinates = np.stack([table.cell, table.direction, table.speed, table.next_cell], axis=1)
    return SparseFactor([place, heading.next, speed.next, place.next], coordinates, table.probability)


def _direction(motion: MotionTables, place: Variable, heading: Variable, speed: Variable) -> DenseFactor:
    if motion.direction_scope == "direction":
        return DenseFactor([heading, heading.next], motion.direction)
    return DenseFactor([place, speed.next, heading, heading.next], motion.direction)


def _sighting(site: Site, views: Views, place: Variable, sighting: Variable, presets: list[Variable]) -> NoisyOr:
    """P(z | l, C): the detecting camera with the least noise reports the cell; nobody detects: `UNSEEN`.

    Nobody detects a target that is outside.
    """
    beyond = place.size - site.grid.size
    emissions = {noise: _with_silence(confusion_kernel(site.grid, noise), beyond) for noise in set(views.noise_m)}
    order = sorted(range(len(presets)), key=lambda camera: views.noise_m[camera])
    detection = [np.pad(np.asarray(one, dtype=float), ((0, 0), (0, beyond))) for one in views.detection]
    causes = [Cause(presets[i].next, detection[i], emissions[views.noise_m[i]]) for i in order]
    return NoisyOr([place.next], sighting, UNSEEN, causes)


def _with_silence(kernel: csr_array, beyond: int) -> Any:
    """A column for `UNSEEN`, on which a detection puts nothing, and a row for each place that no camera sees."""
    from scipy.sparse import csr_array

    cells = kernel.shape[0]
    indptr = np.append(kernel.indptr, kernel.indptr[-1] + 1 + np.arange(beyond, dtype=kernel.indptr.dtype))
    data, indices = (
        np.append(kernel.data, np.ones(beyond)),
        np.append(kernel.indices, np.zeros(beyond, kernel.indices.dtype)),
    )
    return csr_array((data, indices, indptr), shape=(cells + beyond, cells + 1))
