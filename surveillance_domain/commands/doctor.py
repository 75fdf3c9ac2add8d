"""``surveillance doctor``: what is wrong with the cameras of a site, and what would mend it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import AsJson, InputError, answer, table
from surveillance_domain.commands.options import SiteName, input_checked
from surveillance_domain.commands.watch_state import alone, state_of

if TYPE_CHECKING:
    from surveillance_domain.cameras.clock import Clock
    from surveillance_domain.cameras.vapix import VapixCamera
    from surveillance_domain.site.site import Site
    from surveillance_domain.world.doctor import Check

__all__ = ["doctor"]


def doctor(
    site: SiteName,
    no_move: Annotated[bool, typer.Option("--no-move", help="Turn no camera; also while the site is run.")] = False,
    emulated: Annotated[bool, typer.Option("--emulated", help="Examine emulated cameras.")] = False,
    floor_markers: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV or JSON: marker, x_m, y_m; height_m: markers at known places."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check every camera: reachability, log-in, limits, pictures, markers, calibration, a move; exit code 1 if ill.

    Points that calibrate --write kept are looked for again: pan drifts.
    """
    from concurrent.futures import ThreadPoolExecutor

    from surveillance_domain.model.views import build_views
    from surveillance_domain.site.load import load_site
    from surveillance_domain.vision.calibration_file import calibration_path, read_calibrations
    from surveillance_domain.vision.opencv import VisionMissing, opencv
    from surveillance_domain.vision.point_files import read_markers
    from surveillance_domain.world.doctor import Examination

    with input_checked((ValueError, VisionMissing)):
        found = load_site(site)
        views = build_views(found)
        markers = None if floor_markers is None else read_markers(floor_markers)
        kept = {} if emulated or found.path is None else read_calibrations(calibration_path(found.path))
        if markers is not None and found.markers is None:
            raise InputError(f"site {found.name}: --floor-markers needs a [markers] table in the site file")
        opencv()
    state = state_of(found)
    with ExitStack() as stack:
        if not no_move and not emulated:
            stack.enter_context(alone(state))
        examined, cameras, clock = stack.enter_context(_cameras(found, emulated))
        memories = {} if emulated else state.memories()
        examination = Examination(examined, views, clock, not no_move, markers, calibrated=kept, memories=memories)
        held = frozenset() if emulated else state.held()
        tasks = [partial(examination.of, camera, camera.name in held) for camera in cameras]
        with ThreadPoolExecutor(len(tasks)) as pool:
            checks = [done.result() for done in clock.together(pool, tasks)]
    content = _content(found, cameras, checks)
    answer(content, [_shown(content)], as_json=as_json)
    if not all(check.ok for one in checks for check in one):
        raise typer.Exit(1)


@contextmanager
def _cameras(site: Site, emulated: bool) -> Iterator[tuple[Site, Sequence[VapixCamera], Clock]]:
    """The site as its cameras are spoken with, their drivers, and their clock."""
    import numpy as np

    from surveillance_domain.cameras.clock import RealClock
    from surveillance_domain.commands.network import opened

    clock, luck = RealClock(), np.random.default_rng()
    with ExitStack() as stack:
        found = site
        if emulated:
            from surveillance_domain.emulation.site import EmulatedSite

            emulation = stack.enter_context(EmulatedSite(site, 1, clock, luck))
            found, cameras = emulation.site, emulation.open_cameras(luck)
        else:
            cameras = opened(site, clock, luck)
        for camera in cameras:
            stack.callback(camera.close)
        yield found, cameras, clock


def _content(site: Site, cameras: Sequence[VapixCamera], checks: Sequence[Sequence[Check]]) -> dict[str, Any]:
    return {
        "site": site.name,
        "cameras": [
            {"name": camera.name, "checks": [{"name": c.name, "ok": c.ok, "detail": c.detail} for c in found]}
            for camera, found in zip(cameras, checks, strict=True)
        ],
    }


def _shown(content: dict[str, Any]) -> Any:
    rows = table("camera", "check", "", "found")
    for camera in content["cameras"]:
        for number, check in enumerate(camera["checks"]):
            name = camera["name"] if not number else ""
            rows.add_row(name, check["name"], "ok" if check["ok"] else "WRONG", check["detail"])
    return rows
