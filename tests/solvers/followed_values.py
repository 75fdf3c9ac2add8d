"""What a first action is worth if the myopic policy follows it: all observations, on the joint expansion."""

from __future__ import annotations

import numpy as np

import factored_pomdp as fp
from factored_pomdp.beliefs.plan import plan_of
from tests.plain import PlainModel

__all__ = ["followed_values"]

_TIE = 1e-9


def followed_values(model: fp.FactoredPOMDP, belief: np.ndarray, horizon: int) -> np.ndarray:
    """(actions,) discounted returns over ``horizon`` steps; minus infinity where an action is not legal.

    Parameters
    ----------
    belief : (joint states,) float
        Not normalised: the chance of an observation is the mass of what follows it.
    """
    flat, plain = fp.joint(model), PlainModel(model)
    known = plan_of(model).structure.known
    seen_together: dict[tuple, list[int]] = {}
    for number, state in enumerate(plain.states):
        seen_together.setdefault(tuple(state[name] for name in known), []).append(number)
    classes = [np.isin(np.arange(len(plain.states)), members) for members in seen_together.values()]
    legal = np.array([[model.is_legal(action, state) for state in plain.states] for action in flat.actions])

    def values(belief: np.ndarray, steps: int) -> np.ndarray:
        worth = flat.reward @ belief
        for action in range(len(flat.actions)) if steps > 1 else ():
            moved = belief @ flat.transition[action]
            for column in range(flat.observation[action].shape[1]):
                joint = moved * flat.observation[action][:, [column]].toarray().ravel()
                for together in classes:
                    after = joint * together
                    if after.sum() > 0:
                        now = allowed(flat.reward @ after, after)
                        chosen = int(np.flatnonzero(now >= now.max() - _TIE * after.sum())[0])
                        worth[action] += flat.discount * values(after, steps - 1)[chosen]
        return worth

    def allowed(worth: np.ndarray, belief: np.ndarray) -> np.ndarray:
        return np.where((legal | (belief <= 0)).all(axis=1), worth, -np.inf)

    return allowed(values(belief, horizon), belief)
