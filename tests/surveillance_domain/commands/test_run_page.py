"""``surveillance run --page``."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import requests

pytest.importorskip("cv2")
pytest.importorskip("bokeh")

from surveillance_domain.page.door import TOKEN_VARIABLE


@pytest.fixture(autouse=True)
def alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No token, and nobody else's cameras that are held."""
    monkeypatch.delenv(TOKEN_VARIABLE, raising=False)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--page-port", 8000], "--page-port is for the live page only: add --page"),
        (["--page-origin", "a.example"], "--page-origin is for the live page only: add --page"),
        (
            ["--page", "--page-address", "0.0.0.0"],
            f"it needs a token: set {TOKEN_VARIABLE} to 16 characters or more",
        ),
    ],
)
def test_what_does_not_go_together_is_refused(surveillance: Callable[..., Any], words: list[object], told: str) -> None:
    answer = surveillance("run", "lego", "--emulated", *words)
    assert answer.code == 2
    assert told in answer.err


@pytest.mark.end_to_end
def test_a_port_that_is_taken_is_refused(surveillance: Callable[..., Any]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        answer = surveillance("run", "lego", "--emulated", "--fast", "--steps", 1, "--page", "--page-port", port)
    assert answer.code == 2
    assert f"the page cannot be served at 127.0.0.1 port {port}: address already in use; give another" in answer.err


@pytest.mark.end_to_end
def test_the_page_is_there_while_the_cameras_run_and_no_longer() -> None:
    command = [sys.executable, "-c", "from surveillance_domain.commands import main; main()"]
    words = ["run", "lego", "--emulated", "--no-pictures", "--page", "--page-port", "0", "--json"]
    process = subprocess.Popen([*command, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        assert process.stderr is not None
        first = process.stderr.readline().decode()
        url = re.fullmatch(r"page: (http://127\.0\.0\.1:\d+/)\n", first)
        assert url is not None, first
        with requests.Session() as session:
            session.trust_env = False
            answer = session.get(url[1], timeout=60)
            assert "<title>lego: pomdp, 5 targets</title>" in answer.text
            os.kill(process.pid, signal.SIGINT)
            out, err = process.communicate(timeout=60)
            assert (process.returncode, err) == (0, b"")
            assert b'"site": "lego"' in out
            with pytest.raises(requests.ConnectionError):
                session.get(url[1], timeout=60)
    finally:
        process.kill()
        process.communicate()
