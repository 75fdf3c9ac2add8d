"""The page's section on being myopic: what a policy falls short of, by hand, and the words that the numbers make."""

from __future__ import annotations

import csv
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import factored_pomdp as fp
from solvers import Limits, PointBased

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def measure(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import results_myopia

    return results_myopia


def lamp(values: list[float]) -> fp.FactoredPOMDP:
    switch, room = fp.Variable("switch", ["on", "off"]), fp.Variable("room", ["dark"])
    return fp.FactoredPOMDP(
        states=[room],
        actions=[switch],
        observations=[],
        transition={"room": lambda room: room},
        observation={},
        reward=fp.table("switch", values=values),
        initial={"room": "dark"},
        discount=0.5,
    )


@pytest.mark.example
def test_a_policy_that_never_switches_on_falls_short_by_what_on_pays(measure: ModuleType) -> None:
    """On pays 1 a step, worth 2 for ever; off pays 0: each step loses 2 - 0.5 · 2 = 1, discounted 2 (1 - 0.5^150)."""
    model = lamp([1.0, 0.0])
    policy = PointBased(model).solve(Limits(precision=1e-9)).policy
    actor: Any = SimpleNamespace(decide=lambda belief: SimpleNamespace(action={"switch": "off"}))
    assert measure._shortfall(model, policy, actor, np.random.default_rng(0)) == pytest.approx(2.0, abs=1e-6)
    assert measure._shortfall(model, policy, policy, np.random.default_rng(0)) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.example
def test_the_section_says_what_the_runs_say(measure: ModuleType, tmp_path: Path) -> None:
    assert measure.section(tmp_path) == ""
    price = [
        measure.PriceRun(room, policy, run, short + 0.1 * run, 11.0, 11.5, 0.95, 150, 0)
        for room, policy, short in (("room", "pomdp", 0.0), ("room-slow", "pomdp", 2.0))
        for run in range(2)
    ]
    percent = {"pomdp": 50.0, "lookahead": 53.0, "full-information": 55.0}
    halls = [
        measure.HallRun(site, 5, name, run, value + run, 100, 0)
        for site in ("hall", "hall-slow")
        for name, value in percent.items()
        for run in range(2)
    ]
    for name, kind, rows in (("price.csv", measure.PriceRun, price), ("lookahead.csv", measure.HallRun, halls)):
        with (tmp_path / name).open("w", newline="") as file:
            csv.writer(file).writerows([kind._fields, *rows])
    text = " ".join(measure.section(tmp_path).split())
    # Shortfalls 2.0 and 2.1: mean 2.05 ± 12.706 · 0.05 = 0.635; later steps: 0.95^150 · 20 = 0.0091.
    assert "| slow | 11.000 | 11.500 | P (one step) | 2.050 ± 0.635 | 1.406 to 3.194 | 7.03 to 15.97 |" in text
    assert "With quick cameras P (one step) costs at most" in text
    assert "| quick | 5 | 50.5 ± 6.4 | 53.5 ± 6.4 | +3.0 ± 0.0 | +5.0 ± 0.0 |" in text
    assert "the lookahead gains (+3.0)" in text
