"""Time that jumps: sleeps overlap, nobody is woken early, and a clock that stands says so."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.cameras.clock import Clock, RealClock
from surveillance_domain.emulation.virtual_clock import StoppedClock, VirtualClock

naps = st.lists(st.lists(st.integers(1, 12), max_size=6), min_size=1, max_size=5)


@pytest.fixture(scope="module")
def pool() -> Iterator[ThreadPoolExecutor]:
    with ThreadPoolExecutor(8) as workers:
        yield workers


@pytest.mark.example
def test_alone_time_passes_as_one_sleeps() -> None:
    clock = VirtualClock(start_s=5.0)
    clock.sleep(0.0)
    clock.sleep(-1.0)
    clock.sleep(float("nan"))
    assert clock.now() == 5.0
    clock.sleep(1e6)
    clock.sleep(0.5)
    assert clock.now() == 1_000_005.5
    assert isinstance(clock, Clock)
    assert isinstance(RealClock(), Clock)


def sleeper(clock: Clock, lengths: list[int], woken: list[tuple[float, int]], name: int) -> Callable[[], float]:
    def task() -> float:
        for length in lengths:
            clock.sleep(float(length))
            woken.append((clock.now(), name))
        return clock.now()

    return task


@pytest.mark.property
@settings(max_examples=60)
@given(naps)
def test_sleeps_overlap_and_everyone_wakes_when_due(pool: ThreadPoolExecutor, lengths: list[list[int]]) -> None:
    clock = VirtualClock(patience_s=10.0)
    woken: list[tuple[float, int]] = []
    futures = clock.together(pool, [sleeper(clock, own, woken, name) for name, own in enumerate(lengths)])
    assert [future.result() for future in futures] == [sum(own) for own in lengths]
    assert clock.now() == max(sum(own) for own in lengths)
    assert [when for when, _ in woken] == sorted(when for when, _ in woken)
    expected = [(float(sum(own[: k + 1])), name) for name, own in enumerate(lengths) for k in range(len(own))]
    assert sorted(woken) == sorted(expected)
    clock.sleep(1.0)  # the caller has its place back
    assert clock.now() == max(sum(own) for own in lengths) + 1.0


@pytest.mark.example
def test_nobody_is_woken_while_somebody_works(pool: ThreadPoolExecutor) -> None:
    clock = VirtualClock()
    asleep, seen = threading.Event(), []

    def naps() -> None:
        asleep.set()
        clock.sleep(1.0)

    def works() -> None:
        asleep.wait(5)
        for _ in range(200):
            seen.append(clock.now())

    clock.together(pool, [naps, works])
    assert set(seen) == {0.0}
    assert clock.now() == 1.0


@pytest.mark.example
def test_a_helper_sleeps_in_the_place_of_the_one_that_waits_for_it(pool: ThreadPoolExecutor) -> None:
    """As the handler of a request does, while the client waits for its answer."""
    clock = VirtualClock()

    def asks(length: float) -> Callable[[], float]:
        def task() -> float:
            helper = threading.Thread(target=clock.sleep, args=(length,))
            helper.start()
            helper.join()
            return clock.now()

        return task

    futures = clock.together(pool, [asks(2.0), asks(3.0), asks(2.0)])
    assert [future.result() for future in futures] == [2.0, 3.0, 2.0]
    assert clock.now() == 3.0


@pytest.mark.example
def test_tasks_may_have_tasks_of_their_own_and_may_fail(pool: ThreadPoolExecutor) -> None:
    clock = VirtualClock()

    def fails() -> None:
        clock.sleep(1.0)
        raise ValueError("broken")

    def inner() -> float:
        clock.together(pool, [lambda: clock.sleep(2.0), lambda: clock.sleep(4.0)])
        return clock.now()

    first, second = clock.together(pool, [fails, inner])
    with pytest.raises(ValueError, match="broken"):
        first.result()
    assert second.result() == 4.0
    assert clock.together(pool, []) == []
    clock.sleep(1.0)
    assert clock.now() == 5.0


@pytest.mark.property
@settings(max_examples=60)
@given(naps, st.integers(0, 20))
def test_a_deadline_ends_the_waiting_and_not_the_tasks(
    pool: ThreadPoolExecutor, lengths: list[list[int]], after: int
) -> None:
    clock = VirtualClock(patience_s=10.0)
    deadline = after + 0.5  # naps last whole seconds
    woken: list[tuple[float, int]] = []
    tasks = [sleeper(clock, own, woken, name) for name, own in enumerate(lengths)]
    futures = clock.together(pool, tasks, until=deadline)
    ends = [sum(own) for own in lengths]
    assert [future.done() for future in futures] == [end < deadline for end in ends]
    assert clock.now() == min(max(ends), deadline)
    clock.sleep(100.0)
    assert [future.result() for future in futures] == ends


@pytest.mark.example
def test_a_deadline_that_is_over_still_lets_done_what_takes_no_time(pool: ThreadPoolExecutor) -> None:
    clock = VirtualClock(start_s=5.0)
    quick, slow = clock.together(pool, [clock.now, lambda: clock.sleep(1.0)], until=0.0)
    assert quick.result() == 5.0
    assert not slow.done()
    assert clock.now() == 5.0
    clock.sleep(2.0)
    assert slow.result() is None


@pytest.mark.example
def test_a_clock_that_stands_says_so(pool: ThreadPoolExecutor) -> None:
    clock = VirtualClock(patience_s=0.05)
    gone = threading.Event()
    sleeps, blocks = clock.together(pool, [lambda: clock.sleep(1.0), lambda: gone.wait(0.5)])
    assert blocks.result() is False
    with pytest.raises(StoppedClock, match=r"stands at 0 s: .* neither sleeps nor ends"):
        sleeps.result()


@pytest.mark.end_to_end
def test_real_clock_does_tasks_together(pool: ThreadPoolExecutor) -> None:
    clock = RealClock()
    before = clock.now()
    meeting = threading.Barrier(3, timeout=5)
    futures = clock.together(pool, [lambda: meeting.wait() >= 0] * 3)
    assert all(future.result() for future in futures)
    clock.sleep(0.01)
    assert clock.now() >= before + 0.01
    gone = threading.Event()
    quick, slow = clock.together(pool, [lambda: True, lambda: gone.wait(5)], until=clock.now() + 0.05)
    assert quick.result() is True
    assert not slow.done()
    gone.set()
    assert slow.result() is True
    rung = threading.Event()
    with clock.alarm(0.01, rung.set):
        assert rung.wait(5)
    quiet = threading.Event()
    with clock.alarm(60.0, quiet.set):
        pass
    assert not quiet.is_set()
