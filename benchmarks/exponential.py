"""The exponential joint solver beside the decomposition, on the sites that it can take."""

from __future__ import annotations

import numpy as np

from benchmarks.hall import Hall
from benchmarks.report import Report, milliseconds
from benchmarks.timing import in_turns
from factored_pomdp.beliefs.comparison import joint_of
from solvers import JointMyopic

__all__ = ["exponential"]

CASES = (("tiny", 1), ("tiny", 2), ("tiny-3", 3))
_AGREE = 1e-9


def exponential(quick: bool, seed: int, cases: tuple[tuple[str, int], ...] | None = None) -> Report:
    """One choice of each solver from the same dense product belief."""
    rows, figures = [], {}
    chosen = CASES if cases is None else cases
    for site, targets in chosen[:2] if quick else chosen:
        ours = Hall.of(targets, np.random.default_rng(seed), site)
        solver, joint = JointMyopic(ours.surveillance.model), joint_of(ours.belief)
        gap = abs(solver.decide(joint).value - ours.solver.decide(ours.belief).value)
        if gap > _AGREE:
            raise RuntimeError(f"values of the two solvers on {site} with {targets} targets differ by {gap:g}")
        timed = in_turns(
            {"joint": lambda s=solver, b=joint: s.decide(b), "ours": lambda h=ours: h.solver.decide(h.fresh())},
            1 if quick else 3,
            5.0,
        )
        ratio = timed["joint"].over(timed["ours"])
        states = ours.surveillance.model.joint_states
        row = [site, f"{targets}", f"{states:,}", *(milliseconds(timed[n].median) for n in ("joint", "ours"))]
        rows.append([*row, f"{ratio:,.3g}"])
        figures[f"{site} {targets}"] = {
            "joint_s": timed["joint"].median,
            "decomposed_s": timed["ours"].median,
            "ratio": ratio,
        }
    columns = ["site", "targets", "joint states", "joint solver", "decomposition", "ratio"]
    return Report("One choice: exponential and decomposed", columns, rows, figures)
