"""A watch over cameras: what it sums up, records and tells."""

from __future__ import annotations

import re
import socket
from dataclasses import replace
from itertools import islice
from pathlib import Path

import pytest

pytest.importorskip("cv2")

from surveillance_domain.control.morning import Morning
from surveillance_domain.control.record import RecordWriter, read_record
from surveillance_domain.control.replaying import Refilter, sighting_of
from surveillance_domain.control.watch import Watch
from surveillance_domain.control.watch_state import AlreadyRun, WatchState
from surveillance_domain.model.build import surveillance_model
from tests.emulated_watch import Emulated, emulated_watch, lego

PASSWORD = "emulated"


def steps(running: Emulated, count: int) -> None:
    for _ in islice(running.watch.turns(), count):
        pass


@pytest.mark.end_to_end
def test_the_summary_adds_up() -> None:
    with emulated_watch(lego(), 2, 3, strangers=1) as running:
        taken = [step.observed for step in islice(running.watch.turns(), 10)]
        found = running.watch.summary()
    assert found["steps"] == 10
    assert found["seen"] == pytest.approx(sum(taken) / 10)
    assert found["percent_obs"] == pytest.approx(100 * sum(taken) / 10 / 3)  # of three that are there, one a stranger
    assert found["roster"]["now"] == ["red", "blue", "marker 2"]
    assert (found["roster"]["started"], found["late"], found["unrecorded"]) == (1, 0, 0)
    assert [camera["state"] for camera in found["cameras"]] == ["ready"] * 3


@pytest.mark.end_to_end
def test_without_truth_there_is_no_percent_obs() -> None:
    with emulated_watch(lego(), 2, 3) as running:
        watch = Watch(running.world, running.controller)
        for _ in islice(watch.turns(), 3):
            pass
        found = watch.summary()
    assert found["percent_obs"] is None
    assert found["expected_observed"] > 0
    assert found["seen"] is not None


@pytest.mark.end_to_end
def test_the_record_leads_to_the_same_belief_and_holds_no_secret(tmp_path: Path) -> None:
    with emulated_watch(lego(), 3, 5, strangers=1) as running:
        record = RecordWriter(tmp_path, {"site": "lego"}, 7.0)
        watch = Watch(running.world, running.controller, record, lambda: running.emulation.truth)
        running.emulation.cameras["south"].faults.wrong_password = True
        for step in islice(watch.turns(), 15):
            last = step
        record.close()
        lines = [line for line in read_record(tmp_path) if line["kind"] == "step"]
        refilter = Refilter(surveillance_model(lego(), 3))
        for line in lines:
            best = max(value for _, value in refilter.values())
            assert best == pytest.approx(line["value"], abs=1e-9)
            refilter.take(line)
        assert sighting_of(lines[-1]) == last.sighting
        for mine, theirs in zip(refilter.belief.arrays, running.controller.belief.arrays, strict=True):
            assert mine == pytest.approx(theirs, abs=1e-12)
    text = "".join(path.read_text() for path in tmp_path.iterdir())
    assert PASSWORD not in text
    assert "Digest" not in text
    assert lines[-1]["cameras"]["south"]["fault"] in {"LoginRefused", "CameraAway"}
    assert lines[-1]["cameras"]["south"]["state"] == "locked out"
    assert set(lines[-1]["roster"]) >= {"red", "blue", "green"}
    assert len(lines[-1]["truth_m"]) == 4


@pytest.mark.end_to_end
def test_lost_and_returned_cameras_are_told_of_once() -> None:
    told: list[tuple[str, str]] = []
    with emulated_watch(lego(), 1, 1) as running:
        running.watch._alert = lambda camera, state, because: told.append((camera, state))
        steps(running, 2)
        faults = running.emulation.cameras["south"].faults
        faults.drop_share = 1.0
        steps(running, 4)
        assert told == [("south", "lost")]
        assert running.watch.summary()["cameras"][0]["state"] == "away"
        faults.drop_share = 0.0
        running.clock.sleep(40.0)
        steps(running, 3)
        assert told == [("south", "lost"), ("south", "returned")]
        assert running.watch.summary()["cameras"][0]["state"] == "ready"


