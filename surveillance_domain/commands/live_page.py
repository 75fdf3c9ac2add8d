"""The live page of ``surveillance run``: what was asked for, and serving it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from factored_pomdp.commands.answers import InputError, side_console

if TYPE_CHECKING:
    from surveillance_domain.commands.network import Network
    from surveillance_domain.control.loop import Step
    from surveillance_domain.control.watch import Watch
    from surveillance_domain.control.watch_state import WatchState

__all__ = ["Page", "PageAddress", "PageOrigin", "PagePort", "PageRequest", "live_page", "page_request"]

Page = Annotated[bool, typer.Option("--page", help="Serve a live page for browsers.")]
PagePort = Annotated[
    int | None, typer.Option(min=0, max=65_535, help="Of the page; 0: any that is free.  [default: 5006]")
]
PageAddress = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="To which the page is bound; others than this machine need SURVEILLANCE_PAGE_TOKEN.  [default: 127.0.0.1]",
    ),
]
PageOrigin = Annotated[
    list[str] | None,
    typer.Option(metavar="HOST[:PORT]", help="Another name under which browsers reach the page; may be repeated."),
]

_PORT, _ADDRESS = 5006, "127.0.0.1"


@dataclass(frozen=True)
class PageRequest:
    """A page that may be served.

    Attributes
    ----------
    address : str
    port : int
    token : str or None
    origins : tuple of str
    """

    address: str
    port: int
    token: str | None
    origins: tuple[str, ...]


def page_request(page: bool, port: int | None, address: str | None, origins: list[str] | None) -> PageRequest | None:
    """What was asked for; ``None``: no page.

    Raises
    ------
    InputError
        For options of a page that is not asked for, and for an address that others reach without a token.
    """
    from surveillance_domain.page.door import DoorError, required_token

    if not page:
        given = [name for name, one in (("port", port), ("address", address), ("origin", origins)) if one]
        if given:
            raise InputError(f"--page-{given[0]} is for the live page only: add --page")
        return None
    where = _ADDRESS if address is None else address
    try:
        token = required_token(where)
    except DoorError as problem:
        raise InputError(str(problem)) from None
    return PageRequest(where, _PORT if port is None else port, token, tuple(origins or ()))


@contextmanager
def live_page(
    request: PageRequest | None, watch: Watch, network: Network, holds: WatchState, controller: str
) -> Iterator[Callable[[Step], None]]:
    """Serve the page; gives what shows a step on it, and does nothing if no page is asked for."""
    if request is None:
        yield lambda step: None
        return
    from surveillance_domain.control.pomdp import PomdpController
    from surveillance_domain.page.from_watch import snapshot_of
    from surveillance_domain.page.live import LivePage, PageMissing
    from surveillance_domain.page.session import Content
    from surveillance_domain.world.picture_eyes import PictureEyes

    eyes = network.eyes
    sights = (lambda: eyes.sights) if isinstance(eyes, PictureEyes) else None
    content = Content(
        network.surveillance,
        controller,
        holds,
        truth=network.truth is not None,
        belief=isinstance(watch.controller, PomdpController),
        pictures=sights is not None,
    )
    page = LivePage(content, request.address, request.port, request.token, request.origins)
    try:
        page.__enter__()
    except PageMissing as problem:
        raise InputError(str(problem)) from None
    except OSError as problem:
        number = problem.errno or 0
        reason = os.strerror(number) if number > 0 else str(problem.strerror or problem)
        raise InputError(
            f"the page cannot be served at {request.address} port {request.port}: {reason.lower()}; "
            "give another --page-address or --page-port"
        ) from None
    try:
        side_console().print(f"page: {page.url}", soft_wrap=True)
        yield lambda step: page.show(
            snapshot_of(step, watch, network.surveillance, network.truth, sights() if sights is not None else None)
        )
    finally:
        page.__exit__(None, None, None)
