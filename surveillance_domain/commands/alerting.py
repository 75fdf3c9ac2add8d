"""Tells somebody when a camera is lost or returns: the site's ``alert_command``."""

from __future__ import annotations

import shlex
import subprocess
import threading
from collections.abc import Callable

from factored_pomdp.commands.answers import side_console

__all__ = ["alerter"]

_LONGEST_S = 30.0


def alerter(command: str, site: str) -> Callable[[str, str, str], None]:
    """Runs the command with one more word, such as ``hall: north is lost: no answer``, and never waits for it.

    No shell is asked, so nothing that a camera says can become part of a command.
    """
    words = shlex.split(command)

    def tell(camera: str, state: str, because: str) -> None:
        message = f"{site}: {camera} {'is lost' if state == 'lost' else 'has returned'}" + (
            f": {because}" * bool(because)
        )
        side_console().print(message, soft_wrap=True)
        threading.Thread(target=_run, args=([*words, message],), name="alert", daemon=True).start()

    return tell


def _run(words: list[str]) -> None:
    try:
        subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, check=True, timeout=_LONGEST_S)
    except (OSError, subprocess.SubprocessError) as problem:
        side_console().print(f"warning: alert_command failed: {problem}", soft_wrap=True)
