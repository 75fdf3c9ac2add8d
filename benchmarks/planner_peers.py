"""One planner on one model: ``python -m benchmarks.planner_peers MODEL PEER SECONDS SEED`` prints what it found.

MODEL is a file, or the name of an installed domain. For the peer ``exact`` SECONDS is the horizon.

Loading the model, importing and compiling are not timed.
"""

from __future__ import annotations

import contextlib
import io
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import factored_pomdp as fp
from benchmarks.machine import peak_bytes

__all__ = ["PEERS"]

_PRECISION = 1e-3


def ours(path: str, limit: float, seed: int) -> dict[str, Any]:
    """Our point-based solver."""
    from solvers import Limits, PointBased

    PointBased(fp.domain("tiger")).solve(Limits(precision=1.0))
    solver = PointBased(_model(path))
    return _timed(lambda: solver.solve(Limits(precision=_PRECISION, time_limit=limit)), _bounds)


def exact(path: str, horizon: float, seed: int) -> dict[str, Any]:
    """Our exact solver for so many steps."""
    from solvers import Exact, Limits

    Exact(fp.domain("tiger")).solve(Limits(horizon=2))
    solver = Exact(_model(path))
    return _timed(lambda: solver.solve(Limits(horizon=int(horizon))), lambda f: _bounds(f) | {"vectors": f.vectors})


def _bounds(found: Any) -> dict[str, Any]:
    return {"lower": found.lower, "upper": found.upper}


def pomdp_toolkit(path: str, limit: float, seed: int) -> dict[str, Any]:
    """HSVI of pomdp-toolkit: more and more expansions from the start until the time is up or its value stands."""
    with contextlib.redirect_stdout(io.StringIO()):
        from pomdp_toolkit import POMDP, Belief
        from pomdp_toolkit.solvers import HSVI
    flat = fp.joint(_model(path))
    transition = np.stack([matrix.toarray() for matrix in flat.transition], axis=1)
    observation = np.stack([matrix.toarray() for matrix in flat.observation], axis=1)
    states, actions, seen = len(flat.initial), len(flat.actions), observation.shape[2]
    rewards = np.broadcast_to(flat.reward.T[:, :, None, None], (states, actions, states, seen))
    with contextlib.redirect_stdout(io.StringIO()):
        model = POMDP(
            states, actions, seen, observation, transition, reward_table=rewards, start_probabilities=flat.initial
        )

    def solve() -> float:
        until, value, function, mdp = time.perf_counter() + limit, -np.inf, None, None
        while time.perf_counter() < until:
            function, _, mdp = HSVI.solve(
                model,
                expansions=10,
                max_belief_growth=50,
                initial_value_function=function,
                mdp_policy=mdp,
                gamma=flat.discount,
                epsilon=_PRECISION,
                rng=seed,
                return_mdp_policy=True,
                print_progress=False,
                print_stats=False,
            )
            now = float(np.asarray(function.evaluate_at(Belief(model))[0]))
            if abs(now - value) < 1e-9:
                break
            value = now
        return value

    with contextlib.redirect_stdout(io.StringIO()):
        return _timed(solve, lambda value: {"lower": value, "upper": None, "estimate": True})


def pouct(path: str, limit: float, seed: int) -> dict[str, Any]:
    """POUCT of pomdp_py: the value of the best action at the root of its tree when the time is up."""
    import random

    import pomdp_py

    from benchmarks.planner_models import agent_of

    random.seed(seed)
    flat = fp.joint(_model(path))
    agent = agent_of(flat, np.random.default_rng(seed))
    planner = pomdp_py.POUCT(
        max_depth=100,
        discount_factor=flat.discount,
        planning_time=limit,
        exploration_const=float(np.ptp(flat.reward)) or 1.0,
        rollout_policy=agent.policy_model,
    )

    def solve() -> float:
        planner.plan(agent)
        return max(child.value for child in agent.tree.children.values())

    return _timed(solve, lambda value: {"lower": value, "upper": None, "estimate": True})


def value_iteration(path: str, limit: float, seed: int) -> dict[str, Any]:
    """Value iteration of pomdp_py, for one step more each time while the time lasts."""
    import pomdp_py

    from benchmarks.planner_models import agent_of

    flat = fp.joint(_model(path))
    agent = agent_of(flat, np.random.default_rng(seed))
    trees, found = 1, {"horizon": 0}
    bearable = 30_000

    def solve() -> None:
        nonlocal trees
        until = time.perf_counter() + limit
        while time.perf_counter() < until:
            trees = len(flat.actions) * trees ** len(flat.observations)
            if trees > bearable:
                return
            horizon = found["horizon"] + 1
            planner = pomdp_py.ValueIteration(horizon=horizon, discount_factor=flat.discount)
            planner.plan(agent)
            found.update(horizon=horizon)

    timed = _timed(solve, lambda _: {})
    if not found["horizon"]:
        raise SystemExit(f"even one step makes more than {bearable:,} policy trees")
    return timed | {"lower": None, "upper": None, "remark": f"horizon {found['horizon']} is the most it can bear"}


PEERS = {
    "ours": ours,
    "exact": exact,
    "pomdp-toolkit": pomdp_toolkit,
    "pomdp_py POUCT": pouct,
    "pomdp_py value iteration": value_iteration,
}


def _model(path: str) -> fp.FactoredPOMDP:
    return fp.load(path) if Path(path).is_file() else fp.domain(path)


def _timed(solve: Any, read: Any) -> dict[str, Any]:
    wall, processor = time.perf_counter(), time.process_time()
    found = solve()
    took = {"seconds": time.perf_counter() - wall, "processor_s": time.process_time() - processor}
    return {**read(found), **took, "peak_bytes": peak_bytes()}


if __name__ == "__main__":
    file, peer, seconds, number = sys.argv[1:]
    print(json.dumps(PEERS[peer](file, float(seconds), int(number))))
