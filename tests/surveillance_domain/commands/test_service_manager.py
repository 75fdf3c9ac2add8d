"""What systemd is told, over real sockets; and the unit that expects it."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
from collections.abc import Callable
from configparser import ConfigParser
from pathlib import Path
from typing import Any

import pytest

from surveillance_domain.commands.service_manager import ALIVE, READY, notify

UNIT = Path(__file__).parents[3] / "examples" / "surveillance.service"


def heard(listener: socket.socket) -> list[str]:
    listener.setblocking(False)
    found = []
    while True:
        try:
            found.append(listener.recv(4096).decode())
        except BlockingIOError:
            return found


@pytest.mark.example
@pytest.mark.parametrize("abstract", [False, True])
def test_a_datagram_reaches_the_socket_that_is_named(
    abstract: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = f"@factored-pomdp-{os.getpid()}" if abstract else str(tmp_path / "notify")
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(name.replace("@", "\0") if abstract else name)
        monkeypatch.setenv("NOTIFY_SOCKET", name)
        notify(READY)
        notify(READY, ALIVE)
        assert heard(listener) == ["READY=1", "READY=1\nWATCHDOG=1"]
    notify(ALIVE)  # nobody listens any more: that is no error


@pytest.mark.example
@pytest.mark.parametrize("name", [None, "", "vsock:2:1234", "/nowhere/notify"])
def test_without_a_socket_nobody_is_told(name: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NOTIFY_SOCKET", raising=False)
    if name is not None:
        monkeypatch.setenv("NOTIFY_SOCKET", name)
    notify(READY)


@pytest.mark.end_to_end
def test_a_run_tells_that_it_is_ready_after_its_first_step_then_that_it_is_alive_and_stopping(
    surveillance: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("cv2")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(str(tmp_path / "notify"))
        monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
        assert surveillance("run", "tiny", "--emulated", "--fast", "--no-pictures", "--steps", 3).code == 0
        assert heard(listener) == ["READY=1\nWATCHDOG=1", "WATCHDOG=1", "WATCHDOG=1", "STOPPING=1"]


@pytest.mark.example
def test_the_unit_expects_what_is_told() -> None:
    unit = ConfigParser(strict=False, interpolation=None)
    unit.read(UNIT, encoding="utf-8")
    service = unit["Service"]
    assert (service["Type"], service["Restart"]) == ("notify", "on-failure")
    assert int(service["WatchdogSec"]) >= 60
    assert int(service["TimeoutStartSec"]) >= 300  # it is ready when all is compiled
    systemd = shutil.which("systemd-analyze")
    if systemd is None:
        pytest.skip("no systemd-analyze here")
    told = subprocess.run([systemd, "verify", str(UNIT)], capture_output=True, text=True, check=False).stderr
    complaints = [line for line in told.splitlines() if UNIT.name in line]
    assert all("is not executable: No such file or directory" in line for line in complaints), told
