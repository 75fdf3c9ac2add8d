"""``surveillance hold``: take a camera from the control loop, or give it back."""

from __future__ import annotations

from typing import Annotated

import typer

from factored_pomdp.commands.answers import AsJson, Refused, answer, side_console
from surveillance_domain.commands.one_camera import described_camera
from surveillance_domain.commands.options import SiteName, input_checked
from surveillance_domain.commands.watch_state import state_of

__all__ = ["hold"]


def hold(
    site: SiteName,
    camera: Annotated[str, typer.Argument(metavar="CAMERA", help="One of the site's cameras.")],
    release: Annotated[bool, typer.Option("--release", help="Give it back.")] = False,
    as_json: AsJson = False,
) -> None:
    """Hold a camera: from the next step on it gets no commands, until it is released; what it sees still counts.

    It is held by its address: every site file that names the camera leaves it alone.
    """
    from surveillance_domain.control.disk import said
    from surveillance_domain.site.load import load_site

    with input_checked():
        found = load_site(site)
    described_camera(found, camera)
    state = state_of(found)
    try:
        state.hold(camera, not release)
    except OSError as problem:
        raise Refused(f"{camera} cannot be {'released' if release else 'held'}: {said(problem)}") from None
    heeded = state.heeded(camera)
    held = sorted(state.held())
    told = f"{camera} is {'released' if release else 'held'}."
    if heeded:
        effect = "A run of this camera heeds it from its next step on."
    else:
        effect = (
            f"No run is there to heed it: none of this camera with this state folder, {state.root}. "
            "It is kept there for the next one."
        )
    rest = f"Held at {found.name}: {', '.join(held)}." if held else f"No camera of {found.name} is held."
    content = {"site": found.name, "camera": camera, "held": held, "heeded": heeded, "state_folder": str(state.root)}
    answer(content, [told, effect, rest], as_json=as_json)
    if as_json and not heeded:
        side_console().print(f"warning: {effect}", soft_wrap=True)
