"""What a record was made with: its site and its model, if they are still what they were."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import InputError

if TYPE_CHECKING:
    from surveillance_domain.model.build import Surveillance

__all__ = ["lines_of", "model_of"]


def lines_of(record: Path) -> Iterator[dict[str, Any]]:
    """Headers and steps of a record.

    Raises
    ------
    InputError
        Naming file and line.
    """
    from surveillance_domain.control.record import RecordError, read_record

    try:
        yield from read_record(record)
    except (RecordError, OSError) as problem:
        raise InputError(str(problem)) from None


def model_of(header: Mapping[str, Any]) -> Surveillance:
    """The model that a run was made with.

    Raises
    ------
    InputError
        If the site cannot be read any more, or is another one now.
    """
    from surveillance_domain.model.build import surveillance_model
    from surveillance_domain.site.load import load_site

    name = header["site_path"] or header["site"]
    try:
        site = load_site(name)
        surveillance = surveillance_model(site, len(header["targets"]))
    except ValueError as problem:
        raise InputError(f"the site of this record cannot be used: {problem}") from None
    if header["inputs"].get(header["site"]) != f"sha256:{site.digest}":
        raise InputError(f"{name} has been changed since this was recorded: expected the file as it was then")
    return surveillance
