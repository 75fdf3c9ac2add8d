"""The record of a watch: whole lines whatever happens, new files in time, old ones gone."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.control.record import RecordError, RecordWriter, is_being_written, read_record

HEADER = {"site": "lego", "step_s": 1.5}

WRITES_FOR_EVER = """
import sys
from pathlib import Path
from surveillance_domain.control.record import RecordWriter
record = RecordWriter(Path(sys.argv[1]), {"site": "lego"}, 7, full_bytes=400_000)
print("ready", flush=True)
number = 0
while True:
    number += 1
    record.write({"step": number, "filling": "ä" * (number * 37 % 5000)})
"""


def steps(folder: Path) -> list[int]:
    return [line["step"] for line in read_record(folder) if line["kind"] == "step"]


@pytest.mark.end_to_end
def test_a_kill_at_any_moment_loses_at_most_the_line_that_was_being_written(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    for number in range(4):
        folder = tmp_path / str(number)
        writer = subprocess.Popen(
            [sys.executable, "-c", WRITES_FOR_EVER, str(folder)], stdout=subprocess.PIPE, text=True
        )
        assert writer.stdout is not None
        assert writer.stdout.readline() == "ready\n"
        time.sleep(float(rng.uniform(0.0, 0.15)))
        writer.send_signal(signal.SIGKILL)
        writer.wait()
        writer.stdout.close()
        found = steps(folder)
        assert found == list(range(1, len(found) + 1))
        with RecordWriterClosed(folder) as again:  # whoever comes next writes on
            again.write({"step": -1})
        assert steps(folder) == [*found, -1]


class RecordWriterClosed:
    def __init__(self, folder: Path, **options: Any) -> None:
        self.writer = RecordWriter(folder, HEADER, 7.0, **options)

    def __enter__(self) -> RecordWriter:
        return self.writer

    def __exit__(self, *args: object) -> None:
        self.writer.close()


@pytest.mark.property
@settings(max_examples=40)
@given(st.integers(0, 400))
def test_a_line_torn_anywhere_is_passed_over_at_the_end_of_a_file(cut: int) -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with RecordWriterClosed(folder) as record:
            for number in range(3):
                record.write({"step": number, "who": "Änne"})
        (path,) = folder.iterdir()
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) - min(cut, len(whole))])
        kept = whole[: len(whole) - min(cut, len(whole))].decode(errors="ignore")
        complete = sum(1 for line in kept.split("\n") if line.endswith("}"))
        assert len(list(read_record(folder))) == complete


@pytest.mark.example
def test_a_full_file_is_followed_by_another_with_the_same_header(tmp_path: Path) -> None:
    with RecordWriterClosed(tmp_path, full_bytes=500) as record:
        for number in range(20):
            record.write({"step": number})
    lines = list(read_record(tmp_path))
    headers = [line for line in lines if line["kind"] == "header"]
    assert [line["part"] for line in headers] == list(range(len(list(tmp_path.iterdir()))))
    assert len(headers) > 2
    assert {line["run"] for line in headers} == {headers[0]["run"]}
    assert all(line["site"] == "lego" for line in headers)
    assert steps(tmp_path) == list(range(20))
    assert all(path.stat().st_size < 700 for path in tmp_path.iterdir())


@pytest.mark.example
def test_what_is_older_than_keep_days_goes_when_a_file_is_begun(tmp_path: Path) -> None:
    old, young, other = tmp_path / "record-a.jsonl", tmp_path / "record-b.jsonl", tmp_path / "mine.txt"
    for path, days in ((old, 7.5), (young, 6.5), (other, 100.0)):
        path.write_text("")
        os.utime(path, (time.time() - 86400 * days,) * 2)
    RecordWriter(tmp_path, HEADER, 7.0).close()
    assert not old.exists()
    assert young.exists()
    assert other.exists()


@pytest.mark.example
def test_after_a_full_disk_a_new_file_is_begun_and_nothing_torn_is_left_inside(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with RecordWriterClosed(tmp_path) as record:
        record.write({"step": 1})
        honest, room = os.write, [10]

        def full(file: int, content: bytes) -> int:
            if not room[0]:
                raise OSError(errno.ENOSPC, "No space left on device")
            done = honest(file, content[: room[0]])
            room[0] -= done
            return done

        monkeypatch.setattr(os, "write", full)
        for number in (2, 3):
            with pytest.raises(OSError, match="No space left"):
                record.write({"step": number})
        monkeypatch.setattr(os, "write", honest)
        record.write({"step": 4})
    assert steps(tmp_path) == [1, 4]
    assert len(list(tmp_path.iterdir())) == 2
    assert all(path.read_bytes().endswith(b"}\n") for path in tmp_path.iterdir())


class Disk:
    """So many bytes and no more, on this file or on all; what is taken off again gives no room back."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, room: int, each_file: bool) -> None:
        self._honest, self._room, self._each = os.write, room, each_file
        monkeypatch.setattr(os, "write", self.write)

    def write(self, file: int, content: bytes) -> int:
        if self._each:
            room = self._room - os.fstat(file).st_size
        else:
            folder = Path(f"/proc/self/fd/{file}").resolve().parent
            room = self._room - sum(path.stat().st_size for path in folder.glob("*.jsonl"))
        if room <= 0:
            raise OSError(errno.EFBIG if self._each else errno.ENOSPC, "no room")
        return self._honest(file, content[:room])


