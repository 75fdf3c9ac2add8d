"""The bounds bound: clairvoyant on every run under perfect eyes, full information in expectation."""

from __future__ import annotations

import pytest

from surveillance_domain.experiments.estimates import paired
from surveillance_domain.experiments.jobs import blocks, run_jobs
from surveillance_domain.experiments.runs import TruthKind, simulate_run
from surveillance_domain.experiments.setup import Case, Setup, surveillance_of
from surveillance_domain.experiments.variants import VARIANTS


@pytest.mark.end_to_end
@pytest.mark.parametrize(("site", "targets", "truth"), [("tiny", 3, "grid"), ("tiny-3", 2, "continuous")])
def test_clairvoyant_is_above_every_controller_run_by_run(site: str, targets: int, truth: TruthKind) -> None:
    surveillance = surveillance_of(Setup(site, targets))
    reached = {name: simulate_run(surveillance, name, 12, 1, 0, truth).percent_obs for name in VARIANTS}
    assert max(reached.values()) == pytest.approx(reached["clairvoyant"]), reached
    assert reached["sys"] < reached["clairvoyant"]


@pytest.mark.end_to_end
@pytest.mark.slow
def test_full_information_is_above_pomdp_in_expectation() -> None:
    cases = {name: Case(Setup("hall", 5), name, "grid", 20, 2) for name in ("pomdp", "full-information")}
    done = run_jobs([job for case in cases.values() for job in blocks(case, range(6))]).runs
    gain = paired(done[cases["full-information"]], done[cases["pomdp"]])
    assert gain.low > 0
    assert gain.verdict == 1
