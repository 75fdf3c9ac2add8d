"""Pairs of successive moves: what a motion model is learned from and judged by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from surveillance_domain.trajectories.resampling import resampled
from surveillance_domain.trajectories.tracks import Track

__all__ = ["STILL_MPS", "Transitions", "in_order_of_content", "split_people", "transitions"]

STILL_MPS = 0.25
"""Below this speed a person stands, and the direction of what is left of a move is the annotator's."""


@dataclass(frozen=True, eq=False)
class Transitions:
    """Moves of one step, each with the one after it.

    Attributes
    ----------
    before_m, after_m : (pairs, 2) float
        Two successive displacements of one person.
    people : (pairs,) int
        Whose they are.
    step_s : float
    points_m : (points, 2) float
        All resampled positions.
    moves_mps : (moves,) float
        Speeds of all moves, those without a successor too.
    """

    before_m: Float[np.ndarray, "pairs 2"]
    after_m: Float[np.ndarray, "pairs 2"]
    people: Int[np.ndarray, " pairs"]
    step_s: float
    points_m: Float[np.ndarray, "points 2"]
    moves_mps: Float[np.ndarray, " moves"]

    @property
    def turns_rad(self) -> Float[np.ndarray, " walking"]:
        """Changes of direction, in (-π, π], where the person walked in both moves."""
        walking = self.walking
        before, after = (np.arctan2(*moves[walking].T[::-1]) for moves in (self.before_m, self.after_m))
        return np.pi - (np.pi - (after - before)) % (2 * np.pi)

    @property
    def walking(self) -> Bool[np.ndarray, " pairs"]:
        """Whether the person walked in both moves."""
        slow = STILL_MPS * self.step_s
        return (np.hypot(*self.before_m.T) >= slow) & (np.hypot(*self.after_m.T) >= slow)

    @property
    def speed_changes_mps(self) -> Float[np.ndarray, " pairs"]:
        """By how much the second move is faster than the first."""
        return (np.hypot(*self.after_m.T) - np.hypot(*self.before_m.T)) / self.step_s


def transitions(tracks: Sequence[Track], step_s: float) -> Transitions:
    """All pairs of successive moves of tracks resampled to ``step_s``, each track from its own first point."""
    names = {name: number for number, name in enumerate(dict.fromkeys(track.name for track in tracks))}
    before, after, people = [np.empty((0, 2))], [np.empty((0, 2))], [np.empty(0, dtype=np.int64)]
    points, speeds = [np.empty((0, 2))], [np.empty(0)]
    for track in tracks:
        stepped = resampled(track, step_s)
        if stepped is None:
            continue
        moves = np.diff(stepped.points_m, axis=0)
        points.append(stepped.points_m)
        speeds.append(np.hypot(*moves.T) / step_s)
        before.append(moves[:-1])
        after.append(moves[1:])
        people.append(np.full(len(moves[1:]), names[track.name]))
    return Transitions(
        before_m=np.concatenate(before),
        after_m=np.concatenate(after),
        people=np.concatenate(people),
        step_s=step_s,
        points_m=np.concatenate(points),
        moves_mps=np.concatenate(speeds),
    )


def in_order_of_content(tracks: Sequence[Track]) -> tuple[Track, ...]:
    """The tracks by when and where they begin, then by name: the same whatever the order of a file's rows."""
    return tuple(sorted(tracks, key=lambda track: (float(track.times_s[0]), *track.points_m[0].tolist(), track.name)))


def split_people(
    tracks: Sequence[Track], share: float, rng: np.random.Generator
) -> tuple[tuple[Track, ...], tuple[Track, ...]]:
    """Tracks to learn from and tracks held out; all tracks of one person stand on one side.

    Who is held out is drawn among the people in the order in which they come in (`in_order_of_content`), so it does
    not depend on the order of rows or files.

    Parameters
    ----------
    share : float
        Of the people that are held out; at least one is on either side where there are two.
    """
    names = list(dict.fromkeys(track.name for track in in_order_of_content(tracks)))
    count = min(max(1, round(share * len(names))), len(names) - 1)
    held = {names[number] for number in rng.permutation(len(names))[:count]}
    return tuple(t for t in tracks if t.name not in held), tuple(t for t in tracks if t.name in held)
