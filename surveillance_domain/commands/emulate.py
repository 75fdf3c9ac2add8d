"""``surveillance emulate``: the cameras of a site, emulated on loopback, for people to try their own software on."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from factored_pomdp.commands.answers import AsJson, InputError, answer, side_console, table
from surveillance_domain.commands.options import Seed, SiteName, Truth, TruthChoice, input_checked

__all__ = ["emulate"]


def emulate(
    site: SiteName,
    targets: Annotated[int, typer.Option(min=1, max=50, help="How many move there.")] = 3,
    port: Annotated[int, typer.Option(min=0, max=65_000, help="Of the first camera; 0: any that are free.")] = 0,
    floor_markers: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV or JSON: marker, x_m, y_m; height_m: markers that lie there."),
    ] = None,
    site_out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="A new site file that leads to them, for all commands of real cameras."),
    ] = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CAMERA:KIND[=VALUE][@SECONDS[-SECONDS]]",
            help="What goes wrong, from when to when: north:latency_s=2@30-60, north:joystick@20; may be repeated.",
        ),
    ] = None,
    seconds: Annotated[float, typer.Option(min=0, help="How long; 0: until Ctrl-C.")] = 0,
    seed: Seed = 0,
    truth: TruthChoice = Truth.continuous,
    as_json: AsJson = False,
) -> None:
    """Start the emulated cameras of a site and print their addresses; Ctrl-C ends them.

    Kinds of faults: latency_s, drop_share, unavailable_share, wrong_password, frozen, pan_drift_deg_per_s,
    pan_slip_deg, truncated_picture, garbled_picture, reboot_in_move, reboot; and people who move a camera: joystick
    (degrees a second), guard_tour (seconds at each preset).
    """
    import numpy as np

    from surveillance_domain.cameras.clock import RealClock
    from surveillance_domain.commands.emulated_site_file import PASSWORD_ENV, check_new_file, write_site_file
    from surveillance_domain.commands.options import truth_kind
    from surveillance_domain.commands.stopping import until_stopped
    from surveillance_domain.emulation.fault_plan import read_plan
    from surveillance_domain.emulation.practice import Practice, practised
    from surveillance_domain.emulation.site import PASSWORD, USERNAME, EmulatedSite
    from surveillance_domain.model.views import build_views
    from surveillance_domain.site.load import load_site
    from surveillance_domain.vision.point_files import read_markers

    if site_out is not None:
        check_new_file(site_out)
    with input_checked():
        found = load_site(site)
        build_views(found)
        plan = read_plan(fault or [], [camera.name for camera in found.cameras])
        laid = () if floor_markers is None else tuple(read_markers(floor_markers).values())
        if laid and found.markers is None:
            raise InputError(f"site {found.name}: --floor-markers needs a [markers] table in the site file")
    clock = RealClock()
    try:
        emulated = EmulatedSite(
            found, targets, clock, np.random.default_rng(seed), truth_kind(truth), first_port=port, laid=laid
        )
    except OSError as problem:
        raise InputError(f"--port {port}: {(problem.strerror or str(problem)).lower()}; give another, or 0") from None
    except ValueError as problem:
        raise InputError(str(problem)) from None
    except ModuleNotFoundError as problem:
        if problem.name != "cv2":
            raise
        raise InputError("emulated cameras need OpenCV: pip install 'factored-pomdp[vision]'") from None
    with emulated:
        cameras = [{"name": name, "url": server.url} for name, server in emulated.servers.items()]
        shown = table("camera", "url", "picture")
        for camera in cameras:
            shown.add_row(camera["name"], camera["url"], f"{camera['url']}/axis-cgi/jpg/image.cgi")
        content = {"site": found.name, "targets": targets, "username": USERNAME, "password": PASSWORD}
        answer({**content, "cameras": cameras}, [shown, f"User {USERNAME}, password {PASSWORD}."], as_json=as_json)
        if site_out is not None:
            with input_checked():
                urls = {camera["name"]: camera["url"] for camera in cameras}
                write_site_file(found, urls, USERNAME, site_out)
            side_console().print(f"Written: {site_out}. First: export {PASSWORD_ENV}={PASSWORD}", soft_wrap=True)
        console = side_console()
        if not seconds:
            console.print("Ctrl-C ends them.")
        with practised(Practice(emulated, plan), clock, lambda told: console.print(told, soft_wrap=True, markup=False)):
            until_stopped(seconds or None)
