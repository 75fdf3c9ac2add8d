"""Every counterexample of random models is worked out again by loops over the joint model."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from tests.counterexamples import confirm
from tests.strategies import TIES, random_models
from tests.tied_models import tied_models


@pytest.mark.property
@pytest.mark.parametrize("kind", TIES)
@settings(max_examples=12)
@given(data=st.data())
def test_a_tie_of_each_kind_is_found_with_a_true_counterexample(kind: str, data: st.DataObject) -> None:
    model = data.draw(tied_models(kind))
    certificate = fp.decompose(model)
    assert certificate.known == ("switch",)
    assert set(map(frozenset, certificate.blocks)) == {frozenset("xy"), frozenset("z")}
    (tie,) = certificate.ties
    assert (tie.kind, set(tie.joins)) == (kind, {("x",), ("y",)})
    assert tie.counterexample is not None
    confirm(model, tie)


@pytest.mark.property
@settings(max_examples=20)
@given(model=random_models(most_states=3))
def test_counterexamples_of_random_models_are_true(model: fp.FactoredPOMDP) -> None:
    for tie in fp.decompose(model).ties:
        if tie.counterexample is None:
            assert tie.because == "structural; no numeric counterexample was found"
        else:
            confirm(model, tie)


@pytest.mark.example
def test_without_counterexamples_none_is_worked_out() -> None:
    from factored_pomdp.domains.machine_repair import machine_repair

    quick = fp.decompose(machine_repair(coupled=True), counterexamples=False)
    assert [tie.counterexample for tie in quick.ties] == [None, None]
    assert [tie.because for tie in quick.ties] == ["", ""]
    for tie in fp.decompose(machine_repair(coupled=True)).ties:
        confirm(machine_repair(coupled=True), tie)
