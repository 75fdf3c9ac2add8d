"""Controllers by the paper's names."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from surveillance_domain.control.base import Controller
from surveillance_domain.control.blind import StaticController, SystematicController
from surveillance_domain.control.bounds import ClairvoyantController, FullInformationController
from surveillance_domain.control.mdp import MdpController
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.model.build import Surveillance
from surveillance_domain.world.base import TrueWorld

__all__ = ["CONTROLLERS", "NAMES", "Setting", "make_controller"]

CONTROLLERS = ("pomdp", "mp", "msp", "sys", "stat", "full-information", "clairvoyant")
NAMES = {
    "pomdp": "P",
    "mp": "MP",
    "msp": "MSP",
    "sys": "Sys",
    "stat": "Stat",
    "full-information": "full information",
    "clairvoyant": "clairvoyant",
}
"""As the paper's figure has them."""


@dataclass(frozen=True)
class Setting:
    """What a controller may need besides the model.

    Attributes
    ----------
    world : TrueWorld
        For the bounds alone.
    steps : int
        How far the clairvoyant must see.
    run : int
        Number of the run; gives Sys its phase.
    """

    world: TrueWorld
    steps: int
    run: int = 0


def make_controller(name: str, surveillance: Surveillance, setting: Setting) -> Controller:
    """A fresh controller.

    Raises
    ------
    ValueError
        For an unknown name, or a site that lacks what the controller needs.
    """
    if name == "pomdp":
        return PomdpController(surveillance)
    if name in ("mp", "msp"):
        return MdpController(surveillance, static=name == "msp")
    if name == "sys":
        return SystematicController(surveillance, phase=setting.run)
    if name == "stat":
        return StaticController(surveillance)
    if name == "full-information":
        return FullInformationController(surveillance, lambda: setting.world.truth)
    if name == "clairvoyant":
        return ClairvoyantController(surveillance, _future(setting))
    raise ValueError(f"no controller {name!r} (there are: {', '.join(CONTROLLERS)})")


def _future(setting: Setting) -> Int[np.ndarray, "steps targets"]:
    """True cells after each step: a truth's steps can be taken before the world takes them."""
    truth = setting.world.truth
    cells = np.empty((setting.steps, len(truth.cells)), dtype=np.int64)
    for step in range(setting.steps):
        truth = truth.step()
        cells[step] = truth.cells
    return cells
