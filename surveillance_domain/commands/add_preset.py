"""``surveillance add-preset``: what a camera sees now becomes one of its presets."""

from __future__ import annotations

from typing import Annotated

import typer

from factored_pomdp.commands.answers import AsJson, InputError, answer
from surveillance_domain.commands.options import SiteName, input_checked

__all__ = ["add_preset"]


def add_preset(
    site: SiteName,
    camera: Annotated[str, typer.Argument(metavar="CAMERA", help="One of the site's cameras, which must have a url.")],
    name: Annotated[str, typer.Argument(metavar="NAME", help="Of the new preset.")],
    as_json: AsJson = False,
) -> None:
    """Ask a camera where it looks, and write that into the site file as a new preset; the camera is not moved."""
    from surveillance_domain.commands.one_camera import described_camera, opened_camera, standing_position
    from surveillance_domain.model.views import build_views
    from surveillance_domain.site import editing
    from surveillance_domain.site.load import load_site
    from surveillance_domain.vision.ground import preset_at

    with input_checked():
        found = load_site(site)
        path = editing.editable_path(found)
    description = described_camera(found, camera)
    if name in [preset.name for preset in description.presets]:
        raise InputError(f"camera {camera!r} has a preset {name!r} already; give another name")
    _check_name(name)
    with opened_camera(found, description) as driver:
        position = standing_position(driver, description)
    standing = preset_at(description, position)
    if standing is not None:
        raise InputError(
            f"camera {camera!r} stands at its preset {standing.name!r}: turn it to where {name!r} is to be, "
            "and try again"
        )
    if position.zoom is None:
        raise InputError(f"camera {camera!r} does not tell its zoom; write the preset into {path} by hand")
    preset = {"name": name, "pan": position.pan, "tilt": position.tilt, "zoom": position.zoom}
    with input_checked((ValueError, OSError)), editing.edited_site(path, build_views) as document:
        editing.add_preset(document, camera, preset)
    content = {"site": found.name, "camera": camera, "preset": preset, "written": str(path)}
    where = f"pan {position.pan:g}, tilt {position.tilt:g}, zoom {position.zoom:g}"
    answer(content, [f"Preset {name!r} of camera {camera!r}: {where}. Written: {path}"], as_json=as_json)


def _check_name(name: str) -> None:
    """The same names that a site file may have."""
    from pydantic import TypeAdapter, ValidationError

    from surveillance_domain.site.camera import Preset
    from surveillance_domain.site.fields import Name

    try:
        TypeAdapter(Name).validate_python(name)
    except ValidationError:
        raise InputError(f"NAME: found {name!r}; expected {Preset.model_fields['name'].description}") from None
