"""Whether anybody watched: runs and how they ended, gaps, steps that are not recorded."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest

from surveillance_domain.control.continuity import Continuity

START = datetime(2026, 1, 31, 22, tzinfo=UTC)


def at(seconds: float) -> str:
    return (START + timedelta(seconds=seconds)).isoformat(timespec="milliseconds")


def header(seconds: float, **more: object) -> dict[str, Any]:
    return {"kind": "header", "run": at(seconds), "part": 0, "step_s": 1.5, "closes": True, **more}


def steps(numbers: Sequence[int], began: float) -> list[dict[str, Any]]:
    """As they are when all goes well: the first step is over 1.5 seconds after the run began."""
    return [
        {"kind": "step", "step": number, "time_s": 1.5 * number, "written": at(began + 1.5 * number)}
        for number in numbers
    ]


def end(seconds: float, count: int, how: str = "steps") -> dict[str, Any]:
    return {"kind": "end", "written": at(seconds), "how": how, "because": f"because of {how}", "steps": count}


def followed(*lines: dict[str, Any], running: bool = False, whole: bool = True) -> Continuity:
    watch = Continuity()
    for line in lines:
        watch.take(line)
    watch.end(running, whole)
    return watch


def gaps(watch: Continuity) -> list[tuple[str, str, float, bool]]:
    return [(one.began.isoformat(), one.ended.isoformat(), one.seconds, one.over) for one in watch.unwatched]


@pytest.mark.example
def test_a_run_that_closes_has_no_gap_in_however_many_files() -> None:
    first, second = steps(range(1, 5), 0.0), steps(range(5, 9), 0.0)
    watch = followed(header(0.0), *first, header(0.0, part=1), *second, end(12.1, 8))
    (run,) = watch.runs
    assert (run.steps, run.how, run.because) == (8, "steps", "because of steps")
    assert run.ended == START + timedelta(seconds=12.1)
    assert (watch.unwatched, watch.unrecorded, watch.watched_s, watch.unwatched_s) == ([], [], 12.0, 0.0)


@pytest.mark.example
def test_a_killed_run_and_five_hours_until_the_next() -> None:
    watch = followed(header(0.0), *steps(range(1, 5), 0.0), header(18000.0), *steps([1, 2], 18000.0), end(18003.0, 2))
    killed, next_one = watch.runs
    assert (killed.how, killed.ended, killed.last) == ("killed", None, START + timedelta(seconds=6))
    assert killed.because == "ended without closing: killed, crashed or power lost"
    assert next_one.how == "steps"
    assert gaps(watch) == [("2026-01-31T22:00:06+00:00", "2026-02-01T03:00:00+00:00", 17994.0, True)]
    assert watch.unwatched[0].because == f"run 1: {killed.because}"
    assert (watch.watched_s, watch.unwatched_s) == (9.0, 17994.0)
    assert watch.hours == pytest.approx(18003.0 / 3600)


@pytest.mark.example
@pytest.mark.parametrize(("away_s", "is_a_gap"), [(7.4, False), (7.6, True)])
def test_a_gap_is_more_than_five_steps(away_s: float, is_a_gap: bool) -> None:
    later = 6.0 + away_s
    watch = followed(
        header(0.0), *steps(range(1, 5), 0.0), end(6.0, 4, "stopped"), header(later), *steps([1], later), end(later, 1)
    )
    assert [gap.seconds for gap in watch.unwatched] == ([pytest.approx(away_s)] if is_a_gap else [])
    assert all("it was stopped as asked" in gap.mend for gap in watch.unwatched)


@pytest.mark.example
def test_a_run_that_died_without_a_successor() -> None:
    lines = header(0.0), *steps([1, 2], 0.0)
    died = followed(*lines)
    assert gaps(died) == [("2026-01-31T22:00:03+00:00", "2026-01-31T22:00:03+00:00", 0.0, False)]
    for watch, how in ((followed(*lines, running=True), "running"), (followed(*lines, whole=False), "unknown")):
        assert (watch.unwatched, watch.runs[0].how) == ([], how)
    before_any_step = followed(header(0.0))
    assert gaps(before_any_step) == [("2026-01-31T22:00:00+00:00", "2026-01-31T22:00:00+00:00", 0.0, False)]


@pytest.mark.example
def test_older_records_do_not_say_how_they_ended() -> None:
    old = {key: value for key, value in header(0.0).items() if key not in ("closes", "part")}
    watch = followed(old, *steps([1, 2], 0.0))
    assert (watch.runs[0].how, watch.unwatched) == ("unknown", [])
    again = followed(old, *steps([1, 2], 0.0), header(60.0), *steps([1], 60.0), end(62.0, 1))
    assert [gap.seconds for gap in again.unwatched] == [57.0]
    assert "of an older version" in again.unwatched[0].because


@pytest.mark.example
def test_a_computer_that_slept_is_told_from_a_run_that_stood_still() -> None:
    before, after = steps([1, 2], 0.0), steps([3, 4], 3600.0)
    slept = followed(header(0.0), *before, *after, end(3607.0, 4))
    assert [gap.seconds for gap in slept.unwatched] == [3600.0]
    assert slept.unwatched[0].because == "the computer slept, or its clock was set"
    assert slept.watched_s == 6.0
    hung = followed(header(0.0), *before, *({**one, "time_s": one["time_s"] + 3600.0} for one in after), end(3607.0, 4))
    assert [gap.seconds for gap in hung.unwatched] == [3600.0]
    assert "the run stood still" in hung.unwatched[0].because


@pytest.mark.example
def test_virtual_time_goes_by_its_own_clock() -> None:
    """A hundred hours pass in a second, and a slow computer is no gap."""
    fast = [{**one, "written": at(number * 20.0)} for number, one in enumerate(steps(range(1, 9), 0.0))]
    watch = followed(header(0.0, virtual=True), *fast, end(140.0, 8))
    assert (watch.unwatched, watch.watched_s) == ([], 12.0)


@pytest.mark.example
def test_steps_that_are_not_in_the_record_were_watched_all_the_same() -> None:
    inside = followed(header(0.0), *steps([1, 2, 9, 10], 0.0), end(15.0, 10))
    (gap,) = inside.unrecorded
    assert (gap.first, gap.steps, gap.seconds, gap.because) == (3, 6, 10.5, "6 steps were not recorded")
    assert (inside.unwatched, inside.watched_s) == ([], 15.0)
    at_the_end = followed(header(0.0), *steps(range(1, 5), 0.0), end(15.0, 10))
    assert [(gap.first, gap.steps, gap.seconds) for gap in at_the_end.unrecorded] == [(5, 6, 9.0)]
    assert (at_the_end.unwatched, at_the_end.watched_s) == ([], 15.0)
    at_the_start = followed(header(0.0), *steps([7], 0.0), end(10.5, 7))
    assert [(gap.first, gap.steps) for gap in at_the_start.unrecorded] == [(1, 6)]
    removed = followed(header(0.0, part=3), *steps([7], 0.0), end(10.5, 7))  # its first files were too old
    assert removed.unrecorded == []


@pytest.mark.example
def test_unrecorded_steps_and_a_gap_at_once() -> None:
    """Eight steps further on, 12 seconds, an hour has passed."""
    watch = followed(header(0.0), *steps([1, 2], 0.0), *steps([10], 3600.0), end(3616.0, 10))
    assert [gap.steps for gap in watch.unrecorded] == [7]
    assert [gap.seconds for gap in watch.unwatched] == [3600.0]
    assert watch.watched_s == 15.0


@pytest.mark.example
def test_a_clock_that_was_set_back_is_no_time_below_zero() -> None:
    watch = followed(header(0.0), *steps([1, 2], 0.0), *steps([3, 4], -3600.0), end(-3590.0, 4))
    assert (watch.unwatched, watch.watched_s) == ([], 6.0)