@pytest.mark.example
def test_a_file_that_may_grow_no_further_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As with ``ulimit -f``."""
    Disk(monkeypatch, 600, each_file=True)
    record = RecordWriter(tmp_path, HEADER, 7.0)
    for number in range(1, 21):
        record.write({"step": number})
    record.end({"how": "steps", "because": "", "steps": 20, "unrecorded": 0})
    assert steps(tmp_path) == list(range(1, 21))
    assert list(read_record(tmp_path))[-1]["kind"] == "end"


@pytest.mark.example
@pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="needs /proc")
@pytest.mark.parametrize("more", range(0, 200, 13))
def test_how_a_run_ended_is_told_even_on_a_full_disk(
    more: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wherever a step is torn; at most one more goes, to make room, and is counted."""
    Disk(monkeypatch, 1500 + more, each_file=False)
    record, lost = RecordWriter(tmp_path, HEADER, 7.0), 0
    for number in range(1, 21):
        try:
            record.write({"step": number, "filling": "x" * 100})
        except OSError:
            lost += 1
    record.end({"how": "steps", "because": "all 20 steps done", "steps": 20, "unrecorded": lost})
    lines = list(read_record(tmp_path))
    assert lines[-1]["kind"] == "end"
    assert 0 < lost <= lines[-1]["unrecorded"] == lost + record.taken_off <= lost + 1
    assert steps(tmp_path) == list(range(1, 21 - lines[-1]["unrecorded"]))
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.example
def test_on_a_disk_that_is_full_from_the_start_the_record_begins_when_there_is_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = Disk(monkeypatch, 100, each_file=False)
    record = RecordWriter(tmp_path / "record", HEADER, 7.0)
    with pytest.raises(OSError, match="no room"):
        record.write({"step": 1})
    assert not list((tmp_path / "record").iterdir())
    disk._room = 10_000
    record.write({"step": 2})
    record.end({"how": "steps", "because": "", "steps": 2, "unrecorded": 1})
    header, step, end = read_record(tmp_path / "record")
    assert (header["part"], step["step"], end["unrecorded"]) == (0, 2, 1)


@pytest.mark.example
def test_what_never_began_ends_with_the_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Disk(monkeypatch, 100, each_file=False)
    record = RecordWriter(tmp_path, HEADER, 7.0)
    with pytest.raises(OSError, match="no room"):
        record.end({"how": "steps", "because": "", "steps": 0, "unrecorded": 0})
    assert not list(tmp_path.iterdir())


@pytest.mark.example
def test_a_folder_that_is_none_is_no_matter_of_the_disk(tmp_path: Path) -> None:
    (tmp_path / "record").write_text("")
    with pytest.raises(FileExistsError):
        RecordWriter(tmp_path / "record", HEADER, 7.0)


@pytest.mark.example
def test_a_record_that_is_being_written_is_told_from_one_that_is_not(tmp_path: Path) -> None:
    assert not is_being_written(tmp_path)
    record = RecordWriter(tmp_path, HEADER, 7.0, full_bytes=300)
    first = next(tmp_path.iterdir())
    assert is_being_written(tmp_path)
    assert is_being_written(first)
    for number in range(10):
        record.write({"step": number})
        assert is_being_written(tmp_path)
    assert not is_being_written(first)  # it goes on in others
    record.close()
    assert not is_being_written(tmp_path)


@pytest.mark.example
def test_what_is_no_record_is_named(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="no record here"):
        list(read_record(tmp_path))
    path = tmp_path / "record-x.jsonl"
    path.write_text('{"kind": "header"}\nnonsense\n{"kind": "step"}\n')
    with pytest.raises(RecordError, match="line 2: expected a JSON object with a kind, found 'nonsense"):
        list(read_record(tmp_path))
    path.write_text(json.dumps({"kind": "poem"}) + "\n")
    with pytest.raises(RecordError, match="line 1"):
        list(read_record(path))
