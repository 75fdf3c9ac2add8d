"""What Bokeh's server writes to the log of a watch."""

from __future__ import annotations

import logging

import pytest

from surveillance_domain.page.log import quieten

WS = logging.getLogger("bokeh.server.views.ws")


@pytest.mark.example
def test_a_browser_that_went_away_is_no_news(caplog: pytest.LogCaptureFixture) -> None:
    quieten()
    quieten()
    WS.warning("Failed sending message as connection was closed")
    WS.warning("something else")
    assert [record.getMessage() for record in caplog.records] == ["something else"]
    assert len(WS.filters) == 1


@pytest.mark.example
def test_a_foreign_page_is_told_of_with_an_option_that_there_is(caplog: pytest.LogCaptureFixture) -> None:
    quieten()
    advice = "Refusing websocket connection from Origin '%s'; use --allow-websocket-origin=%s or set X to permit this"
    WS.error(advice, "http://evil.example", "evil.example")
    assert [record.getMessage() for record in caplog.records] == [
        "a browser on a page of http://evil.example was refused; --page-origin lets it in"
    ]
