"""What terminal states do to a certificate: an end when any thing happens ties nothing, one when all have does."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings

import factored_pomdp as fp
from factored_pomdp.decomposition import Certificate
from tests.counterexamples import confirm
from tests.ending_models import ending_models

BIT = [0, 1]


def three(terminal: Any, keep: float = 0.9, groups: tuple[tuple[str, ...], ...] = ()) -> fp.FactoredPOMDP:
    """Three bits, the first seen dimly; and a lamp that an action turns."""
    names = ["a", "b", "c"]
    keeps = (lambda x: {x: keep, 1 - x: 1 - keep}) if keep < 1 else (lambda x: {x: 1.0})
    return fp.FactoredPOMDP(
        states=[*(fp.Variable(name, BIT) for name in names), fp.Variable("lamp", ["on", "off"])],
        actions=[fp.Variable("turn", ["on", "off"])],
        observations=[fp.Variable("seen", BIT)],
        transition={**{n: fp.table(n, values=keeps) for n in names}, "lamp": lambda turn: turn},
        observation={"seen": fp.table("a.next", values=lambda a: {a: 0.8, 1 - a: 0.2})},
        reward={name: fp.table(name, values=float) for name in names},
        initial={**{name: {0: 0.7, 1: 0.3} for name in names}, "lamp": "on"},
        discount=0.9,
        groups=groups,
        terminal=terminal,
    )


def ties(terminal: Any, **options: Any) -> Certificate:
    model = three(terminal, **options)
    certificate = fp.decompose(model)
    for tie in certificate.ties:
        confirm(model, tie)
    return certificate


APART = (("a",), ("b",), ("c",))


@pytest.mark.example
@pytest.mark.parametrize(
    "terminal",
    [
        lambda a: a,
        lambda a, b, c: a or b or c,
        lambda lamp: lamp == "off",
        lambda lamp, a, b: lamp == "off" and (a or b),
        lambda a, b: a,
        lambda a, b: 0,
    ],
    ids=["one", "any", "known", "any while the lamp is off", "one of two that it reads", "never"],
)
def test_ends_that_tie_nothing(terminal: Any) -> None:
    certificate = ties(terminal)
    assert (certificate.blocks, certificate.ties, certificate.decomposes) == (APART, (), True)


@pytest.mark.example
def test_an_end_when_all_have_happened_is_a_tie() -> None:
    certificate = ties(lambda a, b: a and b)
    (tie,) = certificate.ties
    assert (tie.factor, tie.kind, tie.joins) == ("terminal", "terminal", (("a",), ("b",)))
    assert certificate.blocks == (("a", "b"), ("c",))
    assert tie.counterexample is not None
    assert tie.counterexample["kind"] == "posterior"
    assert tie.counterexample["observation"]["(episode goes on)"] is True
    assert "terminal tie joins [a] with [b]" in str(certificate)


@pytest.mark.example
def test_bits_that_never_flip_are_tied_by_what_they_start_as() -> None:
    (tie,) = ties(lambda a, b: a and b, keep=1.0).ties
    # 0.49, 0.21, 0.21 of 0.91 remain: (0, 1) has 0.21 / 0.91, its marginals 0.7 / 0.91 and 0.21 / 0.91
    assert tie.counterexample == {
        "kind": "belief",
        "at": {"a": 0, "b": 1},
        "joint": pytest.approx(0.21 / 0.91),
        "product": pytest.approx(0.7 * 0.21 / 0.91**2),
    }


@pytest.mark.example
def test_a_tie_that_holds_only_while_the_lamp_is_off() -> None:
    (tie,) = ties(lambda lamp, a, b: lamp == "off" and a == b).ties
    assert tie.kind == "terminal"
    assert tie.counterexample is not None
    assert tie.counterexample["action"] == {"turn": "off"}


@pytest.mark.example
def test_within_a_group_nothing_is_reported() -> None:
    certificate = ties(lambda a, b: a and b, groups=(("a", "b"),))
    assert (certificate.blocks, certificate.ties) == ((("a", "b"), ("c",)), ())


@pytest.mark.property
@settings(max_examples=12)
@given(ending_models())
def test_counterexamples_of_random_models_are_right(model: fp.FactoredPOMDP) -> None:
    for tie in fp.decompose(model).ties:
        if tie.counterexample is None:
            assert "no numeric counterexample" in tie.because
        else:
            confirm(model, tie)
