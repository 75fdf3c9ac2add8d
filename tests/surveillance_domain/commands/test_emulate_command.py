"""``surveillance emulate``."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import pytest
import requests
from requests.auth import HTTPDigestAuth

pytest.importorskip("cv2")


@pytest.mark.end_to_end
def test_it_serves_until_it_is_told_to_stop() -> None:
    command = [sys.executable, "-c", "from surveillance_domain.commands import main; main()"]
    process = subprocess.Popen(
        [*command, "emulate", "lego", "--targets", "2", "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    try:
        assert process.stdout is not None
        lines = []
        for line in process.stdout:
            lines.append(line)
            if line.rstrip() == b"}":
                break
        found = json.loads(b"".join(lines))
        assert [camera["name"] for camera in found["cameras"]] == ["south", "north-west", "north-east"]
        with requests.Session() as session:
            session.trust_env = False
            session.auth = HTTPDigestAuth(found["username"], found["password"])
            for camera in found["cameras"]:
                picture = session.get(f"{camera['url']}/axis-cgi/jpg/image.cgi", timeout=30)
                assert picture.content.startswith(b"\xff\xd8\xff")
        os.kill(process.pid, signal.SIGINT)
        _, err = process.communicate(timeout=30)
        assert process.returncode == 0
        assert err.decode().strip() == "Ctrl-C ends them."
    finally:
        process.kill()
        process.communicate()


@pytest.mark.end_to_end
def test_a_table_for_people_and_an_end_of_its_own(surveillance: Callable[..., Any]) -> None:
    answer = surveillance("emulate", "tiny", "--seconds", "0.05")
    assert answer.code == 0
    assert answer.out.count("http://127.0.0.1:") == 4
    assert "User operator, password emulated." in answer.out


@pytest.mark.end_to_end
def test_a_port_that_is_taken(surveillance: Callable[..., Any]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        answer = surveillance("emulate", "tiny", "--port", port, "--seconds", "0.05")
    assert answer.code == 2
    assert f"--port {port}: address already in use" in answer.err


@pytest.mark.end_to_end
def test_a_site_that_is_not_there(surveillance: Callable[..., Any]) -> None:
    answer = surveillance("emulate", "lega", "--seconds", "0.05")
    assert answer.code == 2
    assert "did you mean lego" in answer.err
