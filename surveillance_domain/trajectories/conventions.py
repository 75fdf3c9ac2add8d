"""How the numbers of a file are meant: frames a second, and what a unit is on the floor.

The user says it by options, or in a *sidecar*: a TOML file of the same name with ``.toml`` behind it, such as
``obsmat.txt.toml``; an option goes before it. Nothing is guessed: a rate comes from the file itself only where the file
tells it (TrajNet++ and CSV with times).
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from jaxtyping import Float
from pydantic import Field, ValidationError

from surveillance_domain.site.explain import faults_of
from surveillance_domain.site.faults import Fault
from surveillance_domain.site.fields import FileName, Number, Positive, Section
from surveillance_domain.trajectories.rows import TrajectoryError, number_of

__all__ = [
    "MOST_M",
    "Conventions",
    "on_floor",
    "read_homography",
    "sidecar_of",
    "third_coordinate",
    "with_sidecar",
]

MOST_M = 1e12
"""No place is farther away, in metres along an axis."""
_ON_HORIZON = 1e-12
"""Of the terms of the third homogeneous coordinate: a sum so small is noise."""

_Row = tuple[Number, Number, Number]


@dataclass(frozen=True, eq=False)
class Conventions:
    """How a file is to be read; ``None`` where nothing was said.

    Attributes
    ----------
    frames_per_s : float or None
    metres_per_unit : float or None
        One pixel's, one centimetre's …; positions are metres where neither this nor a homography is given.
    homography : (3, 3) float or None
        From the file's points to metres on the floor.
    form : str or None
        One of `surveillance_domain.trajectories.formats.FORMATS`.
    columns : dict
        Names of a CSV file's columns.
    homography_from : str
        Where the homography was told.
    """

    frames_per_s: float | None = None
    metres_per_unit: float | None = None
    homography: Float[np.ndarray, "3 3"] | None = None
    form: str | None = None
    columns: dict[str, str] | None = None
    homography_from: str = "homography"


class _Sidecar(Section):
    frames_per_s: Positive | None = Field(None, description="frames a second, above 0")
    metres_per_unit: Positive | None = Field(None, description="metres above 0")
    homography: tuple[_Row, _Row, _Row] | FileName | None = Field(
        None, description="three rows of three numbers, or the path of a file that holds them"
    )
    form: Annotated[str, Field(pattern="^(frame-text|obsmat|trajnet|csv)$")] | None = Field(
        None, description='"frame-text", "obsmat", "trajnet" or "csv"'
    )
    columns: dict[str, str] | None = Field(None, description='names of columns, such as { x = "pos_x", id = "person" }')


def sidecar_of(path: Path) -> Path:
    """Where the sidecar of a file lies, if it has one: ``walk.txt`` has ``walk.txt.toml`` beside it."""
    return path.parent / f"{path.name}.toml"


def with_sidecar(path: Path, given: Conventions) -> Conventions:
    """What was given, and for the rest what the file's sidecar says.

    Raises
    ------
    TrajectoryError
        With every fault of the sidecar, or if both a scale and a homography were given.
    """
    sidecar = sidecar_of(path)
    if sidecar.is_file():
        said = _read_sidecar(sidecar)
        on_the_floor = given.metres_per_unit is None and given.homography is None
        given = Conventions(
            frames_per_s=given.frames_per_s or said.frames_per_s,
            metres_per_unit=said.metres_per_unit if on_the_floor else given.metres_per_unit,
            homography=said.homography if on_the_floor else given.homography,
            form=given.form or said.form,
            columns=given.columns or said.columns,
            homography_from=f"homography in {sidecar.name}" if on_the_floor else given.homography_from,
        )
    if given.metres_per_unit is not None and given.homography is not None:
        raise TrajectoryError(str(path), (Fault("", "metres_per_unit and a homography", "one of the two"),))
    return given


def _read_sidecar(path: Path) -> Conventions:
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
        said = _Sidecar.model_validate(tables)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise TrajectoryError(str(path), (Fault("", f"text that is not TOML: {error}", "a TOML file"),)) from None
    except ValidationError as error:
        raise TrajectoryError(str(path), faults_of(error, _Sidecar, tables)) from None
    except OSError as error:
        found = (error.strerror or str(error)).lower()
        raise TrajectoryError(str(path), (Fault("", found, "a sidecar that can be read"),)) from None
    matrix: Any = said.homography
    if isinstance(matrix, str):
        matrix = read_homography(path.parent / matrix)
    elif matrix is not None:
        matrix = _checked(np.array(matrix, dtype=float), str(path))
    return Conventions(said.frames_per_s, said.metres_per_unit, matrix, said.form, said.columns)


def read_homography(path: Path) -> Float[np.ndarray, "3 3"]:
    """Three rows of three numbers, as ETH's and UCY's ``H.txt``.

    Raises
    ------
    TrajectoryError
        If there is no such file, or no invertible matrix in it.
    """
    try:
        words = path.read_text(encoding="utf-8").replace(",", " ").split()
    except (OSError, UnicodeDecodeError) as error:
        no_text = isinstance(error, UnicodeDecodeError)
        found = "bytes that are no text" if no_text else (getattr(error, "strerror", None) or str(error)).lower()
        raise TrajectoryError(str(path), (Fault("", found, "a text file of three rows of numbers"),)) from None
    numbers = [number for number in map(number_of, words) if number is not None]
    if len(words) != 9 or len(numbers) != 9:
        raise TrajectoryError(str(path), (Fault("", f"{len(words)} words", "three rows of three finite numbers"),))
    return _checked(np.array(numbers).reshape(3, 3), str(path))


def _checked(matrix: Float[np.ndarray, "3 3"], source: str) -> Float[np.ndarray, "3 3"]:
    even = matrix
    for axis in (0, 1):  # so that neither a factor of the whole matrix nor far-away origins make it look singular
        most = np.abs(even).max(axis=axis, keepdims=True)
        even = even / np.where(most > 0, most, 1.0)
    if abs(np.linalg.det(even)) < 1e-15:
        raise TrajectoryError(source, (Fault("homography", "a singular matrix", "a matrix that can be inverted"),))
    return matrix


def on_floor(points: Float[np.ndarray, "points 2"], conventions: Conventions) -> Float[np.ndarray, "points 2"]:
    """A file's points in metres; points on the horizon of a homography become nan."""
    if conventions.homography is not None:
        third = third_coordinate(points, conventions.homography)
        scale = np.where(third == 0, np.nan, third)
        with np.errstate(over="ignore", invalid="ignore"):  # points beyond all numbers are told of by whoever uses them
            x, y = conventions.homography[:2] @ np.column_stack([points, np.ones(len(points))]).T
            return np.stack([x / scale, y / scale], axis=1)
    with np.errstate(over="ignore"):
        return points * (conventions.metres_per_unit or 1.0)


def third_coordinate(
    points: Float[np.ndarray, "points 2"], matrix: Float[np.ndarray, "3 3"]
) -> Float[np.ndarray, " points"]:
    """The third homogeneous coordinate of what a homography makes of points; 0 on its horizon."""
    with np.errstate(over="ignore", invalid="ignore"):
        terms = np.column_stack([points, np.ones(len(points))]) * matrix[2]
        third = terms.sum(axis=1)
        return np.where(np.abs(third) <= _ON_HORIZON * np.abs(terms).sum(axis=1), 0.0, third)
