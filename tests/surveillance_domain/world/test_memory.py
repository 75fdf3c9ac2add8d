"""Who was moved by somebody is left alone by whoever commands the camera next."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import pytest

from surveillance_domain.cameras.base import Position
from surveillance_domain.world.memory import Memory, Stood, still_for_s
from surveillance_domain.world.yielding import Yielding

HERE, ELSEWHERE = Position(-40.0, -30.0, 1.0), Position(40.0, -30.0, 1.0)
NEAR = Position(-39.9, -30.0, 1.0)
YIELD_S, TOLERANCE_DEG = 60.0, 0.2


@dataclass
class Noted(Memory):
    """Remembers as long as it lives, and every change."""

    stood: Stood | None = None
    changes: list[Stood | None] = field(default_factory=list)

    def recall(self) -> Stood | None:
        return self.stood

    def keep(self, stood: Stood | None) -> None:
        self.stood = stood
        self.changes.append(stood)


@pytest.mark.example
@pytest.mark.parametrize(
    ("still_s", "now_at", "expected", "changes"),
    [
        (12.0, NEAR, 12.0, []),
        (12.0, None, 12.0, []),
        (12.0, ELSEWHERE, 0.0, [Stood(ELSEWHERE, 0.0)]),  # and moved again
        (60.0, NEAR, None, [None]),
        (60.0, None, 60.0, []),  # where it is now is not known
        (599.0, ELSEWHERE, 0.0, [Stood(ELSEWHERE, 0.0)]),
        (600.0, ELSEWHERE, None, [None]),  # so long ago that it says nothing of people
    ],
)
def test_still_for(
    still_s: float, now_at: Position | None, expected: float | None, changes: list[Stood | None]
) -> None:
    memory = Noted(Stood(HERE, still_s))
    assert still_for_s(memory, YIELD_S, TOLERANCE_DEG, now_at) == expected
    assert memory.changes == changes


@pytest.mark.example
def test_nobody_moved_it() -> None:
    assert still_for_s(Memory(), YIELD_S, TOLERANCE_DEG, HERE) is None


@pytest.mark.example
def test_one_that_is_never_given_back_is_never_forgotten() -> None:
    assert still_for_s(Noted(Stood(HERE, 1e9)), math.inf, TOLERANCE_DEG, HERE) == 1e9


@pytest.mark.example
def test_what_changes_is_kept_and_nothing_else() -> None:
    memory = Noted()
    one = Yielding(TOLERANCE_DEG, YIELD_S, memory=memory)
    one.read(HERE, 0.0, 0.0)
    one.sent(HERE, 0.0)
    one.accepted(HERE)
    one.read(HERE, 1.0, 1.0)
    assert memory.changes == []
    for second in range(10, 80, 10):  # still from 20 to 70
        one.read(HERE if second == 10 else ELSEWHERE, float(second), float(second))
    assert memory.changes == [Stood(ELSEWHERE, 0.0)]
    assert one.yields
    one.read(NEAR, 75.0, 75.0)
    assert memory.changes == [Stood(ELSEWHERE, 0.0), Stood(NEAR, 0.0)]
    one.read(NEAR, 134.9, 134.9)
    assert one.yields
    one.read(NEAR, 135.0, 135.0)
    assert not one.yields
    assert memory.changes[2:] == [None]


@pytest.mark.example
@pytest.mark.parametrize(
    ("now_at", "free_s"),
    [(NEAR, 148.0), (ELSEWHERE, 160.0)],  # 60 - 12 s, or 60 s, after the first look at 100 s
)
def test_the_next_one_goes_on_where_the_last_one_ended(now_at: Position, free_s: float) -> None:
    memory = Noted(Stood(HERE, 12.0))
    one = Yielding(TOLERANCE_DEG, YIELD_S, memory=memory)
    assert one.yields  # before it was ever asked where it is
    one.read(now_at, 100.0, 100.0)
    one.read(now_at, free_s - 0.1, free_s - 0.1)
    assert one.yields
    one.read(now_at, free_s, free_s)
    assert not one.yields
    assert memory.stood is None


@pytest.mark.example
def test_one_that_has_been_still_since_is_commanded_at_once() -> None:
    memory = Noted(Stood(HERE, 61.0))
    one = Yielding(TOLERANCE_DEG, YIELD_S, memory=memory)
    one.read(HERE, 100.0, 100.0)
    assert not one.yields
    assert memory.stood is None
    one.sent(ELSEWHERE, 100.0)
    one.accepted(ELSEWHERE)
    one.read(ELSEWHERE, 101.0, 101.0)
    assert not one.yields
    one.read(HERE, 110.0, 110.0)  # nobody asked for that
    assert one.yields
