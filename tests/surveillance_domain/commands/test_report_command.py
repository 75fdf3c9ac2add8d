"""The morning's report of nights that went badly: killed runs, full disks, records of older versions."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("cv2")

from surveillance_domain.control.record import RecordWriter, read_record

COMMAND = (sys.executable, "-c", "from surveillance_domain.commands import main; main()")
RUN = ("run", "tiny", "--emulated", "--fast", "--no-pictures")


@pytest.fixture(autouse=True)
def state(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))


def rewritten(record: Path, change: Callable[[list[dict[str, Any]]], list[dict[str, Any]]]) -> None:
    """The first file of a record with other lines."""
    path = sorted(record.glob("*.jsonl"))[0]
    lines = change([json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()])
    path.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")


def hours_before(lines: list[dict[str, Any]], hours: float) -> list[dict[str, Any]]:
    """All of it earlier by the clock on the wall."""

    def earlier(moment: str) -> str:
        return (datetime.fromisoformat(moment) - timedelta(hours=hours)).isoformat()

    times = ("written", "run")
    return [{key: earlier(value) if key in times else value for key, value in line.items()} for line in lines]


@pytest.mark.end_to_end
def test_five_hours_in_which_nobody_watched_come_first(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    record, out = tmp_path / "record", tmp_path / "morning"
    surveillance(*RUN, "--steps", 4, "--record", record)
    rewritten(record, lambda lines: hours_before(lines[:-1], 5))  # killed before it could close
    surveillance(*RUN, "--steps", 6, "--record", record)
    told = surveillance("report", record, "--out", out, "--json").json
    assert [(run["how"], run["steps"], run["ended"] is None) for run in told["runs"]] == [
        ("killed", 4, True),
        ("steps", 6, False),
    ]
    (gap,) = told["unwatched"]
    assert gap["seconds"] == pytest.approx(5 * 3600, abs=60)
    assert gap["because"] == "run 1: ended without closing: killed, crashed or power lost"
    assert told["unwatched_s"] == gap["seconds"]
    assert told["watched_s"] == pytest.approx(10.0)  # ten steps of a second in virtual time
    for name in ("report.txt", "report.html"):
        text = (out / name).read_text(encoding="utf-8")
        assert text.index("Watched for 10 s, not watched for 5 h 0 min.") < text.index("Nobody watched from 20")
        assert "(5 h 0 min): run 1: ended without closing: killed, crashed or power lost." in text
        assert "6 steps: all 6 steps done" in text
    assert 'class="alarm"' in (out / "report.html").read_text(encoding="utf-8")
    assert surveillance("replay-run", record, "--json").json["steps"] == 6


@pytest.mark.end_to_end
def test_a_run_that_is_there_is_told_from_one_that_was_killed(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    record = tmp_path / "record"
    words = [*COMMAND, *RUN, "--record", str(record)]
    with subprocess.Popen(words, env=os.environ, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            while not any(line["kind"] == "step" for line in (read_record(record) if any(record.glob("*")) else ())):
                assert process.poll() is None
                time.sleep(0.1)
            there = surveillance("report", record, "--json").json
        finally:
            process.send_signal(signal.SIGKILL)
    assert (there["runs"][0]["how"], there["unwatched"]) == ("running", [])
    killed = surveillance("report", record, "--json").json
    assert killed["runs"][0]["how"] == "killed"
    assert [(gap["over"], gap["ended"]) for gap in killed["unwatched"]] == [(False, None)]
    shown = surveillance("report", record).out
    assert "Nobody watched after 20" in shown
    assert "ended without closing: killed, crashed or power lost, last step at 20" in " ".join(shown.split())


@pytest.mark.end_to_end
def test_records_of_older_versions_can_still_be_read(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    record = tmp_path / "record"
    surveillance(*RUN, "--steps", 4, "--record", record)
    rewritten(
        record,
        lambda lines: [
            {key: value for key, value in line.items() if key not in ("closes", "virtual")} for line in lines[:-1]
        ],
    )
    told = surveillance("report", record, "--json").json
    assert (told["steps"], told["runs"][0]["how"], told["unwatched"]) == (4, "unknown", [])
    assert surveillance("replay-run", record, "--json").json["steps"] == 4
    assert surveillance("report", record, "--step", 2, "--json").json["why"]["step"] == 2


@pytest.mark.end_to_end
def test_steps_that_could_not_be_recorded_are_told_by_run_and_report(
    surveillance: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    honest = RecordWriter.write

    def full(self: RecordWriter, entry: Any) -> None:
        if 4 <= entry["step"] <= 9:
            raise OSError(28, "No space left on device")
        honest(self, entry)

    monkeypatch.setattr(RecordWriter, "write", full)
    record = tmp_path / "record"
    found = surveillance(*RUN, "--steps", 12, "--record", record)
    assert found.code == 1
    assert found.err.splitlines() == [
        f"warning: --record {record}: the record cannot be written: no space left on device; the watch goes on without "
        "it",
        f"warning: --record {record}: the record is written again",
    ]
    assert f"6 of 12 steps are not in the record {record}: no space left on device." in " ".join(found.out.split())
    told = surveillance("report", record, "--json").json
    assert [(gap["first_step"], gap["steps"]) for gap in told["unrecorded"]] == [(4, 6)]
    assert (told["steps"], told["unwatched"], told["watched_s"]) == (6, [], pytest.approx(12.0))
    shown = " ".join(surveillance("report", record).out.split())
    assert "Watched, but not recorded: 6 steps." in shown
    assert "6 steps were not recorded, 20" in shown


@pytest.mark.end_to_end
@pytest.mark.parametrize(("error", "how"), [(KeyError("x"), "error"), (KeyboardInterrupt(), "stopped")])
def test_what_ends_a_run_by_force_is_in_its_record(
    error: BaseException,
    how: str,
    surveillance: Callable[..., Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from surveillance_domain.control.watch import Watch

    honest = Watch.entry

    def fails(self: Watch, step: Any) -> dict[str, Any]:
        if step.number == 3:
            raise error
        return honest(self, step)

    monkeypatch.setattr(Watch, "entry", fails)
    if how == "error":
        with pytest.raises(KeyError):
            surveillance(*RUN, "--record", tmp_path)
    else:
        assert surveillance(*RUN, "--record", tmp_path).code == 130
    last = list(read_record(tmp_path))[-1]
    assert (last["kind"], last["how"]) == ("end", how)
    assert last["because"] == {"error": "failed: KeyError", "stopped": "interrupted at once, by a second signal"}[how]


@pytest.mark.end_to_end
def test_a_full_disk_is_one_message_and_nothing_half_written(
    surveillance: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from matplotlib.figure import Figure

    def full(self: Figure, file: Any, **options: Any) -> None:
        file.write(b"half a picture")
        raise OSError(28, "No space left on device")

    record, out = tmp_path / "record", tmp_path / "morning"
    surveillance(*RUN, "--steps", 2, "--record", record)
    monkeypatch.setattr(Figure, "savefig", full)
    found = surveillance("report", record, "--out", out)
    assert (found.code, found.out, found.err) == (2, "", f"cannot write in {out}: no space left on device\n")
    assert list(out.iterdir()) == []
    picture = surveillance("coverage", "tiny", "--out", tmp_path / "views.png")
    assert (picture.code, picture.out) == (2, "")
    assert picture.err == f"{tmp_path / 'views.png'}: no space left on device\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["morning", "record"]
