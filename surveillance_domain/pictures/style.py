"""What all pictures of this domain share, beside what all pictures share (`factored_pomdp.pictures.style`)."""

from __future__ import annotations

from factored_pomdp.pictures.style import COLOURS, INK, PAPER, new_figure, save_figure, styled

__all__ = ["CAMERA_COLOURS", "FREE", "INK", "WALL", "new_figure", "save_figure", "styled"]

CAMERA_COLOURS = COLOURS
WALL = "#4d4d4d"
FREE = PAPER
