"""Whether a port speaks TLS or plain HTTP, for those who find out why a camera does not answer."""

from __future__ import annotations

import socket
import ssl
from urllib.parse import urlsplit

__all__ = ["other_scheme"]

_QUESTION = b"GET / HTTP/1.0\r\n\r\n"


def other_scheme(url: str, timeout_s: float) -> str | None:
    """``http`` or ``https`` if the address speaks that and not the one that the url says; else ``None``."""
    parts = urlsplit(url)
    secure = parts.scheme == "https"
    address = (parts.hostname or "", parts.port or (443 if secure else 80))
    try:
        if secure:
            return "http" if _answers_plainly(address, timeout_s) else None
        return "https" if _shakes_hands(address, timeout_s) else None
    except OSError:
        return None


def _answers_plainly(address: tuple[str, int], timeout_s: float) -> bool:
    with socket.create_connection(address, timeout_s) as connection:
        connection.sendall(_QUESTION)
        return connection.recv(5) == b"HTTP/"


def _shakes_hands(address: tuple[str, int], timeout_s: float) -> bool:
    """Whether there is TLS at all; whose certificate it is does not matter here, and nothing is said."""
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    with (
        socket.create_connection(address, timeout_s) as connection,
        context.wrap_socket(connection, server_hostname=address[0]) as secured,
    ):
        return secured.version() is not None
