"""What a decision says about itself."""

from __future__ import annotations

import pytest

from solvers.base import Ability, Decision


@pytest.mark.example
def test_the_gap_is_what_another_action_could_gain() -> None:
    assert Decision({}, 2.0, 2.5, "x").gap == 0.5
    assert not Decision({}, 2.0, 2.5, "x").proved
    assert Decision({}, 2.0, 2.0 + 1e-12, "x").proved
    assert Decision({}, 2.0, 2.0 - 1e-12, "x").gap == 0.0
    assert Decision({}, 1e6, 1e6 + 1e-4, "x").proved


@pytest.mark.example
def test_an_ability_is_as_true_as_its_answer() -> None:
    assert Ability(True, "few states", "8 bytes")
    assert not Ability(False, "too many states", "8 petabytes")
