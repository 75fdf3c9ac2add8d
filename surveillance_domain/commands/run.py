"""``surveillance run``: the control loop on real cameras, or on emulated ones."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, AsJson, InputError, answer, side_console, table
from surveillance_domain.commands.live_page import Page, PageAddress, PageOrigin, PagePort
from surveillance_domain.commands.options import Progress, Seed, SiteName, input_checked
from surveillance_domain.commands.watch_state import alone, state_of

if TYPE_CHECKING:
    from rich.console import RenderableType

    from surveillance_domain.control.base import Controller
    from surveillance_domain.control.record import RecordWriter
    from surveillance_domain.control.watch import Alert
    from surveillance_domain.model.build import Surveillance
    from surveillance_domain.site.site import Site
    from surveillance_domain.world.network import NetworkWorld

__all__ = ["run"]

_START_S = 10.0
_SELDOM_S = 5.0
_OFTEN = 0.02
"""Of target-steps: beliefs started anew more often than that are worth a word."""
_CONTRADICTED = (
    "Sightings contradict the model often: are detection_probability and cell_noise_m those of these cameras, and can "
    'people move as they do by speeds_mps and the sigmas of [targets]? See "how well they see" in run-your-cameras.'
)


def run(
    site: SiteName,
    targets: Annotated[
        int | None, typer.Option(min=1, help="How many; if left out, as many as the site knows by name, or 1.")
    ] = None,
    steps: Annotated[int | None, typer.Option(min=1, help="How many; if left out, until stopped.")] = None,
    until: Annotated[str | None, typer.Option(metavar="HH:MM", help="Stop at this local time.")] = None,
    controller: Annotated[str | None, typer.Option(help="If left out, the site's.")] = None,
    emulated: Annotated[bool, typer.Option("--emulated", help="Emulated cameras on loopback.")] = False,
    fast: Annotated[bool, typer.Option("--fast", help="Emulated cameras in virtual time.")] = False,
    pictures: Annotated[
        bool, typer.Option("--pictures/--no-pictures", help="Emulated: find targets in pictures, or draw detections.")
    ] = True,
    strangers: Annotated[
        int, typer.Option(min=0, help="Emulated: so many more move there that the site does not know.")
    ] = 0,
    shadow: Annotated[bool, typer.Option("--shadow", help="Decide and record, but never move a camera.")] = False,
    park: Annotated[bool, typer.Option("--park", help="Send cameras home at the end; SIGTERM does so always.")] = False,
    record: Annotated[Path | None, typer.Option(metavar="DIR", help="Folder for the record.")] = None,
    page: Page = False,
    page_port: PagePort = None,
    page_address: PageAddress = None,
    page_origin: PageOrigin = None,
    seed: Seed = 0,
    progress: Progress = None,
    as_json: AsJson = False,
) -> None:
    """Run the cameras of a site: choose presets, turn cameras, look, learn; until stopped."""
    import signal

    from surveillance_domain.commands.stopping import stop_when_asked

    with ExitStack() as stack:
        stop = stack.enter_context(stop_when_asked())  # before anything that takes long

        from surveillance_domain.commands.compiled_loops import kept_if_possible

        stack.enter_context(kept_if_possible())

        from surveillance_domain.commands.live_page import live_page, page_request
        from surveillance_domain.commands.network import network_of
        from surveillance_domain.commands.run_record import closed_record, missing_steps, summed_up, telling_of
        from surveillance_domain.commands.service_manager import ALIVE, READY, STOPPING, notify
        from surveillance_domain.control.watch import Watch
        from surveillance_domain.site.load import load_site
        from surveillance_domain.vision.opencv import VisionMissing

        _refuse_mixture(emulated, {"--fast": fast, "--no-pictures": not pictures, "--strangers": strangers > 0})
        asked = page_request(page, page_port, page_address, page_origin)
        if shadow and park:
            raise InputError("--shadow never moves a camera, and --park does: leave one of them out")
        with input_checked():
            found = load_site(site)
        number = targets if targets is not None else max(1, len(found.targets.known))
        ends = None if until is None else _moment(until)
        state = state_of(found)
        commands = not shadow and not emulated
        if commands:
            stack.enter_context(alone(state))
        stack.enter_context(state.heeding())
        with input_checked((ValueError, VisionMissing)):
            network = stack.enter_context(
                network_of(
                    found,
                    number,
                    emulated=emulated,
                    seed=seed,
                    virtual=fast,
                    pictures=pictures,
                    strangers=strangers,
                    held=state.held,
                    moves=not shadow,
                    memories=state.memories() if commands else None,
                )
            )
        chosen = controller or found.control.controller
        acting = _controller(chosen, network.surveillance)
        if not stop.asked:
            _start(network.world)
        alert = _alert(found)
        written = None
        if record is not None:
            written = _record(record, found, network.surveillance, chosen, seed, emulated, fast)
            alert = telling_of(record, alert)
        watch = Watch(network.world, acting, written, network.truth, alert)
        stack.enter_context(closed_record(watch))
        tell = _teller(watch, found, steps, progress)
        show = stack.enter_context(live_page(asked, watch, network, state, chosen))
        for step in () if stop.asked else watch.turns():
            notify(*((READY, ALIVE) if step.number == 1 else (ALIVE,)))  # only after the first step all is compiled
            tell()
            show(step)
            if steps is not None and step.number >= steps:
                watch.end("steps", f"all {steps:,} steps done")
                break
            if stop.asked:
                break
            if ends is not None and datetime.now() >= ends:
                watch.end("until", f"--until {until}")
                break
        notify(STOPPING)
        watch.end("stopped", f"stopped by {'Ctrl-C' if stop.signal is signal.SIGINT else 'SIGTERM'}")
        homeward = park or (stop.signal is signal.SIGTERM and not shadow)
        parked = {name: one.told for name, one in network.world.park().items()} if homeward else {}
        content = _content(summed_up(watch, written), found, network.surveillance, chosen, seed, parked)
    missing = missing_steps(content, record)
    answer(content, _shown(content, missing), as_json=as_json)
    if content["blind"]:
        side_console().print(f"no camera gave a view: {_reasons(network.world)}", soft_wrap=True)
    if content["blind"] or missing:
        raise typer.Exit(1)


def _refuse_mixture(emulated: bool, options: Mapping[str, bool]) -> None:
    given = [name for name, is_given in options.items() if is_given]
    if given and not emulated:
        raise InputError(f"{', '.join(given)}: for emulated cameras only; add --emulated")


def _moment(until: str) -> datetime:
    """The next time that the clock on the wall shows it."""
    try:
        at = datetime.strptime(until, "%H:%M").time()
    except ValueError:
        raise InputError(f"--until {until}: expected a time of day such as 06:00") from None
    now = datetime.now()
    today = datetime.combine(now.date(), at)
    return today if today > now else today + timedelta(days=1)


def _controller(name: str, surveillance: Surveillance) -> Controller:
    from surveillance_domain.control.factory import Setting, make_controller

    try:
        return make_controller(name, surveillance, Setting(open_roster=True))
    except ValueError as problem:
        raise InputError(f"--controller {name}: {problem}") from None


def _start(world: NetworkWorld) -> None:
    """Get to know the cameras; one that is away is only told of, for it may return."""
    from surveillance_domain.cameras.errors import OutsideLimits

    faults = world.start(_START_S)
    clamped = [str(fault) for fault in faults.values() if isinstance(fault, OutsideLimits)]
    if clamped:
        raise InputError("\n".join(clamped))
    for fault in faults.values():
        side_console().print(f"warning: {fault}", soft_wrap=True)


def _record(
    folder: Path, site: Site, surveillance: Surveillance, controller: str, seed: int, emulated: bool, virtual: bool
) -> RecordWriter:
    from factored_pomdp.provenance import provenance
    from surveillance_domain.commands.run_record import begun_record

    header = {
        "site": site.name,
        "site_path": None if site.path is None else str(site.path),
        "targets": list(surveillance.targets),
        "controller": controller,
        "step_s": site.control.step_s,
        "emulated": emulated,
        "virtual": virtual,
        **provenance(COMMAND_LINE.get(), {site.name: f"sha256:{site.digest}"}, seed),
    }
    return begun_record(folder, header, site.operation.keep_days)


def _alert(site: Site) -> Alert | None:
    command = site.operation.alert_command
    if command is None:
        return None
    from surveillance_domain.commands.alerting import alerter
    from surveillance_domain.page.door import TOKEN_VARIABLE

    secrets = [TOKEN_VARIABLE, *(camera.password_env for camera in site.cameras if camera.password_env)]
    try:
        return alerter(command, site.name, secrets)
    except ValueError as problem:
        raise InputError(
            f"site {site.name}: operation.alert_command: found {command}, which is no command ({problem})"
        ) from None


def _teller(watch: Any, site: Site, steps: int | None, wanted: bool | None) -> Callable[[], None]:
    """A line every few seconds on standard error, on a terminal or where it is asked for."""
    import time

    console = side_console()
    told = -math.inf

    def tell() -> None:
        nonlocal told
        now = time.monotonic()
        if wanted is False or not (wanted or console.is_terminal) or now - told < _SELDOM_S:
            return
        told = now
        found = watch.summary()
        of = f" of {steps}" if steps is not None else ""
        share = "" if found["percent_obs"] is None else f", PercentObs {found['percent_obs']:.1f} %"
        away = [camera["name"] for camera in found["cameras"] if camera["state"] != "ready"]
        missing = f", not taking part: {', '.join(away)}" if away else ""
        console.print(f"{site.name}: step {found['steps']}{of}, {found['seen']:.2f} seen a step{share}{missing}")

    return tell


def _content(
    summary: Mapping[str, Any],
    site: Site,
    surveillance: Surveillance,
    controller: str,
    seed: int,
    parked: Mapping[str, str],
) -> dict[str, Any]:
    from factored_pomdp.provenance import provenance

    found, steps = summary["percent_obs"], summary["steps"]
    return {
        "site": site.name,
        "controller": controller,
        "targets": len(surveillance.targets),
        "runs": 1,
        **summary,
        "percent_obs": None if found is None else {"mean": found, "ci95": [None, None], "per_run": [found]},
        "blind": steps > 0 and all(camera["failures"] == steps for camera in summary["cameras"]),
        "parked": dict(parked),
        **provenance(COMMAND_LINE.get(), {site.name: f"sha256:{site.digest}"}, seed),
    }


def _reasons(world: NetworkWorld) -> str:
    """What went wrong with each camera in the last step."""
    return "; ".join(
        f"{name}: {one.because or 'it looks at none of its presets'}" for name, one in world.reports.items()
    )


def _shown(content: Mapping[str, Any], missing: str) -> list[RenderableType]:
    rows = table("run", "found", right=["found"])
    for key in ("site", "controller", "targets", "steps"):
        rows.add_row(key, str(content[key]))
    rows.add_row("beliefs started anew", str(content["restarts"]))
    if content["percent_obs"] is not None:
        rows.add_row("PercentObs", f"{content['percent_obs']['mean']:.2f} %")
    if content["steps"]:
        rows.add_row("targets seen a step", f"{content['seen']:.3f}")
        rows.add_row("of them beyond the views of the model", f"{content['seen_beyond']:.3f}")
        rows.add_row("expected", f"{content['expected_observed']:.3f}")
        rows.add_row("time of a decision, median", f"{content['decision_ms']['median']:.3f} ms")
        rows.add_row("detections without identity, not used", str(content["without_identity"]))
        rows.add_row("detections on no free cell, not used", str(content["out_of_view"]))
    if content["roster"]:
        rows.add_row("targets that came, that went", f"{content['roster']['started']}, {content['roster']['ended']}")
    cameras = table("camera", "state", "steps without a view", *(["parked"] if content["parked"] else []))
    for camera in content["cameras"]:
        parked = [content["parked"][camera["name"]]] if content["parked"] else []
        cameras.add_row(camera["name"], camera["state"], str(camera["failures"]), *parked)
    closing = ["No camera gave a view in any step: nothing was watched."] if content["blind"] else []
    closing += [f"{missing}."] if missing else []
    if content["restarts"] > _OFTEN * content["steps"] * content["targets"]:
        closing.append(_CONTRADICTED)
    return [rows, cameras, *closing]
