"""Tells somebody when a camera is lost or returns: the site's ``alert_command``."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import threading
from collections.abc import Callable, Collection

from factored_pomdp.commands.answers import side_console

__all__ = ["alerter"]

_LONGEST_S = 30.0


def alerter(command: str, site: str, secrets: Collection[str] = ()) -> Callable[[str, str, str], None]:
    """Runs the command with one more word, such as ``hall: north is lost: no answer``, and never waits for it.

    No shell is asked, so nothing that a camera says can become part of a command. ``secrets``: names of environment
    variables that the command does not get, such as those that hold the cameras' passwords.

    Raises
    ------
    ValueError
        Where there is no such program, or a quotation does not end.
    """
    try:
        words = shlex.split(command)
    except ValueError as problem:
        raise ValueError(str(problem).lower()) from None
    if not words or shutil.which(words[0]) is None:
        raise ValueError(f"no program {words[0]!r} is there" if words else "it is empty")

    def tell(camera: str, state: str, because: str) -> None:
        message = f"{site}: {camera} {'is lost' if state == 'lost' else 'has returned'}" + (
            f": {because}" * bool(because)
        )
        side_console().print(message, soft_wrap=True)
        threading.Thread(target=_run, args=([*words, message], secrets), name="alert", daemon=True).start()

    return tell


def _run(words: list[str], secrets: Collection[str]) -> None:
    told = {name: value for name, value in os.environ.items() if name not in secrets}
    try:
        subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, check=True, timeout=_LONGEST_S, env=told)
    except (OSError, subprocess.SubprocessError) as problem:
        side_console().print(f"warning: alert_command failed: {problem}", soft_wrap=True)
