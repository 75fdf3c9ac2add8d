"""What the service manager that started a process is told of it: that it is ready, alive, stopping.

systemd's protocol, ``sd_notify(3)``: lines in a datagram to the socket that ``NOTIFY_SOCKET`` names. Where that is not
set, nobody is told.
"""

from __future__ import annotations

import os
import socket
from contextlib import suppress

__all__ = ["ALIVE", "READY", "STOPPING", "notify"]

READY = "READY=1"
ALIVE = "WATCHDOG=1"
STOPPING = "STOPPING=1"
_PATIENCE_S = 1.0


def notify(*states: str) -> None:
    """Tell it; never raises, for a watch goes on whether or not it is heard.

    Parameters
    ----------
    *states : str
        Such as `READY`, in one datagram.
    """
    address = os.environ.get("NOTIFY_SOCKET", "")
    if address[:1] not in ("/", "@"):  # "@": a name in the kernel's own, abstract space
        return
    with suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as teller:
        teller.settimeout(_PATIENCE_S)
        teller.sendto("\n".join(states).encode(), "\0" + address[1:] if address[0] == "@" else address)