@pytest.mark.end_to_end
def test_a_camera_that_answers_but_shows_nothing_is_lost_after_half_a_minute() -> None:
    told: list[tuple[str, str, str]] = []
    with emulated_watch(lego(), 1, 1) as running:
        running.watch._alert = lambda *words: told.append(words)
        steps(running, 2)
        running.emulation.cameras["south"].faults.pan_drift_deg_per_s = 0.0
        running.emulation.cameras["south"].motors._drift_deg = 7.0
        running.clock.sleep(100.0)
        steps(running, 2)
        assert told == []  # somebody else moved it, for all that one can know, and has it
        running.world._nodes["south"].yielding._yield_s = 0.0
        steps(running, 3)
        running.clock.sleep(31.0)
        steps(running, 2)
        assert [(camera, state) for camera, state, _ in told] == [("south", "lost")]
        assert running.watch.summary()["cameras"][0]["state"] == "no view"


@pytest.mark.end_to_end
def test_a_record_that_cannot_be_written_is_told_of_and_does_not_stop_the_watch(tmp_path: Path) -> None:
    told: list[tuple[str, ...]] = []

    class Full(RecordWriter):
        room = False

        def write(self, entry: object) -> None:
            if not self.room:
                raise OSError(28, "No space left on device")

    with emulated_watch(lego(), 1, 1) as running:
        record = Full(tmp_path, {}, 7.0)
        watch = Watch(running.world, running.controller, record, alert=lambda *words: told.append(words))
        for step in islice(watch.turns(), 5):
            record.room = step.number >= 3
        record.close()
    assert told == [("the record", "lost", "no space left on device"), ("the record", "returned", "")]
    assert (watch.unrecorded, watch.unrecorded_because) == (3, "no space left on device")
    assert watch.summary()["steps"] == 5


@pytest.mark.end_to_end
@pytest.mark.parametrize("latency_s", [0.0, 0.05, 0.2])
def test_a_camera_whose_position_has_frozen_is_to_be_restarted_however_slow_it_is(
    latency_s: float, tmp_path: Path
) -> None:
    with emulated_watch(lego(), 2, 0) as running:
        faults = running.emulation.cameras["north-east"].faults
        faults.latency_s = latency_s
        record = RecordWriter(tmp_path, {"step_s": 1.5, "virtual": True}, 7.0)
        for step in islice(Watch(running.world, running.controller, record).turns(), 16):
            faults.frozen = step.number >= 5
        record.close()
    morning = Morning()
    for line in read_record(tmp_path):
        morning.take(line)
    morning.end()
    (spell,) = morning.outages
    assert (spell.camera, spell.over) == ("north-east", False)
    assert re.match(
        r"it (stands|stood) at pan \S+, tilt -40, zoom 1 (instead of|and did not set off to)", spell.because
    )
    assert "restart it" in spell.mend
    assert "a longer step_s" not in spell.mend


@pytest.mark.end_to_end
def test_a_record_is_closed_once_with_how_the_run_ended(tmp_path: Path) -> None:
    with emulated_watch(lego(), 1, 1) as running:
        watch = Watch(running.world, running.controller, RecordWriter(tmp_path, {}, 7.0))
        for _ in islice(watch.turns(), 2):
            pass
        watch.end("until", "--until 06:00")
        watch.end("stopped", "too late to be told")
    header, *_, last = read_record(tmp_path)
    assert header["closes"] is True
    assert {key: last[key] for key in ("kind", "how", "because", "steps", "unrecorded")} == {
        "kind": "end",
        "how": "until",
        "because": "--until 06:00",
        "steps": 2,
        "unrecorded": 0,
    }


@pytest.mark.example
def test_state_of_a_site(tmp_path: Path) -> None:
    mine, theirs = WatchState(lego(), tmp_path), WatchState(lego(), tmp_path)
    assert mine.held() == frozenset()
    theirs.hold("south")
    theirs.hold("north-east")
    assert mine.held() == {"south", "north-east"}
    theirs.hold("south", hold=False)
    assert mine.held() == {"north-east"}
    with pytest.raises(ValueError, match=r"no camera 'west' \(there are: south, north-west, north-east\)"):
        mine.hold("west")
    (kept,) = tmp_path.glob("*.held")
    kept.unlink()
    kept.symlink_to(kept)  # there, and cannot be asked for
    assert mine.held() == {"north-east"}  # what is not known has not changed
    kept.unlink()
    assert mine.held() == frozenset()
    with (
        mine.locked(),
        pytest.raises(AlreadyRun, match=r"run already, by process \d+; stop that one first"),
        theirs.locked(),
    ):
        pass
    with theirs.locked():
        pass


