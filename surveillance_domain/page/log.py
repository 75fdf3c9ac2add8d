"""Bokeh's log as the operator of a watch needs it."""

from __future__ import annotations

import logging

__all__ = ["quieten"]

_LOGGER = "bokeh.server.views.ws"
_ORIGIN_ADVICE = "--allow-websocket-origin"


class _OurWords(logging.Filter):
    """A browser that went away is no news; a foreign page is, in words of options that there are."""

    def filter(self, record: logging.LogRecord) -> bool:
        text = record.getMessage()
        if "connection was closed" in text:
            return False
        if _ORIGIN_ADVICE in text:
            # the origin is the first thing that Bokeh's message is filled with
            origin = record.args[0] if isinstance(record.args, tuple) and record.args else "another address"
            record.msg, record.args = "a browser on a page of %s was refused; --page-origin lets it in", (origin,)
        return True


_FILTER = _OurWords()


def quieten() -> None:
    """Let Bokeh's log say what concerns an operator; calling it again changes nothing."""
    logging.getLogger(_LOGGER).addFilter(_FILTER)
