"""``alert_command``: run when a camera is lost or returns, without a shell, and never waited for."""

from __future__ import annotations

import sys
import threading
from pathlib import Path

import pytest

from surveillance_domain.commands.alerting import alerter


def finished() -> None:
    for thread in threading.enumerate():
        if thread is not threading.main_thread() and thread.name.startswith("alert"):
            thread.join(30)


@pytest.mark.end_to_end
def test_the_command_is_told_in_one_word_that_no_shell_reads(tmp_path: Path) -> None:
    script, out = tmp_path / "tell.py", tmp_path / "told.txt"
    script.write_text(f"import sys; open({str(out)!r}, 'a').write(repr(sys.argv[1:]) + chr(10))")
    tell = alerter(f"{sys.executable} {script} --loud", "hall")
    tell("north", "lost", "no answer; $(touch x) `y`")
    finished()
    tell("north", "returned", "")
    finished()
    assert out.read_text().splitlines() == [
        repr(["--loud", "hall: north is lost: no answer; $(touch x) `y`"]),
        repr(["--loud", "hall: north has returned"]),
    ]


@pytest.mark.end_to_end
def test_a_command_that_fails_is_a_warning(capsys: pytest.CaptureFixture[str]) -> None:
    alerter(f"{sys.executable} -c 'exit(3)'", "hall")("north", "lost", "")
    finished()
    told = capsys.readouterr().err
    assert "hall: north is lost" in told
    assert "warning: alert_command failed" in told


@pytest.mark.end_to_end
def test_the_command_gets_no_password(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script, out = tmp_path / "tell.py", tmp_path / "told.txt"
    script.write_text(f"import os; open({str(out)!r}, 'w').write(repr(sorted(os.environ)))")
    monkeypatch.setenv("CAM_PASSWORD", "secret")
    monkeypatch.setenv("MAIL_TO", "guard")
    alerter(f"{sys.executable} {script}", "hall", ["CAM_PASSWORD"])("north", "lost", "")
    finished()
    assert "'MAIL_TO'" in out.read_text()
    assert "CAM_PASSWORD" not in out.read_text()


@pytest.mark.example
def test_a_program_that_is_not_there_is_refused() -> None:
    with pytest.raises(ValueError, match="no program 'no-such-program' is there"):
        alerter("no-such-program --loud", "hall")


@pytest.mark.example
def test_quotes_that_do_not_end_are_refused() -> None:
    with pytest.raises(ValueError, match="no closing quotation"):
        alerter("say 'lost", "hall")
