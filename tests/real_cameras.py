"""Emulated cameras in real time, a site file that leads to them, and commands as processes of their own."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveillance_domain.cameras.clock import RealClock
from surveillance_domain.control.record import read_record
from surveillance_domain.emulation.site import USERNAME, EmulatedSite
from surveillance_domain.site.load import load_site

__all__ = ["FAST", "Real", "real_cameras", "started", "until_recorded"]

COMMAND = (sys.executable, "-c", "from surveillance_domain.commands import main; main()")
FAST = ("--emulated", "--fast", "--no-pictures")


@dataclass
class Real:
    """Cameras on loopback, and the site file that leads to them."""

    path: Path
    emulation: EmulatedSite

    def pans(self) -> dict[str, float]:
        return {name: camera.motors.true()[0] for name, camera in self.emulation.cameras.items()}

    def turn(self, pan: float) -> None:
        for camera in self.emulation.cameras.values():
            camera.motors.command({"pan": str(pan)})


@contextmanager
def real_cameras(tmp_path: Path) -> Iterator[Real]:
    """Three cameras of a small site, in real time, and a site file for them."""
    text = (resources.files("surveillance_domain.site") / "builtin" / "tiny.toml").read_text(encoding="utf-8")
    text = text.replace("width = 704, height = 576", "width = 176, height = 144")
    text = text.replace("max_depth_m = 5.0", f'max_depth_m = 5.0\nhome = "middle"\nusername = "{USERNAME}"')
    path = tmp_path / "site.toml"
    path.write_text(text, encoding="utf-8")
    with EmulatedSite(load_site(path), 1, RealClock(), np.random.default_rng(0)) as emulation:
        for name, server in emulation.servers.items():
            text = text.replace(
                f'name = "{name}"', f'name = "{name}"\nurl = "{server.url}"\npassword_env = "CAM_PASSWORD"'
            )
        path.write_text(text, encoding="utf-8")
        yield Real(path, emulation)


@contextmanager
def started(*words: object) -> Iterator[subprocess.Popen[str]]:
    """The command as a process, which is gone at the end."""
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen([*COMMAND, *map(str, words)], env=os.environ, **pipes) as process:
        try:
            yield process
        finally:
            process.kill()


def until_recorded(record: Path, process: subprocess.Popen[str], steps: int) -> None:
    """Wait for some steps of a record."""
    for _ in range(600):
        if any(record.glob("*.jsonl")) and sum(line["kind"] == "step" for line in read_record(record)) >= steps:
            return
        if process.poll() is not None:
            pytest.fail(f"it ended: {process.communicate()}")
        time.sleep(0.1)
    pytest.fail("it recorded nothing")
