"""What commands say of a disk that is full, and with which exit code."""

from __future__ import annotations

import errno
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from factored_pomdp.commands.answers import InputError
from surveillance_domain.commands.run_record import begun_record, summed_up
from surveillance_domain.commands.watch_state import alone
from surveillance_domain.control import file_lock
from surveillance_domain.control.record import read_record
from surveillance_domain.control.watch_state import WatchState
from surveillance_domain.site.load import load_site

LEGO = load_site("lego")
SITE = replace(LEGO, cameras=(LEGO.cameras[0].model_copy(update={"url": "http://192.168.0.90"}),))


def _no_room(path: Path, *words: object) -> int:
    raise OSError(errno.ENOSPC, "No space left on device", str(path))


@pytest.mark.example
def test_what_cannot_be_locked_is_a_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    state = WatchState(SITE, tmp_path / "site")
    with alone(state):
        assert capsys.readouterr().err == ""
    monkeypatch.setattr(file_lock, "_opened", _no_room)
    with alone(state):
        told = capsys.readouterr().err
    assert told == (
        "warning: another run of these cameras may not be refused, for this cannot be locked: "
        f"{tmp_path / 'site' / 'lock'}: no space left on device (and 1 more)\n"
    )


@pytest.mark.end_to_end
@pytest.mark.usefixtures("state")
def test_a_hold_that_cannot_be_kept_is_no_wrong_input(
    surveillance: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(WatchState, "hold", lambda *words: _no_room(Path("south.held")))
    refused = surveillance("hold", "lego", "south")
    assert refused.code == 1
    assert refused.err == "south cannot be held: south.held: no space left on device\n"
    assert "south cannot be released" in surveillance("hold", "lego", "south", "--release").err


@pytest.mark.end_to_end
@pytest.mark.usefixtures("state")
def test_a_run_goes_on_without_its_record_and_ends_with_1(
    surveillance: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("cv2")
    monkeypatch.setattr("surveillance_domain.control.record.RecordWriter._begin", _no_room)
    words = ("run", "tiny", "--emulated", "--fast", "--no-pictures", "--steps", 3, "--record", tmp_path, "--json")
    found = surveillance(*words)
    assert (found.code, found.json["steps"], found.json["unrecorded"]) == (1, 3, 3)
    assert found.json["unrecorded_because"] == "no space left on device"
    assert "the record cannot be written: no space left on device; the watch goes on without it" in found.err


@pytest.mark.example
def test_a_record_where_no_folder_can_be_is_wrong_input(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=f"--record {tmp_path}/file: file exists"):
        begun_record(tmp_path / "file", {}, 7.0)
    begun_record(tmp_path / "record", {}, 7.0).close()
    assert [line["kind"] for line in read_record(tmp_path / "record")] == ["header"]


@pytest.mark.example
@pytest.mark.parametrize(
    ("lost", "because", "taken_off", "expected"),
    [
        (0, "", 0, (0, "")),
        (2, "no space left on device", 0, (2, "no space left on device")),
        (2, "no space left on device", 1, (3, "no space left on device")),
        (0, "", 1, (1, "no room for how the run ended")),
    ],
)
def test_the_step_that_made_room_for_the_end_is_counted(
    lost: int, because: str, taken_off: int, expected: tuple[int, str]
) -> None:
    watch: Any = SimpleNamespace(summary=lambda: {"steps": 9, "unrecorded": lost, "unrecorded_because": because})
    written: Any = SimpleNamespace(taken_off=taken_off)
    found = summed_up(watch, written)
    assert (found["unrecorded"], found["unrecorded_because"], found["steps"]) == (*expected, 9)
    assert summed_up(watch, None)["unrecorded"] == lost
