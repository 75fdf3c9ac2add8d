"""A file of trajectories, read and cleaned."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from surveillance_domain.trajectories.cleaning import Limits, cleaned
from surveillance_domain.trajectories.conventions import Conventions, with_sidecar
from surveillance_domain.trajectories.formats import read_rows
from surveillance_domain.trajectories.tracks import Tracks

__all__ = ["load_tracks"]


def load_tracks(
    path: Path | str,
    given: Conventions | None = None,
    limits: Limits | None = None,
    advance: Callable[[int, str], object] | None = None,
) -> Tracks:
    """Tracks in metres and seconds.

    Parameters
    ----------
    path : path
        A file in one of the forms that `surveillance_domain.trajectories.formats` names.
    given : Conventions, optional
        Goes before what the file's sidecar says.
    limits : Limits, optional
    advance : callable, optional
        Told how many more bytes have been read, and what is being done.

    Raises
    ------
    TrajectoryError
        With everything that is wrong with the file or its sidecar.
    """
    path = Path(path)
    conventions = with_sidecar(path, given or Conventions())
    told = advance or (lambda amount, doing: None)
    reading = f"reading {path.name}"
    rows = read_rows(path, conventions.form, conventions.columns, lambda amount: told(amount, reading))
    told(0, f"finding tracks in {path.name}")
    return cleaned(rows, conventions, limits or Limits(), str(path))
