"""The decision on the hall beside what else could be written for it, measured in turns."""

from __future__ import annotations

import numpy as np

from benchmarks.flat import Flat
from benchmarks.hall import Hall
from benchmarks.report import Aim, Report, milliseconds
from benchmarks.theorem1 import TheoremOne
from benchmarks.timing import Timing, in_turns

__all__ = ["rivals"]

COUNTS = (1, 5, 20)
_AGREE = 1e-9
_LABELS = {
    "copy": "copying the beliefs once (memory floor)",
    "prediction": "prediction",
    "update": "prediction and conditioning",
    "decision": "whole decision",
    "csr": "scipy CSR, target by target: prediction",
    "csr-update": "scipy CSR, target by target: prediction, conditioning",
    "csr-at-once": "scipy CSR, all targets at once: prediction",
    "csr-at-once-update": "scipy CSR, all targets at once: prediction, conditioning",
    "theorem-1": "Theorem 1 in its printed order, numpy: decision",
    "theorem-1-products": "Theorem 1, posteriors left implicit in BLAS products: decision",
}


def rivals(quick: bool, seed: int, counts: tuple[int, ...] = COUNTS, site: str = "hall") -> Report:
    """Ours against scipy, Theorem 1's algorithm and the memory floor; all of them are checked to agree first."""
    rows, figures, aims = [], {}, []
    for targets in counts:
        hall = Hall.of(targets, np.random.default_rng(seed), site)
        flat, theorem = Flat.of(hall), TheoremOne.of(hall)
        _refuse_difference(hall, flat, theorem)
        short = {
            "copy": lambda hall=hall: hall.belief.arrays[0].copy(),
            "prediction": lambda hall=hall: hall.fresh().predict(hall.action),
            "update": hall.updated,
            "decision": hall.decided,
            "csr": flat.predicted_in_turn,
            "csr-update": flat.updated_in_turn,
            "csr-at-once": flat.predicted_at_once,
            "csr-at-once-update": flat.updated_at_once,
        }
        long = {
            "decision": hall.decided,
            "theorem-1": theorem.decided,
            "theorem-1-products": theorem.values_as_products,
        }
        timed = in_turns(short, 100, 2.0 if quick else 6.0)
        slow = in_turns(long, 2 if quick else 7, 2.0 if quick else 10.0)
        ratios = {name: timing.over(timed["decision"]) for name, timing in timed.items()}
        ratios |= {name: slow[name].over(slow["decision"]) for name in slow if name != "decision"}
        every = timed | {name: timing for name, timing in slow.items() if name != "decision"}
        rows += [[f"{targets}", _LABELS[n], milliseconds(t.median), f"{ratios[n]:,.3g}"] for n, t in every.items()]
        figures[targets] = {
            name: {"median_s": t.median, "best_s": t.best, "over_decision": ratios[name]} for name, t in every.items()
        }
        aims += _aims(targets, timed, slow)
    notes = ["ratios are medians over turns of the two times in the same turn"]
    return Report(
        f"{site}: ours and others", ["targets", "what", "median", "÷ our decision"], rows, figures, aims, notes
    )


def _aims(targets: int, timed: dict[str, Timing], slow: dict[str, Timing]) -> list[Aim]:
    if targets != COUNTS[-1]:
        return []
    loop, update, decision = timed["csr-update"], timed["update"], timed["decision"]
    return [
        Aim(f"m = {targets}: prediction and conditioning ÷ the same by a loop of scipy CSR", update.over(loop), 0.2),
        Aim(f"m = {targets}: whole decision ÷ prediction alone by that loop", decision.over(timed["csr"]), 1.0),
        Aim(f"m = {targets}: Theorem 1 ÷ decision", slow["theorem-1"].over(slow["decision"]), 1000.0, at_least=True),
    ]


def _refuse_difference(hall: Hall, flat: Flat, theorem: TheoremOne) -> None:
    """A rival that computes something else is no rival."""
    posterior = hall.updated().arrays[0]
    for name, other in (("in turn", np.array(flat.updated_in_turn()).T), ("at once", flat.updated_at_once())):
        if (gap := float(np.abs(posterior - other).max())) > _AGREE:
            raise RuntimeError(f"posterior by scipy {name} differs by {gap:g}")
    values = theorem.values()
    ours = [hall.solver.value(hall.belief, theorem.action_of(hall, n)) for n in range(len(values))]
    for name, other in (("printed order", values), ("products", theorem.values_as_products())):
        if (gap := float(np.abs(np.array(ours) - other).max())) > _AGREE * len(hall.surveillance.targets):
            raise RuntimeError(f"Theorem 1 in {name} differs by {gap:g}")
