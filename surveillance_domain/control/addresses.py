"""What tells cameras apart, however a site file writes their addresses."""

from __future__ import annotations

import hashlib
import ipaddress
import socket
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from urllib.parse import urlsplit

from surveillance_domain.site.camera import Camera

__all__ = ["addresses"]

_AT_ONCE = 16
"""Names that are looked up at the same time: a name server that is away takes seconds to be given up."""


def addresses(cameras: Iterable[Camera]) -> dict[str, tuple[str, ...]]:
    """For each camera that has a ``url``, by its name, the names of files that are about it.

    Two site files mean the same camera if they have one in common: by the host's name, or by any numeric address that
    the name stands for now; with the port, if it is not that of the scheme, and the channel.
    """
    known = {camera.name: (camera.url, camera.channel) for camera in cameras if camera.url is not None}
    numbers = _numbers({urlsplit(url).hostname or "" for url, _ in known.values()})
    return {name: _places(url, channel, numbers) for name, (url, channel) in known.items()}


def _places(url: str, channel: int, numbers: Mapping[str, frozenset[str]]) -> tuple[str, ...]:
    parts = urlsplit(url)
    port = "" if parts.port in (None, 80, 443) else f":{parts.port}"
    hosts = sorted({parts.hostname or ""} | numbers[parts.hostname or ""])
    return tuple(hashlib.sha256(f"{host}{port} channel {channel}".encode()).hexdigest()[:16] for host in hosts)


def _numbers(hosts: set[str]) -> dict[str, frozenset[str]]:
    """The numeric addresses of hosts; none for one that is not found."""
    with ThreadPoolExecutor(_AT_ONCE) as pool:
        return dict(zip(hosts, pool.map(_looked_up, hosts), strict=True))


def _looked_up(host: str) -> frozenset[str]:
    try:
        return frozenset({str(ipaddress.ip_address(host))})
    except ValueError:
        pass
    try:
        found = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        return frozenset()
    return frozenset(str(address[0]) for *_, address in found)
