"""pgmpy's variable elimination on one target's two-slice network, beside our prediction and conditioning."""

from __future__ import annotations

import numpy as np

from benchmarks.hall import Hall
from benchmarks.report import Report, milliseconds
from benchmarks.timing import in_turns

__all__ = ["elimination"]

_AGREE = 1e-6


def elimination(quick: bool, seed: int, site: str = "hall") -> Report:
    """The posterior of one target from the model's initial belief."""
    from pgmpy.inference import VariableElimination

    import factored_pomdp as fp
    from factored_pomdp.files.pgmpy_adapter import to_pgmpy

    hall = Hall.of(1, np.random.default_rng(seed), site)
    model, start = hall.surveillance.model, fp.initial_belief(hall.surveillance.model)
    target = hall.surveillance.targets[0]
    inference = VariableElimination(to_pgmpy(model, hall.action, start.known))
    evidence = {**hall.sighting, **{f"{name}.next": value for name, value in hall.known.items()}}
    asked = [f"{target}.{part}.next" for part in ("location", "direction", "speed")]

    def theirs() -> object:
        return inference.query(asked, evidence=evidence, show_progress=False)

    def ours() -> fp.ProductBelief:
        return start.with_arrays(start.arrays).predict(hall.action).condition(hall.sighting, hall.known)

    found = theirs()
    table = np.transpose(found.values, [found.variables.index(name) for name in asked])
    gap = float(np.abs(table.ravel() - ours().arrays[0][:, 0]).max())
    if gap > _AGREE:
        raise RuntimeError(f"pgmpy's posterior differs by {gap:g}")
    timed = in_turns({"pgmpy": theirs, "ours": ours}, 1 if quick else 5, 2.0 if quick else 10.0)
    ratio = timed["pgmpy"].over(timed["ours"])
    return Report(
        f"One target's posterior on {site}: pgmpy's variable elimination",
        ["pgmpy", "ours", "ratio"],
        [[milliseconds(timed["pgmpy"].median), milliseconds(timed["ours"].median), f"{ratio:,.3g}"]],
        {"pgmpy_s": timed["pgmpy"].median, "ours_s": timed["ours"].median, "ratio": ratio},
    )
