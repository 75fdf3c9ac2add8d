"""Direction beside walls: what P(d'|d) becomes where moves are lost, for the variants ``reject`` and ``reflect``.

The paper is silent about walls; these are the readings of the project's model page. Both give P(d'|d,l,v'), so that
eq:targettransmodel stays a product: speed first, then direction, then location.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.model.motion_location import STAYING, OpenMoves

__all__ = ["IMPOSSIBLE", "reflected_directions", "rejected_directions"]

IMPOSSIBLE = 1e-12
"""Open mass below which every direction in reach counts as blocked."""


def rejected_directions(
    plain: Float[np.ndarray, "directions directions"], moves: OpenMoves
) -> Float[np.ndarray, "cells speeds directions directions"]:
    """P(d'|d,l,v') where lost moves are rejected and the rest is renormalised over all pairs (d', l').

    P(d'|d,l,v') is proportional to P(d'|d) Z(l,d',v'), with Z the open share of the moves along d'. Where that sums to
    less than 1e-12 over d', the directions nearest to d (by angle) that have an open move take the mass, ties
    sharing it by their Z. Where no direction has an open move the direction stays (and the location table keeps the
    target in its cell).

    Parameters
    ----------
    plain : (directions, directions) float
        P(d'|d).
    moves : OpenMoves

    Returns
    -------
    (cells, speeds, directions, directions) float
        ``[l, v', d, d']``; rows sum to one.
    """
    directions = len(plain)
    table = plain * moves.open_mass[:, :, None, :]
    total = table.sum(axis=-1)
    cell, speed, direction = np.nonzero(total < IMPOSSIBLE)
    table[cell, speed, direction] = _nearest(
        moves.open_mass[cell, speed], _turns(directions)[direction], otherwise=np.eye(directions)[direction]
    )
    total[cell, speed, direction] = 1.0
    table /= total[..., None]
    return table


def reflected_directions(
    plain: Float[np.ndarray, "directions directions"], moves: OpenMoves
) -> Float[np.ndarray, "cells speeds directions directions"]:
    """P(d'|d,l,v') where a direction that a wall blocks outright is mirrored.

    A direction is drawn from P(d'|d). It is blocked outright at (l, v') if its moves lead to other cells and none of
    these is open. Then it is replaced by a mirror image: its x component reversed, its y component reversed, or both.
    Of the images that lead to an open cell, the one nearest to the direction drawn (by angle) is taken, equally near
    ones sharing the mass by their Z. That is the mirror of the blocking wall: beside a single wall only the component
    towards it, when reversed, opens the way; in a corner of two walls both must be. Where no image leads on, the
    direction drawn is kept and the target stays. With an odd number of directions an image may lie midway between two
    bins; then both are images.

    Parameters
    ----------
    plain : (directions, directions) float
        P(d'|d).
    moves : OpenMoves

    Returns
    -------
    (cells, speeds, directions, directions) float
        ``[l, v', d, d']``; rows sum to one.
    """
    directions = len(plain)
    turns = np.where(_mirror_images(directions), _turns(directions), np.inf)
    identity = np.eye(directions)
    table = np.broadcast_to(identity, (*moves.open_mass.shape[:2], directions, directions)).copy()
    moving = np.array([[move.offsets != (STAYING,) for move in by_speed] for by_speed in moves.moves])
    cell, speed, direction = np.nonzero(~moves.leads_on & moving.T)
    weight = moves.open_mass[cell, speed] * moves.leads_on[cell, speed]
    table[cell, speed, direction] = _nearest(weight, turns[direction], otherwise=identity[direction])
    return plain @ table


def _turns(directions: int) -> Float[np.ndarray, "directions directions"]:
    """Angle between every two directions, in bins."""
    bins = np.arange(directions)
    ahead = (bins[None, :] - bins[:, None]) % directions
    return np.minimum(ahead, directions - ahead).astype(float)


def _mirror_images(directions: int) -> Bool[np.ndarray, "directions directions"]:
    """``[d, e]``: whether e is d with its x component, its y component or both reversed, to the nearest bin."""
    images = np.zeros((directions, directions), dtype=bool)
    direction = np.arange(directions)
    half_turn = {directions // 2, (directions + 1) // 2}
    images[direction, -direction % directions] = True
    for half in half_turn:
        images[direction, (half - direction) % directions] = True
        images[direction, (half + direction) % directions] = True
    return images


def _nearest(
    weight: Float[np.ndarray, "rows directions"],
    turn: Float[np.ndarray, "rows directions"],
    otherwise: Float[np.ndarray, "rows directions"],
) -> Float[np.ndarray, "rows directions"]:
    """Share by weight among the directions of least turn that have weight; ``otherwise`` where none has."""
    reach = np.where(weight > 0, turn, np.inf)
    least = reach.min(axis=1, keepdims=True, initial=np.inf)
    chosen = np.where((reach == least) & np.isfinite(least), weight, 0.0)
    total = chosen.sum(axis=1, keepdims=True)
    return np.where(total > 0, chosen / np.where(total > 0, total, 1.0), otherwise)
