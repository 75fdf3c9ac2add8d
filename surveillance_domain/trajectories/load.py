"""A file of trajectories, read and cleaned."""

from __future__ import annotations

from pathlib import Path

from surveillance_domain.trajectories.cleaning import Limits, cleaned
from surveillance_domain.trajectories.conventions import Conventions, with_sidecar
from surveillance_domain.trajectories.formats import read_rows
from surveillance_domain.trajectories.tracks import Tracks

__all__ = ["load_tracks"]


def load_tracks(path: Path | str, given: Conventions | None = None, limits: Limits | None = None) -> Tracks:
    """Tracks in metres and seconds.

    Parameters
    ----------
    path : path
        A file in one of the forms that `surveillance_domain.trajectories.formats` names.
    given : Conventions, optional
        Goes before what the file's sidecar says.
    limits : Limits, optional

    Raises
    ------
    TrajectoryError
        With everything that is wrong with the file or its sidecar.
    """
    path = Path(path)
    conventions = with_sidecar(path, given or Conventions())
    rows = read_rows(path, conventions.form, conventions.columns)
    return cleaned(rows, conventions, limits or Limits(), str(path))
