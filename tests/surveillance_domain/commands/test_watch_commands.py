"""A guard's night at the command line: run, hold, park, doctor, report, replay-run."""

from __future__ import annotations

import json
import re
import signal
import time
from collections.abc import Callable
from datetime import datetime, timedelta
from importlib import resources
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("cv2")

from surveillance_domain.control.record import read_record
from tests.real_cameras import FAST, Real, started, until_recorded

pytestmark = pytest.mark.usefixtures("state")


@pytest.mark.end_to_end
def test_run_in_virtual_time_and_its_report(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    record, out = tmp_path / "record", tmp_path / "morning"
    words = (
        "run",
        "lego",
        *FAST,
        "--targets",
        2,
        "--strangers",
        1,
        "--steps",
        12,
        "--record",
        record,
        "--park",
        "--json",
    )
    found = surveillance(*words).json
    assert found["steps"] == 12
    assert 0 <= found["percent_obs"]["mean"] <= 100
    assert {camera["name"]: camera["state"] for camera in found["cameras"]} == dict.fromkeys(found["parked"], "ready")
    assert set(found["parked"].values()) == {'at "middle"'}
    told = surveillance("report", record, "--step", 12, "--out", out, "--json").json
    assert (told["steps"], told["outages"], told["held"]) == (12, [], [])
    assert told["percent_obs"] == pytest.approx(found["percent_obs"]["mean"])
    assert told["seen"] == pytest.approx(found["seen"])
    assert told["seen_beyond"] == pytest.approx(found["seen_beyond"])
    assert 0.3 < told["coverage"] < 1
    why = told["why"]
    assert why["recomputed_value"] == pytest.approx(why["value"], abs=1e-9)
    assert why["exact"] is True
    assert len(why["alternatives"]) == 5
    values = [one["value"] for one in why["alternatives"]]
    assert values == sorted(values, reverse=True)
    assert max(values) <= why["value"] + 1e-9
    assert {path.name for path in out.iterdir()} == {"report.html", "report.txt", "night.png", "night.svg"}
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "The best alternatives" in page
    assert all(link.startswith("#") for link in re.findall(r'(?:src|href)="([^"]*)"', page))  # in one file
    assert page.count("<svg ") == 1
    assert "Outages: none" in (out / "report.txt").read_text(encoding="utf-8")
    shown = surveillance("report", record).out
    assert "PercentObs" in shown
    wrong = surveillance("report", record, "--step", 13)
    assert (wrong.code, "no such step (12 are there)" in wrong.err) == (2, True)


@pytest.mark.end_to_end
def test_a_recorded_run_is_shown_again(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    from PIL import Image

    record, out = tmp_path / "record", tmp_path / "run.gif"
    surveillance("run", "lego", *FAST, "--targets", 2, "--steps", 6, "--record", record)
    shown = surveillance("replay-run", record, "--first", 3, "--last", 5, "--out", out)
    lines = [line for line in shown.out.splitlines() if " s  " in line]
    assert [int(line.split()[0]) for line in lines] == [3, 4, 5]
    assert "south" in lines[0]
    with Image.open(out) as picture:
        assert picture.n_frames == 3
    assert surveillance("replay-run", record, "--json").json["steps"] == 6
    for words, message in (
        (("--first", 7), "no step 7 or later"),
        (("--out", "run.mp4"), "expected the name of a .gif file"),
        (("--first", 5, "--last", 4), "expected a first step up to the last"),
    ):
        wrong = surveillance("replay-run", record, *words)
        assert (wrong.code, message in wrong.err) == (2, True)


@pytest.mark.end_to_end
def test_what_pictures_show_beyond_the_views_counts_and_is_told(
    surveillance: Callable[..., Any], tmp_path: Path
) -> None:
    """A record of before such sightings were used has no ``beyond``; it can be read all the same."""
    record = tmp_path / "record"
    words = ("run", "lego", "--emulated", "--fast", "--targets", 5, "--steps", 8, "--record", record, "--json")
    found = surveillance(*words).json
    steps = [line for line in read_record(record) if line["kind"] == "step"]
    beyond = [line for line in steps if line["beyond"]]
    assert found["seen_beyond"] == pytest.approx(sum(len(line["beyond"]) for line in steps) / 8)
    assert found["seen"] >= found["seen_beyond"] > 0
    for line in beyond:
        for target, camera in line["beyond"].items():
            assert line["observations"][target] is not None
            assert line["views"][camera] is not None
    told = f" (beyond the view of {next(iter(beyond[0]['beyond'].values()))})"
    assert told in surveillance("replay-run", record).out
    number = beyond[0]["step"]
    report = surveillance("report", record, "--step", number, "--json").json
    assert (report["why"]["beyond"], report["seen_beyond"]) == (beyond[0]["beyond"], found["seen_beyond"])
    assert told in surveillance("report", record, "--step", number, "--out", tmp_path / "morning").out
    for path in record.glob("*.jsonl"):
        lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
        older = [{key: value for key, value in line.items() if key != "beyond"} for line in lines]
        path.write_text("".join(json.dumps(line) + "\n" for line in older), encoding="utf-8")
    assert surveillance("report", record, "--json").json["seen_beyond"] == 0
    assert surveillance("replay-run", record, "--json").json["steps"] == 8


@pytest.mark.end_to_end
def test_ctrl_c_ends_a_shadow_after_the_step(real: Real, tmp_path: Path) -> None:
    record, before = tmp_path / "record", real.pans()
    commands: list[Any] = []
    for camera in real.emulation.cameras.values():
        camera.motors.command = commands.append  # type: ignore[method-assign]
    with started("run", real.path, "--shadow", "--record", record, "--json") as process:
        until_recorded(record, process, 2)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    steps = [line["step"] for line in read_record(record) if line["kind"] == "step"]
    assert steps == list(range(1, json.loads(out)["steps"] + 1))
    assert commands == []
    assert real.pans() == before


@pytest.mark.end_to_end
def test_ctrl_c_while_it_starts_is_answered_all_the_same(real: Real) -> None:
    """As ``timeout -s INT`` does it, which signals the process twice."""
    real.turn(25.0)
    for camera in real.emulation.cameras.values():
        camera.faults.latency_s = 1.0  # so that getting to know them takes some seconds
    with started("run", real.path, "--park", "--json") as process:
        for _ in range(600):
            if any(camera.questions for camera in real.emulation.cameras.values()):
                break
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGINT)
        for camera in real.emulation.cameras.values():
            camera.faults.latency_s = 0.0
        out, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    found = json.loads(out)
    assert (found["steps"], found["blind"]) == (0, False)
    assert set(found["parked"].values()) == {'at "middle"'}
    assert real.pans() == dict.fromkeys(real.pans(), pytest.approx(0.0))


@pytest.mark.end_to_end
def test_a_run_without_any_view_says_no(surveillance: Callable[..., Any], real: Real) -> None:
    for camera in real.emulation.cameras.values():
        camera.faults.wrong_password = True
    found = surveillance("run", real.path, "--steps", 2, "--json")
    assert (found.code, found.json["blind"], found.json["steps"]) == (1, True, 2)
    assert "no camera gave a view: south-west: " in found.err
    assert "refuses user 'operator'" in found.err


@pytest.mark.end_to_end
def test_doctor_at_the_command_line(surveillance: Callable[..., Any], real: Real) -> None:
    found = surveillance("doctor", real.path, "--no-move", "--json")
    assert found.code == 0
    assert [camera["name"] for camera in found.json["cameras"]] == ["south-west", "north-east"]
    assert all(set(check) == {"name", "ok", "detail"} for camera in found.json["cameras"] for check in camera["checks"])
    assert "move" not in {check["name"] for check in found.json["cameras"][0]["checks"]}
    real.emulation.cameras["north-east"].faults.wrong_password = True
    ill = surveillance("doctor", real.path, "--no-move")
    assert ill.code == 1
    assert "WRONG" in ill.out
    assert "refuses user 'operator'" in ill.out


@pytest.mark.end_to_end
def test_until_a_time_of_day(surveillance: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    from surveillance_domain.commands import run as module

    class Clock(datetime):
        calls = 0

        @classmethod
        def now(cls, tz: Any = None) -> datetime:
            cls.calls += 1
            return datetime(2026, 1, 1, 5, 59) + timedelta(seconds=20 * max(0, cls.calls - 1))

    monkeypatch.setattr(module, "datetime", Clock)
    found = surveillance("run", "tiny", *FAST, "--until", "06:00", "--json").json
    assert found["steps"] == 3  # 20, 40, 60 seconds later


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("run", "lego", "--fast"), "--fast: for emulated cameras only; add --emulated"),
        (("run", "lego", "--strangers", 1), "--strangers: for emulated cameras only"),
        (("run", "lego", *FAST, "--shadow", "--park"), "--shadow never moves a camera"),
        (("run", "lego", *FAST, "--until", "6"), "expected a time of day such as 06:00"),
        (("run", "lego", "--steps", 1), "south: no url; give the camera's address"),
        (("hold", "lego", "sout"), "no camera 'sout' (did you mean 'south'?)"),
        (("park", "lego"), "north-east: no url"),
        (("report", "nowhere"), "nowhere: no record here"),
        (("replay-run", "nowhere"), "nowhere: no record here"),
    ],
)
def test_wrong_input_is_one_message(surveillance: Callable[..., Any], words: tuple[object, ...], message: str) -> None:
    found = surveillance(*words)
    assert found.code == 2
    assert message in found.err
    assert "Traceback" not in found.err


