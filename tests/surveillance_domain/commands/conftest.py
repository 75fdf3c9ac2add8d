"""Running the command in this process."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest

from surveillance_domain.commands import main

if TYPE_CHECKING:
    from tests.real_cameras import Real


class Answer(NamedTuple):
    """What came of a command."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        return json.loads(self.out, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))


@pytest.fixture
def surveillance(capsys: pytest.CaptureFixture[str]) -> Callable[..., Answer]:
    """The command, as a function of its words."""

    def run(*words: object) -> Answer:
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main([str(word) for word in words])
        return Answer(int(ended.value.code or 0), *capsys.readouterr())

    return run


@pytest.fixture
def state(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """A state folder of its own, and the cameras' password."""
    from surveillance_domain.emulation.site import PASSWORD

    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
    monkeypatch.setenv("CAM_PASSWORD", PASSWORD)


@pytest.fixture
def real(tmp_path: Path, state: None) -> Iterator[Real]:
    """Cameras in real time, and their site file."""
    from tests.real_cameras import real_cameras

    with real_cameras(tmp_path) as cameras:
        yield cameras
