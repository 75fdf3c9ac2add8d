"""Reading a site: a built-in one by name, or a site file."""

from __future__ import annotations

import difflib
import hashlib
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

from surveillance_domain.site.checks import check_fields
from surveillance_domain.site.faults import Fault, SiteError
from surveillance_domain.site.maps import build_grid
from surveillance_domain.site.places import check_places
from surveillance_domain.site.prior import read_prior
from surveillance_domain.site.site import Site
from surveillance_domain.site.validation import validate

__all__ = ["builtin_sites", "load_site"]

_MOST_BYTES = 10_000_000


def builtin_sites() -> tuple[str, ...]:
    """Names of the sites that ship with the package, in alphabetical order."""
    folder = resources.files("surveillance_domain.site") / "builtin"
    return tuple(sorted(entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml")))


def load_site(name_or_path: str | Path) -> Site:
    """Read a site by its built-in name (``"hall"``) or by the path of its TOML file.

    A symbolic link stands for the file that it points to: what a site file names lies beside that file.

    Raises
    ------
    SiteError
        With every fault of the file at once. Presets that see nothing are found by
        `surveillance_domain.model.views.build_views`.
    """
    if isinstance(name_or_path, str) and name_or_path in builtin_sites():
        content = (resources.files("surveillance_domain.site") / "builtin" / f"{name_or_path}.toml").read_bytes()
        return _parse(content, name_or_path, None, Path(), f"built-in site {name_or_path}")
    path = Path(name_or_path)
    content = _read(path)
    file = path.resolve() if path.is_symlink() else path
    return _parse(content, path.stem, file, file.parent, str(path))


def _read(path: Path) -> bytes:
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise SiteError(str(path), (Fault("", f"a file of {path.stat().st_size} bytes", "at most ten million"),))
        return path.read_bytes()
    except FileNotFoundError:
        near = difflib.get_close_matches(str(path), builtin_sites(), n=1)
        hint = f" (did you mean {near[0]}?)" if near else ""
        expected = f"the path of a site file, or one of the built-in sites {', '.join(builtin_sites())}{hint}"
        raise SiteError(str(path), (Fault("", "no such file", expected),)) from None
    except OSError as error:
        raise SiteError(
            str(path), (Fault("", (error.strerror or str(error)).lower(), "a readable site file"),)
        ) from None


def _parse(content: bytes, name: str, path: Path | None, folder: Path, source: str) -> Site:
    try:
        tables: dict[str, Any] = tomllib.loads(content.decode("utf-8"))
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise SiteError(source, (Fault(f"line {line}", "bytes that are not UTF-8", "a TOML file"),)) from None
    except tomllib.TOMLDecodeError as error:
        raise SiteError(source, (Fault("", f"text that is not TOML: {error}", "a TOML file"),)) from None
    file, faults = validate(tables)
    if file is None:
        raise SiteError(source, faults)
    faults = check_fields(file, folder)
    grid, inputs, map_faults = build_grid(file.map, folder)
    if grid is None:
        raise SiteError(source, faults + map_faults)
    prior, prior_content, prior_faults = read_prior(file.targets.prior, folder, grid)
    faults += check_places(file, grid) + prior_faults
    if faults:
        raise SiteError(source, faults)
    digest = hashlib.sha256()
    for part in (content, *inputs, *([prior_content] if prior is not None else [])):
        digest.update(len(part).to_bytes(8, "big"))
        digest.update(part)
    return Site(
        name=name,
        path=path,
        digest=digest.hexdigest(),
        grid=grid,
        targets=file.targets,
        control=file.control,
        cameras=file.cameras,
        static_cameras=file.static_cameras,
        operation=file.operation,
        privacy=file.privacy,
        markers=file.markers,
        prior=prior,
    )
