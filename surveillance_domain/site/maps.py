"""The planning grid of a site: rows drawn in the site file, or a ROS map_server map."""

from __future__ import annotations

from pathlib import Path

from surveillance_domain.site.explain import shown
from surveillance_domain.site.faults import Fault
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.ros_maps import RosMapError, read_ros_map
from surveillance_domain.site.sections import Map

__all__ = ["build_grid"]

_LONGEST_SIDE = 100_000


def build_grid(section: Map, folder: Path) -> tuple[Grid | None, tuple[bytes, ...], tuple[Fault, ...]]:
    """The grid, the contents of the files that it was made from, and the faults (then there is no grid)."""
    if (section.rows is None) == (section.ros is None):
        found = "neither rows nor ros" if section.rows is None else "both rows and ros"
        return None, (), (Fault("map", found, "one of the two"),)
    if section.rows is not None:
        faults = _row_faults(section.rows)
        if faults:
            return None, (), faults
        return _if_usable(Grid.from_rows(list(section.rows), section.cell_m), "map.rows", ())
    try:
        ros_map = read_ros_map(folder / str(section.ros))
        grid = ros_map.grid(section.cell_m, section.unknown)
    except RosMapError as error:
        return None, (), tuple(_in_site(error.source, fault) for fault in error.faults)
    return _if_usable(grid, "map.ros", ros_map.contents)


def _in_site(source: str, fault: Fault) -> Fault:
    """A fault of a map_server file as a fault of the site file that names it."""
    if fault.where == "cell_m":
        return Fault("map.cell_m", fault.found, fault.expected)
    place = f"{source}, {fault.where}" if fault.where else source
    return Fault("map.ros", f"in {place}: {fault.found}", fault.expected)


def _if_usable(
    grid: Grid, where: str, contents: tuple[bytes, ...]
) -> tuple[Grid | None, tuple[bytes, ...], tuple[Fault, ...]]:
    if grid.size == 0:
        return None, (), (Fault(where, "a map without free cells", "at least one free cell"),)
    if max(grid.rows, grid.columns) > _LONGEST_SIDE:
        found = f"a map of {grid.columns} x {grid.rows} cells"
        return None, (), (Fault(where, found, f"at most {_LONGEST_SIDE} cells along either side"),)
    return grid, contents, ()


def _row_faults(rows: tuple[str, ...]) -> tuple[Fault, ...]:
    """Wrong marks, or if there are none, wrong lengths."""
    width = len(rows[0])
    if width == 0:
        return (Fault("map.rows[0]", "an empty row", "'#' blocked and '.' free"),)
    marks = [(index, sorted(set(row) - set(".#"))) for index, row in enumerate(rows)]
    wrong_marks = [
        Fault(f"map.rows[{index}]", f"the mark {shown(wrong[0])}", "'#' blocked and '.' free only")
        for index, wrong in marks
        if wrong
    ]
    wrong_lengths = [
        Fault(f"map.rows[{index}]", f"{len(row)} marks", f"{width}, as in the first row")
        for index, row in enumerate(rows)
        if len(row) != width
    ]
    return tuple(wrong_marks or wrong_lengths)
