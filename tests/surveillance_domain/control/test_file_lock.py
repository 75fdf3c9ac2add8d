"""Locks between processes, on disks that are well and on those that are not."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from surveillance_domain.control.file_lock import is_locked, locked, shared

NO_ROOM = "No space left on device"


def _full(*words: object) -> int:
    raise OSError(errno.ENOSPC, NO_ROOM)


@pytest.mark.example
def test_who_holds_it_is_written_there_for_as_long_as_it_is_held(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    with locked(path, "process 1") as before:
        assert before == ("", "")
        assert path.read_text() == "process 1"
        assert is_locked(path)
        with locked(path, "process 2") as (holder, _):
            assert holder == "process 1"
        assert path.read_text() == "process 1"
    assert path.read_text() == ""
    assert not is_locked(path)


@pytest.mark.example
def test_many_share_what_nobody_has_alone(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    assert not is_locked(path)
    with shared(path):
        with shared(path):
            pass
        assert is_locked(path)
    assert not is_locked(path)


@pytest.mark.example
@pytest.mark.skipif(not Path("/proc/locks").is_file(), reason="needs /proc/locks")
def test_without_room_for_a_word_the_kernel_says_who(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, kernels = tmp_path / "lock", tmp_path / "locks"
    monkeypatch.setattr(os, "pwrite", _full)
    status = tmp_path.stat()
    device = f"{os.major(status.st_dev):02x}:{os.minor(status.st_dev):02x}"
    monkeypatch.setattr("surveillance_domain.control.file_lock._KERNELS", kernels)
    with locked(path, "process 1") as before:
        assert before == ("", "")
        inode = path.stat().st_ino
        with locked(path, "process 2") as (holder, _):
            assert holder == "an unknown process"
        kernels.write_text(
            f"1: POSIX ADVISORY WRITE 7 {device}:{inode} 0 EOF\n2: FLOCK ADVISORY WRITE 4892 {device}:{inode} 0 EOF\n"
        )
        with locked(path, "process 2") as (holder, _):
            assert holder == "process 4892"


@pytest.mark.example
def test_a_file_that_is_there_can_be_locked_where_nothing_may_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there, missing, honest = tmp_path / "there", tmp_path / "missing", os.open

    def read_only(path: Path, flags: int, *mode: int) -> int:
        if flags & os.O_RDWR:
            raise OSError(errno.EROFS, "Read-only file system", str(path))
        return honest(path, flags, *mode)

    there.write_text("")
    monkeypatch.setattr(os, "open", read_only)
    with locked(there, "process 1") as before:
        assert before == ("", "")
        with locked(there, "process 2") as (holder, _):
            assert holder
    with pytest.raises(OSError, match=r"Read-only file system: '\S+/missing'"), locked(missing, "process 1"):
        pass


@pytest.mark.example
def test_a_process_that_is_killed_leaves_it_free(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    script = (
        "import os, sys, pathlib\nfrom surveillance_domain.control.file_lock import locked\n"
        "with locked(pathlib.Path(sys.argv[1]), f'process {os.getpid()}'):\n"
        "    print('held', flush=True)\n    sys.stdin.read()\n"
    )
    words = [sys.executable, "-c", script, str(path)]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        with locked(path, "process 1") as (holder, killed):
            assert (holder, killed) == (f"process {process.pid}", "")
        process.kill()
        process.wait()
        with locked(path, "process 1") as (holder, killed):
            assert (holder, killed) == ("", f"process {process.pid}")
            assert path.read_text() == "process 1"
        with locked(path, "process 1") as before:
            assert before == ("", "")
