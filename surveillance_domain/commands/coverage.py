"""``surveillance coverage``: what every preset of every camera sees, as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, AsJson, InputError, answer, checked_output, table
from surveillance_domain.commands.options import SiteName, input_checked

__all__ = ["coverage"]


def coverage(
    site: SiteName,
    out: Annotated[Path, typer.Option(metavar="PNG", help="The picture; an SVG is written beside it.")],
    as_json: AsJson = False,
) -> None:
    """Draw the map, its obstacles, and the field of view of every preset."""
    import numpy as np

    from factored_pomdp.provenance import provenance
    from surveillance_domain.model.coverage import best_joint_coverage
    from surveillance_domain.model.views import build_views
    from surveillance_domain.pictures.coverage import draw_coverage
    from surveillance_domain.pictures.style import save_figure
    from surveillance_domain.site.load import load_site

    if out.suffix.lower() not in (".png", ".svg") or out.is_dir():
        raise InputError(f"--out {out}: expected the name of a file that ends in .png")
    checked_output("--out", out)
    with input_checked():
        found = load_site(site)
        views = build_views(found)
    written = save_figure(draw_coverage(found, views), out)
    best, method = best_joint_coverage(views)
    joint = float(np.mean(views.seen(best) > 0))
    union = float(np.mean(np.any([np.any(one > 0, axis=0) for one in views.detection], axis=0)))
    shown = table("camera", "preset", "cells", "of the floor", right=["cells", "of the floor"])
    cameras: list[dict[str, Any]] = []
    for camera, detection in zip(found.cameras, views.detection, strict=True):
        counts = (detection > 0).sum(axis=1).tolist()
        pairs = list(zip((preset.name for preset in camera.presets), counts, strict=True))
        presets = [{"name": name, "cells": cells, "share": cells / found.grid.size} for name, cells in pairs]
        cameras.append({"name": camera.name, "presets": presets})
        for name, cells in pairs:
            shown.add_row(camera.name, name, f"{cells:,}", f"{cells / found.grid.size:.1%}")
    chosen = {c.name: c.presets[preset].name for c, preset in zip(found.cameras, best, strict=True)}
    carried = provenance(COMMAND_LINE.get(), {found.name: f"sha256:{found.digest}"})
    content = {
        "site": found.name,
        "free_cells": found.grid.size,
        "cameras": cameras,
        "joint_preset": {"presets": chosen, "share": joint, "proved_best": method == "the best"},
        "all_presets_share": union,
        "written": [str(path) for path in written],
        **carried,
        "provenance": carried,
    }
    lines = [
        f"{method.capitalize()} joint preset sees {joint:.1%} of {found.grid.size:,} free cells, all see {union:.1%}.",
        f"Written: {written[0]} and {written[1]}",
    ]
    answer(content, [shown, *lines], as_json=as_json)
