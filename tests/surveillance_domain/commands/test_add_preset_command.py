"""``surveillance add-preset``: what is written can be loaded, and is where the camera stands."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.cameras.clock import RealClock
from surveillance_domain.commands.emulated_site_file import write_site_file
from surveillance_domain.emulation.motors import EmulatedMotors
from surveillance_domain.emulation.site import PASSWORD, USERNAME, EmulatedSite
from surveillance_domain.model.views import build_views
from surveillance_domain.site.load import load_site

Command = Callable[..., Any]


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Path, EmulatedMotors]]:
    """A site file that leads to emulated cameras, and the motors of the southern one."""
    monkeypatch.setenv("CAM_PASSWORD", PASSWORD)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    with EmulatedSite(load_site("lego"), 1, RealClock(), np.random.default_rng(0)) as emulation:
        path = tmp_path / "desk.toml"
        write_site_file(load_site("lego"), {name: one.url for name, one in emulation.servers.items()}, USERNAME, path)
        yield path, emulation.cameras["south"].motors


@pytest.mark.end_to_end
def test_a_preset_that_sees_nothing_is_not_written(surveillance: Command, desk: tuple[Path, EmulatedMotors]) -> None:
    path, motors = desk
    before = path.read_bytes()
    motors.command({"tilt": "29"})
    answer = surveillance("add-preset", path, "south", "sky")
    assert answer.code == 2
    assert f"{path}, as it would be changed" in answer.err
    assert 'preset "sky" of camera "south" that sees no free cell' in answer.err
    assert path.read_bytes() == before


@pytest.mark.end_to_end
def test_a_preset_that_looks_into_a_private_area_is_not_written(
    surveillance: Command, desk: tuple[Path, EmulatedMotors]
) -> None:
    path, motors = desk
    corner = "\n[[privacy]]\npolygon_m = [[-3.0, 2.0], [-2.6, 2.0], [-2.6, 2.4]]\n"
    path.write_text(path.read_text(encoding="utf-8") + corner, encoding="utf-8")
    build_views(load_site(path))  # none of its presets does
    before = path.read_bytes()
    motors.command({"pan": "-65", "tilt": "-20"})
    answer = surveillance("add-preset", path, "south", "corner")
    assert answer.code == 2
    assert 'preset "corner" of camera "south" that looks into privacy[0]' in answer.err
    assert path.read_bytes() == before


@pytest.mark.end_to_end
def test_a_camera_in_mid_move_is_waited_for(surveillance: Command, desk: tuple[Path, EmulatedMotors]) -> None:
    path, motors = desk
    motors.command({"pan": "30"})  # from -40: 0.7 s
    answer = surveillance("add-preset", path, "south", "aside", "--json")
    assert answer.code == 0, answer.err
    assert answer.json["preset"] == {"name": "aside", "pan": 30.0, "tilt": -40.0, "zoom": 1.0}
    build_views(load_site(path))


@pytest.mark.end_to_end
def test_a_camera_that_does_not_come_to_rest_is_refused(
    surveillance: Command, desk: tuple[Path, EmulatedMotors]
) -> None:
    path, motors = desk
    text = path.read_text(encoding="utf-8").replace("settle_s = 0.3", "settle_s = 0.3\nmove_deadline_s = 0.5")
    path.write_text(text, encoding="utf-8")
    motors.command({"pan": "170"})  # 2.1 s
    answer = surveillance("add-preset", path, "south", "aside")
    assert answer.code == 2
    assert "camera 'south' still moves, at pan " in answer.err
    assert path.read_text(encoding="utf-8") == text


@pytest.mark.end_to_end
@pytest.mark.parametrize("name", ["", " door", "x" * 65])
def test_a_name_is_judged_before_the_camera_is_asked(
    surveillance: Command, desk: tuple[Path, EmulatedMotors], name: str
) -> None:
    path, _ = desk  # the camera stands at a preset: that would be refused, too
    answer = surveillance("add-preset", path, "south", name)
    assert answer.code == 2
    assert f"NAME: found {name!r}; expected a name of 1 to 64 printable characters" in " ".join(answer.err.split())
