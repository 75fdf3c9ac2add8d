"""What a night came to, from the lines of its record."""

from __future__ import annotations

from typing import Any

import pytest

from surveillance_domain.control.morning import Morning


def header() -> dict[str, Any]:
    return {"kind": "header", "run": "2026-01-31T22:00:00+00:00", "step_s": 1.5, "site": "lego", "emulated": False}


def step(number: int, view: str | None, held: bool = False, **camera: object) -> dict[str, Any]:
    told = {"because": "", "fault": "", "outcome": "", "position": None, "state": "ready", **camera}
    return {
        "kind": "step",
        "step": number,
        "time_s": 1.5 * number,
        "written": f"2026-01-31T22:00:{number:02d}+00:00",
        "views": {"north": view},
        "held": ["north"] if held else [],
        "cameras": {"north": told},
        "without_identity": 0,
        "out_of_view": 0,
        "observations": {},
        "unknown": {},
        "value": 0.0,
    }


@pytest.mark.example
def test_sightings_beyond_the_views_are_counted_and_older_records_have_none() -> None:
    seen = {"observations": {"red": [1, 1], "blue": None}, "unknown": {"marker 9": [2, 2]}}
    old = step(1, "left") | seen | {"out_of_view": 2}
    new = step(2, "left") | seen | {"out_of_view": 1, "beyond": {"red": "north", "marker 9": "north"}}
    morning = summed(old, new)
    assert (morning.beyond, morning.unused, list(morning.series.seen)) == (2, 3, [2, 2])


def summed(*steps: dict[str, Any]) -> Morning:
    morning = Morning()
    for line in (header(), *steps):
        morning.take(line)
    morning.end()
    return morning


@pytest.mark.example
@pytest.mark.parametrize("why", ["held", "moved by somebody else"])
def test_why_people_had_a_camera_is_told_even_if_the_first_step_does_not_tell_it(why: str) -> None:
    """In the first step a look failed, or nothing was told; from the second on it says why it gets no commands."""
    for first in ("the answer did not end in time", ""):
        later = [step(n, "left", held=True, because=why) for n in (2, 3)]
        morning = summed(step(1, None, held=True, because=first, fault="TooLate" if first else ""), *later)
        (spell,) = morning.holds
        assert (spell.because, spell.steps, spell.seconds, spell.over) == (why, 3, 4.5, False)
        assert morning.outages == []
    (spell,) = summed(step(1, "left", held=True), step(2, "left")).holds
    assert (spell.because, spell.over) == ("held", True)


@pytest.mark.example
def test_outages_are_in_the_order_in_which_they_began() -> None:
    """North is missing from the first step to the last, south from the third to the fifth."""
    lines = []
    for number in range(1, 8):
        line = step(number, None)
        south = "left" if not 3 <= number <= 5 else None
        lines.append(
            line
            | {
                "views": {"north": None, "south": south},
                "cameras": {name: line["cameras"]["north"] for name in ("north", "south")},
            }
        )
    assert [(one.camera, one.first) for one in summed(*lines).outages] == [("north", 1), ("south", 3)]


@pytest.mark.example
@pytest.mark.parametrize(
    ("outcome", "fault", "mend"),
    [
        ("stalled", "StandsStill", "it takes commands and does not turn"),
        ("stalled", "", "it takes commands and does not turn"),  # an older record
        ("timed out", "NotThereInTime", "its moves take longer than the site says"),
        ("timed out", "", "its moves take longer than the site says"),
        ("timed out", "TooSlow", "it answers, but too late"),
    ],
)
def test_a_move_that_does_not_arrive_has_the_mend_of_its_own_cause(outcome: str, fault: str, mend: str) -> None:
    away = [step(n, None, because="it stands at pan 0", outcome=outcome, fault=fault) for n in (1, 2, 3)]
    (spell,) = summed(*away).outages
    assert spell.because == "it stands at pan 0"
    assert spell.mend.startswith(mend)


@pytest.mark.example
def test_an_outage_has_its_cause_and_mend() -> None:
    late = [step(n, None, because="the answer did not end in time", fault="TooLate") for n in (2, 3, 4)]
    morning = summed(step(1, "left"), *late, step(5, "left"), step(6, None), step(7, "left"))
    (spell,) = morning.outages
    assert (spell.camera, spell.first, spell.steps, spell.seconds, spell.over) == ("north", 2, 3, 4.5, True)
    assert spell.because == "the answer did not end in time"
    assert "a longer step_s" in spell.mend
    assert morning.short == {"north": 1}


@pytest.mark.example
def test_a_camera_that_looks_at_no_preset_of_its_own_has_not_lost_its_view() -> None:
    turned = [step(n, None) | {"elsewhere": {"north": [55.0, -40.0, 1.0]}} for n in range(1, 6)]
    assert summed(*turned).outages == []
    assert len(summed(*(step(n, None) for n in range(1, 6))).outages) == 1
