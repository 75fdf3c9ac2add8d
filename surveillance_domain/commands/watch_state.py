"""The state of a site that commands share, and being the only one who commands its cameras."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from factored_pomdp.commands.answers import InputError, side_console

if TYPE_CHECKING:
    from surveillance_domain.control.watch_state import WatchState
    from surveillance_domain.site.site import Site

__all__ = ["alone", "state_of"]

_POLL_S = 0.2


def state_of(site: Site) -> WatchState:
    """The site's state.

    Raises
    ------
    InputError
        If its folder cannot be made, though the disk is well.
    """
    from surveillance_domain.control.watch_state import WatchState

    try:
        return WatchState(site)
    except (OSError, RuntimeError) as problem:  # RuntimeError: there is no home
        reason = (getattr(problem, "strerror", None) or str(problem)).lower()
        raise InputError(f"no place to keep who holds which camera: {reason}; set XDG_STATE_HOME") from None


@contextmanager
def alone(state: WatchState, patience_s: float = 0.0) -> Iterator[None]:
    """Be the only one who commands the cameras, as soon as somebody else who is just ending has ended.

    What a full disk keeps from being locked is a warning.

    Raises
    ------
    InputError
        If somebody else does, naming the process.
    """
    from surveillance_domain.control.watch_state import AlreadyRun

    until = time.monotonic() + patience_s
    while True:
        lock = state.locked()
        try:
            faults = lock.__enter__()
        except AlreadyRun as problem:
            if time.monotonic() >= until:
                raise InputError(str(problem)) from None
            time.sleep(_POLL_S)
        else:
            break
    try:
        if faults:
            warning = "warning: another run of these cameras may not be refused, for this cannot be locked:"
            more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
            side_console().print(f"{warning} {faults[0]}{more}", soft_wrap=True)
        yield
    finally:
        lock.__exit__(None, None, None)
