"""Two valves: tied by one gauge, in two parts with two."""

from __future__ import annotations

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp.verification import verify


@pytest.mark.example
def test_one_gauge_ties_them_and_the_counterexample_is_explaining_away() -> None:
    certificate = fp.decompose(fp.domain("valves"))
    assert not certificate.decomposes
    assert [(tie.kind, tie.factor) for tie in certificate.ties] == [("observation", "observation of gauge")]
    shown = certificate.ties[0].counterexample
    # Each leaks with 0.55 after a step, so the gauge falls with 1 - 0.45² = 0.7975.
    assert shown["observation"] == {"gauge": "falls"}
    assert shown["at"] == {"inlet": "leaks", "outlet": "leaks"}
    assert shown["joint"] == pytest.approx(0.55**2 / 0.7975)
    assert shown["product"] == pytest.approx((0.55 / 0.7975) ** 2)


@pytest.mark.example
def test_a_gauge_each_and_it_decomposes() -> None:
    certificate = fp.decompose(fp.domain("valves", tie=False))
    assert certificate.decomposes
    assert certificate.blocks == (("inlet",), ("outlet",))
    assert certificate.ties == ()


@pytest.mark.example
def test_a_tight_inlet_makes_a_leaking_outlet_certain() -> None:
    model = fp.domain("valves")
    fallen = fp.JointBelief.initial(model).predict("inlet").condition("falls")
    assert fallen.marginal("inlet").array == pytest.approx([1.0, 0.0])
    assert fallen.marginal("outlet").array == pytest.approx([0.0, 1.0])


@pytest.mark.property
@pytest.mark.parametrize("tie", [True, False])
def test_joint_and_decomposed_agree_tied_or_not(tie: bool) -> None:
    model = fp.domain("valves", tie=tie, accuracy=0.8)
    assert verify(model, 5, 5, np.random.default_rng(3)).holds


@pytest.mark.example
def test_an_accuracy_below_a_half_is_refused() -> None:
    with pytest.raises(ValueError, match=r"accuracy=0.3: expected a number from 0.5 to 1"):
        fp.domain("valves", accuracy=0.3)
