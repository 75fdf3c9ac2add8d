"""The compiled walk of `surveillance_domain.model.line_of_sight`: from cell to cell along many segments."""

from __future__ import annotations

from typing import Any, no_type_check

from numba import njit

__all__ = ["walk_segments"]


@no_type_check  # numba compiles the plain function, not one that checks its types
@njit(cache=True, nogil=True)
def walk_segments(walls: Any, start: Any, ends: Any, units: int, visible: Any) -> None:
    """``visible[k]``: no wall between ``start`` and ``ends[k]``, all in whole units, ``units`` of them a cell.

    ``walls[row, column]`` is true where a cell is blocked; cells outside of it are open.
    """
    rows, columns = walls.shape
    for k in range(len(ends)):
        travel_x, travel_y = ends[k, 0] - start[0], ends[k, 1] - start[1]
        step_x = (travel_x > 0) - (travel_x < 0)
        step_y = (travel_y > 0) - (travel_y < 0)
        # The cell that the segment enters first: on an edge, the one on the side that it goes to.
        column = -(-start[0] // units) - 1 if step_x < 0 else start[0] // units
        row = -(-start[1] // units) - 1 if step_y < 0 else start[1] // units
        last_column, last_row = ends[k, 0] // units, ends[k, 1] // units
        # The next upright edge comes before the next level one where due_x < due_y.
        pace_x, pace_y = abs(travel_y), abs(travel_x)
        due_x = (start[0] - column * units if step_x < 0 else (column + 1) * units - start[0]) * pace_x
        due_y = (start[1] - row * units if step_y < 0 else (row + 1) * units - start[1]) * pace_y
        clear = True
        while True:
            if 0 <= column < columns and 0 <= row < rows and walls[row, column]:
                clear = False
                break
            if column == last_column and row == last_row:
                break
            crosses_x = step_x != 0 and (step_y == 0 or due_x <= due_y)
            crosses_y = step_y != 0 and (step_x == 0 or due_y <= due_x)
            if crosses_x and crosses_y:
                beside = 0 <= column + step_x < columns and 0 <= row < rows and walls[row, column + step_x]
                above = 0 <= column < columns and 0 <= row + step_y < rows and walls[row + step_y, column]
                if beside and above:
                    clear = False
                    break
            if crosses_x:
                column += step_x
                due_x += units * pace_x
            if crosses_y:
                row += step_y
                due_y += units * pace_y
        visible[k] = clear
