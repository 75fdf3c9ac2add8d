"""Ids of the installed domains in Gymnasium's registry."""

from __future__ import annotations

import gymnasium

from factored_pomdp.registry import domain_names

__all__ = ["NAMESPACE", "STEPS", "register_domains"]

NAMESPACE = "factored_pomdp"
STEPS = 100
"""After so many steps an episode is truncated, unless ``gymnasium.make(…, max_episode_steps=…)`` says otherwise."""


def register_domains() -> list[str]:
    """Register every installed domain that is not registered yet, without loading any; the ids of all of them.

    A name that cannot be part of an id is left out with a warning.
    """
    ids = []
    for name in domain_names():
        identity = f"{NAMESPACE}/{name}-v0"
        try:
            if identity not in gymnasium.registry:
                gymnasium.register(
                    identity,
                    entry_point="factored_pomdp.gymnasium.environment:of_domain",
                    max_episode_steps=STEPS,
                    kwargs={"domain": name},
                )
        except gymnasium.error.Error as problem:
            gymnasium.logger.warn(f"domain {name!r} is no environment: {problem}")
        else:
            ids.append(identity)
    return ids