@pytest.mark.end_to_end
def test_an_alert_command_that_is_none_is_refused(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    text = (resources.files("surveillance_domain.site") / "builtin" / "tiny.toml").read_text(encoding="utf-8")
    path = tmp_path / "site.toml"
    path.write_text(text + '\n[operation]\nalert_command = "say \'lost"\n', encoding="utf-8")
    found = surveillance("run", path, *FAST, "--steps", 1)
    assert found.code == 2
    assert "operation.alert_command: found say 'lost, which is no command" in found.err


@pytest.mark.end_to_end
def test_sightings_that_contradict_the_model_are_told_with_what_to_look_at(
    surveillance: Callable[..., Any], tmp_path: Path
) -> None:
    """Targets stand or run, says the model, and those of the emulation go at all speeds between; eyes are perfect."""
    text = (resources.files("surveillance_domain.site") / "builtin" / "lego.toml").read_text(encoding="utf-8")
    path = tmp_path / "site.toml"
    path.write_text(text, encoding="utf-8")
    words = ("--targets", 2, "--steps", 30, "--seed", 1)
    assert "contradict" not in surveillance("run", path, *FAST, *words).out
    changed = re.sub(r"sigma_speed_mps = .*\n", "", text)
    changed = re.sub(r"speeds_mps = .*", "speeds_mps = [0.0, 0.4]\nsigma_speed_mps = 0.3", changed)
    changed = re.sub(r"(detection_probability|cell_noise_m) = .*\n", "", changed)
    path.write_text(changed, encoding="utf-8")
    answer = surveillance("run", path, *FAST, *words)
    assert answer.code == 0, answer.err
    assert "Sightings contradict the model often: are detection_probability and cell_noise_m those" in answer.out
