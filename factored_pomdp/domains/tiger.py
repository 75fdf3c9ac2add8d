"""Tiger: behind one of two doors; listening costs one and is right with probability 0.85.

Source: Cassandra, Kaelbling, Littman, "Acting optimally in partially observable stochastic domains", AAAI 1994.
"""

from __future__ import annotations

from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Variable

__all__ = ["tiger"]


def tiger(accuracy: float = 0.85, discount: float = 0.95) -> FactoredPOMDP:
    """The tiger problem.

    Parameters
    ----------
    accuracy : float
        Probability that listening tells the right door.
    discount : float
    """
    doors = ["left", "right"]

    def reward(tiger: str, act: str) -> float:
        if act == "listen":
            return -1.0
        return -100.0 if act == f"open-{tiger}" else 10.0

    def move(tiger: str, act: str) -> dict[str, float]:
        return {tiger: 1.0} if act == "listen" else {"left": 0.5, "right": 0.5}

    def hear(tiger_next: str, act: str) -> dict[str, float]:
        other = "right" if tiger_next == "left" else "left"
        return {tiger_next: accuracy, other: 1 - accuracy} if act == "listen" else {"left": 0.5, "right": 0.5}

    return FactoredPOMDP(
        name="tiger",
        states=[Variable("tiger", doors)],
        actions=[Variable("act", ["listen", "open-left", "open-right"])],
        observations=[Variable("heard", doors)],
        transition={"tiger": move},
        observation={"heard": hear},
        reward={"reward": reward},
        initial={"tiger": {"left": 0.5, "right": 0.5}},
        discount=discount,
    )
