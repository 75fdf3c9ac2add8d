"""What commands tell each other on a disk that is full, or may only be read."""

from __future__ import annotations

import errno
import os
from dataclasses import replace
from pathlib import Path

import pytest

from surveillance_domain.cameras.base import Position
from surveillance_domain.control.watch_state import AlreadyRun, WatchState
from surveillance_domain.site.load import load_site
from surveillance_domain.world.memory import Stood

LEGO = load_site("lego")
SITE = replace(
    LEGO,
    cameras=tuple(
        one.model_copy(update={"url": f"http://192.168.0.{number}"}) for number, one in enumerate(LEGO.cameras, 90)
    ),
)


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files can be made, and no byte be written to them."""
    honest = Path.write_text

    def no_room(self: Path, text: str, **more: str) -> int:
        honest(self, "", encoding="utf-8")
        raise OSError(errno.ENOSPC, "No space left on device")

    def nothing(*words: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_text", no_room)
    monkeypatch.setattr(os, "pwrite", nothing)


@pytest.fixture
def no_more_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing can be made, not even an empty file."""
    honest = os.open

    def opened(path: str | Path, flags: int, *mode: int, **more: int) -> int:
        if flags & os.O_CREAT and not Path(path).exists():
            raise OSError(errno.ENOSPC, "No space left on device", str(path))
        return honest(path, flags, *mode, **more)

    def nothing(path: str | Path, *words: object, **more: str) -> int:
        raise OSError(errno.ENOSPC, "No space left on device", str(path))

    monkeypatch.setattr(os, "open", opened)
    monkeypatch.setattr(os, "mkdir", nothing)
    monkeypatch.setattr(Path, "write_text", nothing)


@pytest.mark.example
def test_on_a_full_disk_one_commands_and_a_second_is_refused(tmp_path: Path, full: None) -> None:
    mine, theirs = WatchState(SITE, tmp_path / "a"), WatchState(SITE, tmp_path / "b")
    with mine.locked() as faults:
        assert faults == []
        with pytest.raises(AlreadyRun, match="is being run already, by "), WatchState(SITE, tmp_path / "a").locked():
            pass
        with pytest.raises(AlreadyRun, match=r"camera 'south' .* is commanded already, by "), theirs.locked():
            pass
    with theirs.locked() as faults:
        assert faults == []


@pytest.mark.example
def test_on_a_full_disk_an_empty_file_holds(tmp_path: Path, full: None) -> None:
    mine, theirs = WatchState(SITE, tmp_path / "a"), WatchState(SITE, tmp_path / "b")
    mine.hold("south")
    mine.hold("south")
    assert theirs.held() == {"south"}
    (kept,) = (tmp_path / "cameras").iterdir()
    assert (kept.suffix, kept.stat().st_size) == (".held", 0)
    theirs.hold("south", hold=False)
    assert mine.held() == frozenset()
    mine.memories()["south"].keep(Stood(Position(1.0, 2.0, 3.0), 0.0))
    assert list((tmp_path / "cameras").iterdir()) == []  # nor anything half-written


@pytest.mark.example
def test_what_cannot_be_locked_is_told_of_and_the_rest_is_locked(
    tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    with WatchState(SITE, tmp_path / "a").locked():
        pass
    request.getfixturevalue("no_more_files")
    known, new = WatchState(SITE, tmp_path / "a"), WatchState(SITE, tmp_path / "b")
    with known.locked() as faults:
        assert faults == []
        with pytest.raises(AlreadyRun, match="camera 'south'"), new.locked():
            pass
    with new.locked() as faults:
        assert faults[0] == f"{tmp_path / 'b'}: no space left on device"
        with known.heeding():
            assert not known.heeded("south")  # it cannot be said, and stops nobody
    with pytest.raises(OSError, match=r"No space left on device: '\S+\.held'"):
        known.hold("south")
    assert known.held() == frozenset()
    with pytest.raises(OSError, match=rf"No space left on device: '{tmp_path}/b'"):
        new.hold("south")


@pytest.mark.example
def test_a_state_folder_that_is_none_is_no_matter_of_the_disk(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(NotADirectoryError):
        WatchState(SITE, tmp_path / "file" / "a")
