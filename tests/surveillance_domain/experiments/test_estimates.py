"""Means, intervals, paired differences."""

from __future__ import annotations

import math

import pytest

from surveillance_domain.experiments.comparison import Plan, differences, panels, rows
from surveillance_domain.experiments.estimates import decision_times, estimate, paired, percent_obs_of
from surveillance_domain.experiments.runs import Run
from surveillance_domain.experiments.setup import Setup


def runs(*percents: float, restarts: int = 0) -> dict[int, Run]:
    return {number: Run(percent, (1.0,), restarts) for number, percent in enumerate(percents)}


@pytest.mark.example
def test_the_interval_is_students() -> None:
    found = estimate([10.0, 20.0, 30.0])
    assert found.mean == 20.0
    # t(0.975, 2 degrees of freedom) = 4.302653, standard error 10 / sqrt 3
    assert found.half_width == pytest.approx(4.302653 * 10 / math.sqrt(3), rel=1e-6)
    assert (found.low, found.high) == pytest.approx((20 - found.half_width, 20 + found.half_width))


@pytest.mark.example
def test_one_run_has_a_mean_and_no_interval_and_none_has_neither() -> None:
    one, none = estimate([42.0]), estimate([math.nan])
    assert (one.mean, one.low, one.high, one.verdict) == (42.0, -math.inf, math.inf, 0)
    assert math.isnan(none.mean)
    assert none.samples == ()


@pytest.mark.example
def test_differences_are_paired_over_the_runs_that_both_have() -> None:
    ours, theirs = runs(50.0, 60.0, 70.0, 99.0), runs(40.0, 51.0, 59.0)
    found = paired(ours, theirs)
    assert found.samples == (10.0, 9.0, 11.0)
    assert found.verdict == 1
    assert paired(theirs, ours).verdict == -1
    assert percent_obs_of(theirs).mean == 50.0


@pytest.mark.example
def test_decision_times() -> None:
    median, late = decision_times([Run(1.0, tuple(map(float, range(1, 101))), 0), Run(1.0, (1000.0,), 0)])
    assert (median, late) == (51.0, 100.0)
    assert all(math.isnan(time) for time in decision_times([]))


@pytest.mark.example
def test_rows_leave_out_what_was_not_run() -> None:
    setups = (Setup("hall", 1), Setup("hall", 5), Setup("tiny", 1))
    plan = Plan(setups, ("pomdp", "sys"), "grid", 10, 0)
    done = {
        plan.case(setups[0], "pomdp"): runs(70.0, 80.0, restarts=2),
        plan.case(setups[0], "sys"): runs(30.0),
        plan.case(setups[1], "pomdp"): runs(60.0),
        plan.case(setups[1], "sys"): {},
    }
    made = rows(plan, done)
    assert [(row.setup.targets, row.controller, row.estimate.mean, row.restarts) for row in made] == [
        (1, "pomdp", 75.0, 4),
        (1, "sys", 30.0, 0),
        (5, "pomdp", 60.0, 0),
    ]
    assert [(row.setup, row.controller, row.estimate.samples) for row in differences(plan, done)] == [
        (setups[0], "sys", (40.0,))
    ]
    assert {site: list(found) for site, found in panels(made).items()} == {"hall": ["pomdp", "sys"]}


@pytest.mark.example
def test_an_interval_ends_where_no_mean_can_be() -> None:
    assert estimate([20.0, 60.0]).ends(0.0, 100.0) == [0.0, 100.0]
    assert estimate([50.0, 50.0]).ends(0.0, 100.0) == [50.0, 50.0]
    assert estimate([50.0]).ends(0.0, 100.0) == [None, None]
