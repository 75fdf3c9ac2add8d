"""SysAdmin: the published probabilities, and the ring that ties every computer to the next."""

from __future__ import annotations

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp.verification import verify
from solvers.myopic import DecomposedMyopic


@pytest.mark.example
@pytest.mark.parametrize(
    ("own", "before", "up"),
    [("up", "up", 0.95), ("up", "down", 0.475), ("down", "up", 0.0475), ("down", "down", 0.0238)],
)
def test_the_published_probabilities(own: str, before: str, up: float) -> None:
    law = fp.domain("sysadmin", machines=3).transition["machine2"]
    given = {"machine2": own, "machine1": before, "machine2.next": "up"}
    assert law.value({**given, "reboot": "machine3"}) == pytest.approx(up)
    assert law.value({**given, "reboot": "machine2"}) == 1.0


@pytest.mark.example
def test_the_first_computer_hears_of_the_last() -> None:
    model = fp.domain("sysadmin", machines=4)
    assert set(model.transition["machine1"].names) == {"machine1", "machine4", "reboot", "machine1.next"}
    certificate = fp.decompose(model)
    assert not certificate.decomposes
    assert [(tie.kind, tie.factor) for tie in certificate.ties] == [
        ("transition", f"transition of machine{number}.next") for number in range(1, 5)
    ]
    assert all(tie.counterexample is not None for tie in certificate.ties)


@pytest.mark.example
def test_all_run_and_earn_at_the_start_and_a_reboot_costs() -> None:
    solver = DecomposedMyopic(fp.domain("sysadmin", machines=3, reboot_cost=0.5))
    values = {action["reboot"]: value for action, value in solver.values(solver.start())}
    assert values == pytest.approx({"none": 3.0, "machine1": 2.5, "machine2": 2.5, "machine3": 2.5})


@pytest.mark.example
def test_a_ping_is_wrong_at_times() -> None:
    model = fp.domain("sysadmin", machines=2, accuracy=0.9)
    belief = fp.initial_belief(model).predict({"reboot": "none"})
    # Up with 0.95; a ping that says down leaves 0.95 · 0.1 : 0.05 · 0.9.
    heard = belief.condition({"machine1.ping": "down"})
    assert heard.marginal("machine1")[0] == pytest.approx(0.095 / 0.14)
    assert heard.marginal("machine2")[0] == pytest.approx(0.95)


@pytest.mark.property
def test_joint_and_decomposed_solvers_agree() -> None:
    assert verify(fp.domain("sysadmin", machines=3), 5, 5, np.random.default_rng(2)).holds


@pytest.mark.example
def test_options_of_sysadmin_are_checked() -> None:
    with pytest.raises(ValueError, match=r"machines=1: expected 2 to 500; accuracy=0.2: expected a number from 0.5"):
        fp.domain("sysadmin", machines=1, accuracy=0.2)