@pytest.mark.example
def test_a_camera_is_commanded_by_one_site_file_only(tmp_path: Path) -> None:
    """Address and channel tell cameras apart: not how the address is written, nor what the site calls them."""
    site = lego()
    first, second = (
        replace(site, cameras=(site.cameras[0].model_copy(update={"name": name, "url": url, "channel": channel}),))
        for name, url, channel in (("south", "http://192.168.0.90", 1), ("yard", "https://192.168.0.90:443/", 1))
    )
    other = replace(first, cameras=(first.cameras[0].model_copy(update={"channel": 2}),))
    mine, theirs, beside = (
        WatchState(one, tmp_path / name) for one, name in ((first, "a"), (second, "b"), (other, "c"))
    )
    with mine.locked():
        with beside.locked():
            pass
        with (
            pytest.raises(
                AlreadyRun,
                match=r"camera 'yard' \(https://192.168.0.90:443/, channel 1\) is commanded already, by site \S+ as "
                r"camera 'south', process \d+; stop that one first",
            ),
            theirs.locked(),
        ):
            pass
    with theirs.locked():  # and the refused attempt left nothing locked
        pass


@pytest.mark.example
def test_whether_a_hold_is_heeded(tmp_path: Path) -> None:
    mine, theirs = WatchState(lego(), tmp_path), WatchState(lego("north-east"), tmp_path)
    assert not mine.heeded("south")
    with theirs.heeding(), mine.heeding():
        assert mine.heeded("south")
    with theirs.heeding():
        assert mine.heeded("south")
        assert not mine.heeded("north-east")  # there is a run, but not of that camera
    assert not mine.heeded("south")


def _at(url: str, name: str, folder: Path, monkeypatch: pytest.MonkeyPatch, **names: list[str]) -> WatchState:
    """The state of a site with one camera, where a name server knows some names."""

    def found(host: str, *rest: object, **more: object) -> list[tuple[object, ...]]:
        if host not in names:
            raise socket.gaierror(-2, "Name or service not known")
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (number, 0)) for number in names[host]]

    monkeypatch.setattr(socket, "getaddrinfo", found)
    site = lego()
    return WatchState(
        replace(site, cameras=(site.cameras[0].model_copy(update={"name": name, "url": url}),)), folder / name
    )


@pytest.mark.example
def test_a_camera_is_held_by_its_address_for_all_site_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not by a site file's own name for it, nor by how its host is written; ports tell cameras apart."""
    by_name = _at("http://yard.lan", "yard", tmp_path, monkeypatch, **{"yard.lan": ["10.0.0.9"]})
    by_number = _at("http://10.0.0.9/", "south", tmp_path, monkeypatch)
    other = _at("http://10.0.0.9:8080", "east", tmp_path, monkeypatch)
    by_name.hold("yard")
    assert (by_name.held(), by_number.held(), other.held()) == ({"yard"}, {"south"}, frozenset())
    with by_number.heeding():
        assert by_name.heeded("yard")
        assert not other.heeded("east")
    with by_number.locked(), pytest.raises(AlreadyRun, match="as camera 'south'"), by_name.locked():
        pass
    by_number.hold("south", hold=False)
    assert by_name.held() == frozenset()


@pytest.mark.example
def test_a_hold_stands_while_the_name_server_is_away_and_after_the_address_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _at("http://yard.lan", "yard", tmp_path, monkeypatch, **{"yard.lan": ["10.0.0.9"]}).hold("yard")
    unresolved = _at("http://yard.lan", "yard", tmp_path, monkeypatch)
    assert unresolved.held() == {"yard"}
    moved = _at("http://yard.lan", "yard", tmp_path, monkeypatch, **{"yard.lan": ["10.0.0.7"]})
    assert moved.held() == {"yard"}
    moved.hold("yard", hold=False)
    assert not list((tmp_path / "cameras").glob("*.held"))  # that of the old number, too
