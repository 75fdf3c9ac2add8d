"""The controllers, and the variants of MP that the paper leaves open: what becomes of a target out of sight."""

from __future__ import annotations

from surveillance_domain.control.base import Controller
from surveillance_domain.control.factory import CONTROLLERS, NAMES, Setting, make_controller
from surveillance_domain.control.mdp import MdpController, OutOfSight
from surveillance_domain.model.build import Surveillance

__all__ = ["ALL_NAMES", "BOUNDS", "VARIANTS", "make_variant"]

BOUNDS = ("full-information", "clairvoyant")
"""Controllers that know what no camera shows."""

_OUT_OF_SIGHT: dict[str, OutOfSight] = {"mp-hold": "hold", "mp-dead-reckoning": "dead-reckoning"}

VARIANTS = (*CONTROLLERS, *_OUT_OF_SIGHT)
"""Every name that `make_variant` takes; ``mp`` itself drops a target out of sight."""

ALL_NAMES = {**NAMES, "mp-hold": "MP, holding", "mp-dead-reckoning": "MP, dead reckoning"}
"""As tables and pictures have them."""


def make_variant(name: str, surveillance: Surveillance, setting: Setting) -> Controller:
    """A fresh controller, or variant of one.

    Raises
    ------
    ValueError
        For an unknown name, or a site that lacks what the controller needs.
    """
    if name in _OUT_OF_SIGHT:
        return MdpController(surveillance, out_of_sight=_OUT_OF_SIGHT[name])
    return make_controller(name, surveillance, setting)
