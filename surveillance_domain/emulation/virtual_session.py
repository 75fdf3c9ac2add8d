"""HTTP in virtual time: the exchange is real, but how long the client waits is told to the server, whose clock it is.

On a wall clock a client hangs up by itself. In virtual time no time passes while it waits for its answer, unless the
server lets it; so the server hangs up on its behalf.
"""

from __future__ import annotations

from typing import Any

import requests
from requests.adapters import HTTPAdapter

__all__ = ["PATIENCE", "virtual_session"]

PATIENCE = "X-Emulated-Patience"
"""Header of requests in virtual time: for how many seconds the client waits for an answer."""

_REAL_TIMEOUT_S = 600.0


def virtual_session() -> requests.Session:
    """A session for `surveillance_domain.cameras.opening.open_camera` on a virtual clock; for emulated cameras only."""
    session = requests.Session()
    session.mount("http://", _PatientAdapter())
    return session


class _PatientAdapter(HTTPAdapter):
    """Passes the read timeout on as a header."""

    def send(self, request: requests.PreparedRequest, *args: Any, **kwargs: Any) -> requests.Response:
        timeout = kwargs.get("timeout")
        if isinstance(timeout, tuple):
            request.headers[PATIENCE] = repr(timeout[1])
        return super().send(request, *args, **{**kwargs, "timeout": _REAL_TIMEOUT_S})
