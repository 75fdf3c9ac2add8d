"""People come first, at the command line: holds, locks, parking, and who was moved before a run was there."""

from __future__ import annotations

import json
import os
import re
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("cv2")

from surveillance_domain.control.record import read_record
from surveillance_domain.emulation.site import PASSWORD
from tests.real_cameras import FAST, Real, started, until_recorded

pytestmark = pytest.mark.usefixtures("state")


@pytest.mark.end_to_end
def test_one_runs_others_are_refused_and_sigterm_parks_who_is_free(
    surveillance: Callable[..., Any], real: Real, tmp_path: Path
) -> None:
    record = tmp_path / "record"
    with started("run", real.path, "--record", record, "--json") as process:
        until_recorded(record, process, 1)
        for words in (("run", real.path, "--steps", 1), ("doctor", real.path)):
            refused = surveillance(*words)
            assert refused.code == 2
            assert f"is being run already, by process {process.pid}; stop that one first" in refused.err
        copy = tmp_path / "copy.toml"
        copy.write_text(real.path.read_text(encoding="utf-8"), encoding="utf-8")
        for words in (("run", copy, "--steps", 1), ("park", copy), ("doctor", copy)):
            refused = surveillance(*words)
            assert refused.code == 2
            assert "camera 'south-west'" in refused.err
            assert (
                f"is commanded already, by site {real.path} as camera 'south-west', process {process.pid}"
                in refused.err
            )
        heeded = surveillance("hold", copy, "north-east", "--json")  # of the same camera, whatever site file says so
        assert (heeded.json["held"], heeded.json["heeded"], heeded.err) == (["north-east"], True, "")
        done = sum(line["kind"] == "step" for line in read_record(record))
        until_recorded(record, process, done + 3)
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    found = json.loads(out)
    assert found["parked"]["south-west"] == 'at "middle"'
    assert found["parked"]["north-east"] == "left alone: held"
    assert found["percent_obs"] is None
    assert real.pans()["south-west"] == pytest.approx(0.0)
    steps = [line for line in read_record(record) if line["kind"] == "step"]
    assert [line["step"] for line in steps] == list(range(1, found["steps"] + 1))
    assert steps[-1]["held"] == ["north-east"]
    assert steps[-1]["cameras"]["north-east"]["sent"] is None
    text = "".join(path.read_text() for path in record.iterdir())
    assert PASSWORD not in text.replace('"emulated": false', "")


@pytest.mark.end_to_end
def test_after_a_kill_the_cameras_can_be_parked(surveillance: Callable[..., Any], real: Real, tmp_path: Path) -> None:
    record = tmp_path / "record"
    with started("run", real.path, "--record", record) as process:
        until_recorded(record, process, 1)
    real.turn(25.0)
    surveillance("hold", real.path, "south-west")
    parked = surveillance("park", real.path, "--json")
    assert parked.code == 0
    assert [(one["ok"], one["outcome"]) for one in parked.json["cameras"]] == [
        (True, "left alone: held"),
        (True, "left alone: moved by somebody else just now"),  # for no run has sent it to where it stands
    ]
    (moved,) = Path(os.environ["XDG_STATE_HOME"]).rglob("*.moved")
    then = json.loads(moved.read_text(encoding="utf-8"))
    moved.write_text(json.dumps({**then, "still_since": then["still_since"] - 60.0}), encoding="utf-8")
    assert surveillance("park", real.path, "--json").json["cameras"][1]["outcome"] == 'at "middle"'
    assert real.pans() == {"south-west": pytest.approx(25.0), "north-east": pytest.approx(0.0)}
    assert surveillance("hold", real.path, "south-west", "--release", "--json").json["held"] == []
    real.emulation.cameras["south-west"].faults.wrong_password = True
    parked = surveillance("park", real.path, "--json")
    assert parked.code == 1
    assert "password" in parked.json["cameras"][0]["outcome"]


@pytest.mark.end_to_end
def test_a_hold_that_no_run_heeds_is_kept_for_all_site_files(
    surveillance: Callable[..., Any], real: Real, tmp_path: Path
) -> None:
    copy = tmp_path / "copy.toml"
    copy.write_text(real.path.read_text(encoding="utf-8").replace("127.0.0.1", "localhost"), encoding="utf-8")
    real.turn(25.0)
    unheeded = surveillance("hold", real.path, "south-west", "--json")
    assert (unheeded.code, unheeded.json["heeded"]) == (0, False)
    assert "No run is there to heed it" in unheeded.err
    assert unheeded.json["state_folder"] in unheeded.err
    parked = surveillance("park", copy, "--json").json["cameras"]
    assert [one["outcome"] for one in parked] == ["left alone: held", 'at "middle"']
    assert real.pans() == {"south-west": pytest.approx(25.0), "north-east": pytest.approx(0.0)}


@pytest.mark.end_to_end
def test_who_was_moved_before_a_kill_is_left_alone_by_every_later_command(
    surveillance: Callable[..., Any], real: Real, tmp_path: Path
) -> None:
    """Until it has been still for ``yield_s``, of which some passed while no run was there."""
    kept, record = Path(os.environ["XDG_STATE_HOME"]), tmp_path / "record"
    with started("run", real.path, "--record", record) as process:
        until_recorded(record, process, 1)
        assert not list(kept.rglob("*.moved"))
        real.emulation.cameras["south-west"].motors.command({"pan": "25"})
        for _ in range(600):
            if list(kept.rglob("*.moved")):
                break
            time.sleep(0.1)
    time.sleep(1.0)
    (moved,) = kept.rglob("*.moved")
    before = json.loads(moved.read_text(encoding="utf-8"))
    copy = tmp_path / "copy.toml"
    copy.write_text(real.path.read_text(encoding="utf-8"), encoding="utf-8")
    for path in (real.path, copy):
        parked = surveillance("park", path, "--json")
        assert parked.code == 0
        assert re.fullmatch(r"left alone: moved by somebody else \d+ s ago", parked.json["cameras"][0]["outcome"])
        assert parked.json["cameras"][1]["outcome"] == 'at "middle"'
    checks = {one["name"]: one for one in surveillance("doctor", copy, "--json").json["cameras"][0]["checks"]}
    assert checks["move"]["ok"]
    assert re.fullmatch(r"not turned: moved by somebody else \d+ s ago", checks["move"]["detail"])
    ran = surveillance("run", copy, "--steps", 2, "--park", "--json").json
    assert ran["cameras"][0]["state"] == "moved by somebody else"
    assert ran["parked"]["south-west"] == "left alone: moved by somebody else"
    assert real.pans()["south-west"] == pytest.approx(25.0)
    now = json.loads(moved.read_text(encoding="utf-8"))
    assert now == before  # it has not been moved since
    moved.write_text(json.dumps({**now, "still_since": now["still_since"] - 60.0}), encoding="utf-8")
    assert surveillance("park", real.path, "--json").json["cameras"][0]["outcome"] == 'at "middle"'
    assert real.pans()["south-west"] == pytest.approx(0.0)
    assert not moved.exists()


@pytest.mark.end_to_end
def test_emulated_runs_leave_nothing_behind_of_their_cameras(surveillance: Callable[..., Any], real: Real) -> None:
    surveillance("run", real.path, *FAST, "--steps", 2)
    surveillance("run", "tiny", *FAST, "--steps", 2)
    kept = Path(os.environ["XDG_STATE_HOME"])
    assert {path.suffix for path in kept.rglob("*") if path.is_file()} == {".heeded"}
    assert len(list((kept / "factored-pomdp" / "cameras").iterdir())) == 2  # of the two that the site file names
