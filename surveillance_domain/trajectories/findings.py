"""What is wrong in a recording, told once for each kind: how many, who, where, what was done, what can be done."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Int

from surveillance_domain.trajectories.rows import Rows

__all__ = ["Finding", "Limits", "findings"]

_SHOWN = 5
_LEAVING_OUT = ("contradictory_frames", "single_points", "other_units")


@dataclass(frozen=True)
class Limits:
    """Where a track is cut.

    Attributes
    ----------
    gap_s : float
        Longest time without a point that is filled by interpolation.
    fastest_mps : float
        Faster moves are jumps.
    """

    gap_s: float = 2.0
    fastest_mps: float = 10.0


@dataclass(frozen=True)
class Finding:
    """One kind of fault.

    Attributes
    ----------
    kind : str
        The field of `surveillance_domain.trajectories.tracks.Counts` that counts it.
    number : int
    people : int
        How many it concerns.
    first_people : tuple of str
        The first few of them.
    first : dict
        Where it is met first: ``id``, ``frame`` (or ``time_s``) and ``line``.
    left_out : int
        How many of these people are left out altogether.
    message : str
        All of it in words.
    """

    kind: str
    number: int
    people: int
    first_people: tuple[str, ...]
    first: dict[str, Any]
    left_out: int
    message: str


def findings(
    rows: Rows, places: Mapping[str, Int[np.ndarray, "..."]], kept: Collection[int], limits: Limits
) -> tuple[Finding, ...]:
    """Put into words what was met, where it was.

    Parameters
    ----------
    rows : Rows
    places : mapping
        For each kind the numbers of the rows at which it was met, each as often as it counts.
    kept : collection of int
        Numbers of the people of whom something is left.
    limits : Limits
    """
    return tuple(_finding(kind, rows, at, kept, limits) for kind, at in places.items() if len(at))


def _finding(kind: str, rows: Rows, at: Int[np.ndarray, " found"], kept: Collection[int], limits: Limits) -> Finding:
    at = at[np.argsort(rows.lines[at], kind="stable")]
    concerned = list(dict.fromkeys(rows.tracks[at].tolist()))
    left_out = sum(person not in kept for person in concerned) if kind in _LEAVING_OUT else 0
    names = tuple(rows.names[person] for person in concerned[:_SHOWN])
    frame = "time_s" if rows.timed else "frame"
    first = {
        "id": rows.names[rows.tracks[at[0]]],
        frame: float(rows.frames[at[0]]),
        "line": int(rows.lines[at[0]]),
    }
    what, done, advice = _words(kind, limits)
    of = "" if kind == "other_units" else f", of {len(concerned):,} {'people' if len(concerned) > 1 else 'person'}"
    more = f" and {len(concerned) - len(names):,} more" if len(concerned) > len(names) else ""
    lost = f" ({left_out:,} of {len(rows.names):,} people left out altogether)" if left_out else ""
    message = (
        f"{what}: {len(at):,}{of}: id {', '.join(names)}{more}; the first at {frame.removesuffix('_s')} "
        f"{first[frame]:.14g}, line {first['line']}. {done}{lost}. {advice}."
    )
    return Finding(kind, len(at), len(concerned), names, first, left_out, message)


def _words(kind: str, limits: Limits) -> tuple[str, str, str]:
    """What it is, what was done, and what can be done about it."""
    gap, fastest = f"{limits.gap_s:g} s", f"{limits.fastest_mps:g} m/s"
    return {
        "repeated_rows": ("rows that stand there twice", "Each was taken once", "Nothing is lost by it"),
        "contradictory_frames": (
            "frames that have one person at two places",
            "What that person did in these frames was left out",
            "If recordings were joined, keep each in a file of its own, or give its people ids of their own",
        ),
        "out_of_order_rows": (
            "rows of an earlier frame than the same person's row before",
            "They were put in order",
            "See that no id stands for two people",
        ),
        "gaps_filled": (
            f"gaps of up to {gap} in which a person has no point",
            "They were filled along straight lines",
            "Give a smaller --max-gap-s to cut the tracks there",
        ),
        "gaps_cut": (
            f"gaps of more than {gap} in which a person has no point",
            "The tracks were cut there",
            "Give a larger --max-gap-s to fill them",
        ),
        "jumps": (
            f"jumps, moves faster than {fastest}",
            "The tracks were cut there",
            "See that unit and frames a second are right and that no id stands for two people; or give a larger "
            "--fastest-mps",
        ),
        "single_points": (
            "tracks, or parts of one, that are a single point",
            "They were left out",
            "One point says nothing of motion",
        ),
        "other_units": (
            f"people most of whose moves are faster than {fastest}, as if in another unit than the others",
            "They were left out",
            "Write all people in one unit: put those in pixels or centimetres into a file of their own, with its own "
            "--metres-per-unit or --homography",
        ),
    }[kind]
