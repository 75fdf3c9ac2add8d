"""It runs for weeks: memory, open files and threads stay as they are, and the record goes on in new files.

``SOAK_STEPS=100000`` makes it the whole soak: ten thousand steps took 124 seconds of one processor.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("cv2")

from surveillance_domain.control.record import read_record

ROOT = Path(__file__).parents[3]
STEPS = int(os.environ.get("SOAK_STEPS", "10000"))
MOST_BYTES = 15_000_000
"""By which memory may differ between the third tenth and the last one: what allocators keep, no line for each step."""
_FEW_ARENAS = {"MALLOC_ARENA_MAX": "2"}
"""The emulator draws pictures in threads; for each one the C library keeps some 17 MB apart as soon as two meet."""


@pytest.mark.slow
@pytest.mark.end_to_end
@pytest.mark.timeout(7200)
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read from /proc, as Linux has it")
def test_a_long_watch_uses_no_more_and_more(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "tests.soak", str(STEPS), str(tmp_path)]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False, env=os.environ | _FEW_ARENAS)
    assert done.returncode == 0, done.stderr
    *told, summary = (json.loads(line) for line in done.stdout.splitlines())
    assert summary["steps"] == STEPS
    assert summary["unrecorded"] == 0
    assert told[-1]["step"] == STEPS
    early = told[2]
    assert told[-1]["bytes"] - early["bytes"] < MOST_BYTES, told
    assert told[-1]["files"] <= early["files"] + 3, told
    assert told[-1]["threads"] <= early["threads"] + 3, told
    found = [line["step"] for line in read_record(tmp_path) if line["kind"] == "step"]
    assert found == list(range(1, STEPS + 1))
    assert len(list(tmp_path.iterdir())) > STEPS // 3000
