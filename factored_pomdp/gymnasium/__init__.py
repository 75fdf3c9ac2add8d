"""Every installed domain as a Gymnasium environment: importing this registers ``factored_pomdp/NAME-v0`` for each.

Gymnasium 1.0 took away the entry points by which packages used to register themselves, so that somebody has to import
this; ``gymnasium.make("factored_pomdp.gymnasium:factored_pomdp/tiger-v0")`` does so by itself. A domain is loaded when
an environment is made of it: one that is broken harms nobody else.
"""

from __future__ import annotations

from factored_pomdp.gymnasium.environment import Environment, of_domain
from factored_pomdp.gymnasium.registration import register_domains

__all__ = ["Environment", "of_domain", "register_domains"]

register_domains()
