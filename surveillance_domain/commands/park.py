"""``surveillance park``: cameras that nobody holds go to their ``home`` preset."""

from __future__ import annotations

import typer

from factored_pomdp.commands.answers import AsJson, answer, table
from surveillance_domain.commands.options import SiteName, input_checked
from surveillance_domain.commands.watch_state import alone, state_of

__all__ = ["park"]

_PATIENCE_S = 5.0
"""For a run that is just ending."""


def park(site: SiteName, as_json: AsJson = False) -> None:
    """Send cameras to their home preset; those that people hold, or turned in the last yield_s, are left alone.

    It works after a run was killed, and refuses while one goes on.
    """
    import numpy as np

    from surveillance_domain.cameras.clock import RealClock
    from surveillance_domain.commands.network import opened
    from surveillance_domain.site.load import load_site
    from surveillance_domain.world.parking import parked

    with input_checked():
        found = load_site(site)
    state = state_of(found)
    with alone(state, _PATIENCE_S):
        clock = RealClock()
        cameras = opened(found, clock, np.random.default_rng())
        try:
            outcomes = parked(found, cameras, clock, state.held(), state.memories(), state.killed)
        finally:
            for camera in cameras:
                camera.close()
    shown = table("camera", "outcome")
    for name, outcome in outcomes.items():
        shown.add_row(name, outcome.told)
    content = {
        "site": found.name,
        "cameras": [{"name": name, "ok": one.ok, "outcome": one.told} for name, one in outcomes.items()],
    }
    answer(content, [shown], as_json=as_json)
    if not all(one.ok for one in outcomes.values()):
        raise typer.Exit(1)
