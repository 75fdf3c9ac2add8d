"""The command as a process of its own: what it loads, and Ctrl-C."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

COMMAND = (sys.executable, "-c", "from surveillance_domain.commands import main; main()")
HEAVY = ("numpy", "scipy", "numba", "matplotlib", "PIL", "pgmpy", "cvxpy", "yaml")


@pytest.mark.end_to_end
@pytest.mark.parametrize(("words", "heavy"), [(("--help",), (*HEAVY, "pydantic")), (("compare", "--help"), HEAVY)])
def test_help_loads_nothing_heavy(words: tuple[str, ...], heavy: tuple[str, ...]) -> None:
    """The options of a subcommand make typer itself load pydantic."""
    code = (
        "import sys, atexit\n"
        f"atexit.register(lambda: print('loaded', sorted(set({heavy!r}) & set(sys.modules)), file=sys.stderr))\n"
        "from surveillance_domain.commands import main\n"
        f"main({list(words)!r})\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "Usage: surveillance" in done.stdout
    assert done.stderr.strip() == "loaded []"


@pytest.mark.end_to_end
@pytest.mark.parametrize("workers", [1, 2])
def test_ctrl_c_leaves_a_valid_partial_result(tmp_path: Path, workers: int) -> None:
    words = ("compare", "micro", "--targets", "1", "--controllers", "sys,pomdp", "--steps", "20", "--runs", "100000")
    more = ("--workers", str(workers), "--out", str(tmp_path), "--json", "--progress")
    process = subprocess.Popen(
        [*COMMAND, *words, *more],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=_hears_interrupts,
    )
    assert process.stderr is not None
    first = process.stderr.readline()
    assert "comparing" in first
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers, too
    out, err = process.communicate(timeout=120)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    found = json.loads(out)
    assert found["interrupted"] is True
    assert 0 < found["rows"][0]["runs"] < 100000
    assert len(found["rows"][0]["per_run"]) == found["rows"][0]["runs"]
    assert json.loads((tmp_path / "result.json").read_text()) == found
    assert not [path.name for path in tmp_path.iterdir() if path.name.startswith(".")]
    assert _all_gone(process.pid)


def _hears_interrupts() -> None:
    """What a shell starts in the background ignores interrupts, and hands that on."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _all_gone(group: int, patience_s: float = 30.0) -> bool:
    """Whether every process of the group ends."""
    until = time.monotonic() + patience_s
    while time.monotonic() < until:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.05)
    return False
