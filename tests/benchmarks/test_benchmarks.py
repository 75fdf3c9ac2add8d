"""Every benchmark runs on tiny sizes, and its rivals compute what ours computes (they refuse to be timed otherwise)."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from benchmarks.elimination import elimination
from benchmarks.exact import exact
from benchmarks.exponential import exponential
from benchmarks.flat import Flat
from benchmarks.growth import growth
from benchmarks.hall import Hall
from benchmarks.large_map import large_map
from benchmarks.planners import MODELS, planners
from benchmarks.report import Aim
from benchmarks.rivals import rivals
from benchmarks.run import BENCHMARKS, main
from benchmarks.theorem1 import TheoremOne
from benchmarks.timing import Timing, in_turns


@pytest.mark.example
def test_ratios_are_taken_turn_by_turn() -> None:
    quick, slow = Timing((1.0, 4.0, 2.0)), Timing((3.0, 8.0, 2.0))
    assert slow.over(quick) == 2.0  # of 3, 2 and 1; the quotient of the medians would be 1.5
    assert (quick.median, quick.best) == (2.0, 1.0)


@pytest.mark.example
def test_rivals_take_turns() -> None:
    called: list[str] = []
    timed = in_turns({"a": lambda: called.append("a"), "b": lambda: called.append("b")}, 3, 60.0)
    assert [len(timing.seconds) for timing in timed.values()] == [3, 3]
    assert sum(one != other for one, other in pairwise(called)) == 7  # warming up: a, b; then a, b, a, b, a, b


@pytest.mark.example
def test_a_budget_that_is_spent_ends_the_turns() -> None:
    assert len(in_turns({"a": lambda: None}, 1000, 0.0)["a"].seconds) == 1


@pytest.mark.example
def test_aims_have_a_side() -> None:
    assert Aim("at most", 0.2, 0.2).met
    assert not Aim("at most", 0.3, 0.2).met
    assert Aim("at least", 1000.0, 1000.0, at_least=True).met
    assert not Aim("at least", 999.0, 1000.0, at_least=True).met


@pytest.mark.example
def test_theorem_1_gives_the_values_of_the_decomposition() -> None:
    hall = Hall.of(2, np.random.default_rng(0), "tiny")
    theorem = TheoremOne.of(hall)
    ours = [hall.solver.value(hall.belief, theorem.action_of(hall, n)) for n in range(len(theorem.actions))]
    assert len(ours) == 9
    np.testing.assert_allclose(theorem.values(), ours, atol=1e-12)
    np.testing.assert_allclose(theorem.values_as_products(), ours, atol=1e-12)
    assert theorem.action_of(hall, int(np.argmax(ours))) == hall.action


@pytest.mark.example
def test_plain_scipy_gives_the_posteriors_of_the_belief() -> None:
    hall = Hall.of(3, np.random.default_rng(1), "tiny")
    flat = Flat.of(hall)
    np.testing.assert_allclose(np.array(flat.updated_in_turn()).T, hall.updated().arrays[0], atol=1e-12)
    np.testing.assert_allclose(flat.updated_at_once(), hall.updated().arrays[0], atol=1e-12)


@pytest.mark.example
def test_a_rival_that_computes_something_else_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = Flat.of
    monkeypatch.setattr(Flat, "of", lambda hall: replace(honest(hall), matrix=honest(hall).matrix * 1.1))
    with pytest.raises(RuntimeError, match="differs"):
        rivals(quick=True, seed=0, counts=(1,), site="tiny")


@pytest.mark.end_to_end
def test_growth_fits_an_exponent_where_there_are_many_targets(monkeypatch: pytest.MonkeyPatch) -> None:
    few = growth(quick=True, seed=0, counts=(1, 2), site="tiny")
    assert [row[0] for row in few.rows] == ["1", "2"]
    assert few.figures["exponents"] == {"dense": None, "simulated": None}
    monkeypatch.setattr("benchmarks.growth.FITTED_FROM", 1)
    many = growth(quick=True, seed=0, counts=(1, 2), site="tiny")
    assert all(np.isfinite(slope) for slope in many.figures["exponents"].values())


@pytest.mark.end_to_end
def test_rivals_on_a_tiny_site() -> None:
    report = rivals(quick=True, seed=0, counts=(1, 20), site="tiny")
    assert {name for name in report.figures[1]} >= {"copy", "update", "decision", "csr", "theorem-1"}
    assert report.figures[1]["decision"]["over_decision"] == 1.0
    assert len(report.aims) == 3


@pytest.mark.end_to_end
def test_run_prints_one_json_object(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("benchmarks.exponential.CASES", (("tiny", 1),))
    assert main(["--quick", "--json", "--only", "exponential"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert {"command", "version", "seed", "machine", "aims", "exponential"} <= answer.keys()
    assert answer["exponential"]["tiny 1"]["ratio"] > 0


@pytest.mark.end_to_end
def test_run_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    from benchmarks.run import show

    show(exponential(quick=True, seed=0, cases=(("tiny", 1),)))
    assert "1,440" in capsys.readouterr().out


@pytest.mark.example
def test_an_unknown_benchmark_is_wrong_input(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["--only", "everything"])
    assert stopped.value.code == 2
    told = capsys.readouterr().err
    assert all(name in told for name in BENCHMARKS)


@pytest.mark.slow
@pytest.mark.end_to_end
@pytest.mark.skipif(not MODELS.is_dir(), reason="the published models are not here")
def test_a_planner_answers_from_a_process_of_its_own() -> None:
    report = planners(True, 0, (("cassandra/tiger.95.POMDP", 5.0, ""),), ("ours",))
    (found,) = report.figures.values()
    assert found["lower"] <= 19.371368 <= found["upper"]
    assert found["upper"] - found["lower"] <= 1e-3
    assert found["peak_bytes"] > 1e7


@pytest.mark.end_to_end
@pytest.mark.skipif(not MODELS.is_dir(), reason="the published models are not here")
def test_the_memory_is_the_planners_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("benchmarks.exact.CASES", (("cassandra/tiger.95.POMDP", 2, "", ""),))
    large = np.ones(60_000_000)  # what a forked child would be charged with
    (found,) = exact(quick=True, seed=0).figures.values()
    assert 1e7 < found["peak_bytes"] < large.nbytes
    assert found["vectors"] == 3 + 5  # with one and two steps to go (Kaelbling, Littman, Cassandra, AIJ 1998)


@pytest.mark.end_to_end
@pytest.mark.skipif(not MODELS.is_dir(), reason="the published models are not here")
def test_a_planner_that_is_not_there_is_named() -> None:
    report = planners(True, 0, (("cassandra/tiger.95.POMDP", 5.0, ""),), ("nobody",))
    assert "nobody" in report.rows[0][3]


@pytest.mark.slow
@pytest.mark.end_to_end
@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::FutureWarning")
def test_variable_elimination_agrees() -> None:
    assert elimination(quick=True, seed=0, site="tiny").figures["ratio"] > 0


@pytest.mark.slow
@pytest.mark.end_to_end
def test_large_map_in_a_process_of_its_own() -> None:
    figures = large_map(quick=False, seed=0, side=50, targets=2).figures
    assert figures["cells"] > 2000
    assert figures["peak_bytes"] > 0
