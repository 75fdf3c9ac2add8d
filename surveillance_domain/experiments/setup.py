"""What is simulated: a site, how many targets, what differs from the site file; small enough to send to a worker."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from surveillance_domain.experiments.runs import TruthKind, prepared_run
from surveillance_domain.model.build import Surveillance, surveillance_model
from surveillance_domain.site.load import load_site
from surveillance_domain.site.site import Site

__all__ = ["Case", "Setup", "check_setup", "site_of", "surveillance_of"]


@dataclass(frozen=True)
class Setup:
    """A site with targets.

    Attributes
    ----------
    site : str
        A built-in site or the path of a site file.
    targets : int
    detection_probability, cell_noise_m : float, optional
        Instead of what the site says of its cameras.
    static_kappa : float, optional
        Instead of κ in the noise σ₀ + κ · distance of all static cameras.
    """

    site: str
    targets: int
    detection_probability: float | None = None
    cell_noise_m: float | None = None
    static_kappa: float | None = None


@dataclass(frozen=True)
class Case:
    """A setup under one controller; its runs are numbered from 0.

    Attributes
    ----------
    setup : Setup
    controller : str
        One of `surveillance_domain.experiments.variants.VARIANTS`.
    truth : {"grid", "continuous"}
    steps, seed : int
    """

    setup: Setup
    controller: str
    truth: TruthKind
    steps: int
    seed: int


def site_of(setup: Setup) -> Site:
    """The site as the setup wants it.

    Raises
    ------
    SiteError
        With every fault of the site file, or naming the option that is out of its range.
    """
    site = load_site(setup.site).with_overrides(setup.detection_probability, setup.cell_noise_m)
    if setup.static_kappa is None:
        return site
    changed = [one.model_copy(update={"noise_m": (one.noise_m[0], setup.static_kappa)}) for one in site.static_cameras]
    return replace(site, static_cameras=tuple(changed))


@lru_cache(maxsize=4)
def surveillance_of(setup: Setup) -> Surveillance:
    """The model of a setup; the last few are kept.

    Raises
    ------
    SiteError, ValueError
        As `site_of` and `surveillance_model` do.
    """
    return surveillance_model(site_of(setup), setup.targets)


def check_setup(setup: Setup, controllers: tuple[str, ...]) -> Site:
    """The site, once every controller is known to run on it; found out with one target and one step.

    Raises
    ------
    SiteError, ValueError
        Saying what is wrong with the site, or what a controller lacks there.
    """
    surveillance = surveillance_of(replace(setup, targets=1))
    for controller in controllers:
        prepared_run(surveillance, controller, 1, 0, 0)
    return surveillance.site
