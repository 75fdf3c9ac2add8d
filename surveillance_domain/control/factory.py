"""Controllers by the paper's names."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from surveillance_domain.control.base import Controller
from surveillance_domain.control.blind import StaticController, SystematicController
from surveillance_domain.control.bounds import ClairvoyantController, FullInformationController
from surveillance_domain.control.lookahead import LookaheadChooser
from surveillance_domain.control.mdp import MdpController
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.control.roster import OpenRoster
from surveillance_domain.model.build import Surveillance
from surveillance_domain.world.base import TrueWorld

__all__ = ["COMPARED", "CONTROLLERS", "NAMES", "WITH_TRUTH", "Setting", "make_controller"]

COMPARED = ("pomdp", "mp", "msp", "sys", "stat", "full-information", "clairvoyant")
"""The paper's methods and the bounds: what its figure compares."""

WITH_TRUTH = ("full-information", "clairvoyant")
"""The bounds, which are shown what no controller can know."""

CONTROLLERS = (*COMPARED, "lookahead")
NAMES = {
    "pomdp": "P",
    "mp": "MP",
    "msp": "MSP",
    "sys": "Sys",
    "stat": "Stat",
    "full-information": "full information",
    "clairvoyant": "clairvoyant",
    "lookahead": "lookahead",
}
"""As the paper's figure has them."""


@dataclass(frozen=True)
class Setting:
    """What a controller may need besides the model.

    Attributes
    ----------
    world : TrueWorld, optional
        For the bounds alone, `WITH_TRUTH`.
    steps : int
        How far the clairvoyant must see.
    run : int
        Number of the run; gives Sys its phase, and seeds what the lookahead simulates.
    open_roster : bool
        Whether targets come and go for ``pomdp`` and ``lookahead``; the others know those of the model only.
    """

    world: TrueWorld | None = None
    steps: int = 0
    run: int = 0
    open_roster: bool = False


def make_controller(name: str, surveillance: Surveillance, setting: Setting) -> Controller:
    """A fresh controller.

    Raises
    ------
    ValueError
        For an unknown name, or a site that lacks what the controller needs.
    """
    if name in ("pomdp", "lookahead"):
        ahead = LookaheadChooser(surveillance, rng=np.random.default_rng(setting.run)) if name == "lookahead" else None
        return PomdpController(surveillance, ahead, OpenRoster(surveillance) if setting.open_roster else None)
    if name in ("mp", "msp"):
        return MdpController(surveillance, static=name == "msp")
    if name == "sys":
        return SystematicController(surveillance, phase=setting.run)
    if name == "stat":
        return StaticController(surveillance)
    if name in WITH_TRUTH:
        world = setting.world
        if world is None:
            raise ValueError(f"{name} is a bound: it needs to be shown the truth, and there is none here")
        if name == "full-information":
            return FullInformationController(surveillance, lambda: world.truth)
        return ClairvoyantController(surveillance, _future(world, setting.steps))
    raise ValueError(f"no controller {name!r} (there are: {', '.join(CONTROLLERS)})")


def _future(world: TrueWorld, steps: int) -> Int[np.ndarray, "steps targets"]:
    """True cells after each step: a truth's steps can be taken before the world takes them."""
    truth = world.truth
    cells = np.empty((steps, len(truth.cells)), dtype=np.int64)
    for step in range(steps):
        truth = truth.step()
        cells[step] = truth.cells
    return cells
