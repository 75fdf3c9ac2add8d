"""The server of the page: in a thread of its own, beside the watch, which it can neither hold up nor end."""

from __future__ import annotations

import asyncio
import socket
import threading
import time
from collections.abc import Sequence
from concurrent.futures import Future
from types import TracebackType
from typing import TYPE_CHECKING, Any

from surveillance_domain.page.door import allowed_origins, door
from surveillance_domain.page.feed import Feed
from surveillance_domain.page.log import quieten
from surveillance_domain.page.session import Content, Session
from surveillance_domain.page.snapshot import Snapshot

if TYPE_CHECKING:
    from bokeh.document import Document
    from bokeh.server.server import BaseServer
    from tornado.httpserver import HTTPServer
    from tornado.ioloop import IOLoop

__all__ = ["LivePage", "PageMissing"]

_SHORTEST_S = 0.25
"""Between two updates; steps that come faster are shown together."""
_PING_S, _PONG_S = 20.0, 20.0
"""A browser that has not answered by then is let go, so that nothing piles up for it."""


class PageMissing(RuntimeError):
    """Bokeh is not installed; the message says how to install it."""


class LivePage:
    """Serves from entering to leaving it.

    Parameters
    ----------
    content : Content
    address : str
    port : int
        0: any that is free.
    token : str, optional
        That browsers must give.
    origins : sequence of str
        Further addresses under which the page is reached (`allowed_origins`).

    Raises
    ------
    PageMissing, OSError
        On entering it: without Bokeh, or if the port is taken.
    """

    def __init__(
        self,
        content: Content,
        address: str = "127.0.0.1",
        port: int = 0,
        token: str | None = None,
        origins: Sequence[str] = (),
    ) -> None:
        self._content, self._address, self._wanted_port = content, address, port
        self._token, self._origins = token, tuple(origins)
        self._feed = Feed()
        self._sessions: dict[Document, Session] = {}
        self._due = False
        self._shown_s = 0.0
        self._thread: threading.Thread | None = None

    def __enter__(self) -> LivePage:
        try:
            import bokeh.server.server  # noqa: F401
        except ModuleNotFoundError as problem:
            if problem.name != "bokeh":
                raise
            raise PageMissing("the page needs Bokeh: pip install 'factored-pomdp[page]'") from None
        quieten()
        ready: Future[BaseServer] = Future()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve(ready)), name="page", daemon=True)
        self._thread.start()
        server = ready.result()
        self._loop: IOLoop = server.io_loop
        self.port = int(server.port)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Serve no more; may be called twice."""
        if self._thread is not None:
            self._loop.add_callback(self._stopped.set)
            self._thread.join()
            self._thread = None

    @property
    def url(self) -> str:
        """Where it can be opened on this machine."""
        host = "127.0.0.1" if self._address in ("0.0.0.0", "::") else self._address
        return f"http://{f'[{host}]' if ':' in host else host}:{self.port}/"

    def show(self, snapshot: Snapshot) -> None:
        """A step is over; to be called from the thread of the watch. Comes back at once."""
        self._feed.put(snapshot)
        self._loop.add_callback(self._tell)

    async def _serve(self, ready: Future[BaseServer]) -> None:
        try:
            self._stopped = asyncio.Event()
            http, server = self._servers()
            server.start()
        except BaseException as problem:
            ready.set_exception(problem)
            return
        ready.set_result(server)
        await self._stopped.wait()
        server.stop()
        await http.close_all_connections()

    def _servers(self) -> tuple[HTTPServer, BaseServer]:
        from bokeh.server.server import BaseServer
        from bokeh.server.tornado import BokehTornado
        from tornado.httpserver import HTTPServer
        from tornado.ioloop import IOLoop

        family = socket.AF_INET6 if ":" in self._address else socket.AF_INET
        listening = socket.create_server((self._address, self._wanted_port), family=family)
        listening.setblocking(False)
        port = listening.getsockname()[1]
        options: dict[str, Any] = {}
        if self._token is not None:
            options["auth_provider"], options["cookie_secret"] = door(self._token, port)
        application = BokehTornado(
            {"/": self._open},
            extra_websocket_origins=allowed_origins(self._address, port, self._origins),
            use_index=False,
            include_headers=[],  # neither these nor cookies go into the page
            include_cookies=[],
            websocket_ping_interval=_PING_S,
            websocket_ping_timeout=_PONG_S,
            **options,
        )
        http = HTTPServer(application)
        http.add_sockets([listening])
        return http, BaseServer(IOLoop.current(), application, http)

    def _open(self, document: Document) -> None:
        self._sessions[document] = Session(document, self._content, self._feed)
        document.on_session_destroyed(lambda context: self._close(document))

    def _close(self, document: Document) -> None:
        self._sessions.pop(document, None)

    def _tell(self) -> None:
        """In the page's thread: let every browser's next tick show the last step, but not too often."""
        if self._due:
            return
        self._due = True
        wait = max(0.0, self._shown_s + _SHORTEST_S - time.monotonic())
        self._loop.call_later(wait, self._update)

    def _update(self) -> None:
        self._due, self._shown_s = False, time.monotonic()
        for document, session in list(self._sessions.items()):
            document.add_next_tick_callback(session.update)
