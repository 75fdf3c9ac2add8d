"""The domain's option `discount`: with it one target on a small map is a problem for planners that plan for ever."""

from __future__ import annotations

import pytest

import factored_pomdp as fp
from solvers import PointBased


@pytest.mark.example
def test_a_discount_below_one_lets_point_based_plan_for_ever() -> None:
    undiscounted = fp.domain("surveillance", site="micro", targets=1)
    assert undiscounted.discount == 1.0
    assert "discount 1" in PointBased.can_solve(undiscounted).because
    model = fp.domain("surveillance", site="micro", targets="1", discount="0.95")
    assert model.discount == 0.95
    assert PointBased.can_solve(model).can


@pytest.mark.example
def test_a_discount_above_one_is_refused() -> None:
    with pytest.raises(fp.ModelError, match=r"discount: found 1\.2; expected a number in \[0, 1\]"):
        fp.domain("surveillance", site="micro", targets=1, discount=1.2)
