"""The plugin's entry point: the surveillance domain for `factored_pomdp.domain`."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from factored_pomdp.model import FactoredPOMDP

__all__ = ["surveillance"]


def surveillance(
    site: str = "tiny",
    targets: int = 2,
    detection_probability: float | None = None,
    cell_noise_m: float | None = None,
    discount: float = 1.0,
) -> FactoredPOMDP:
    """Pan/tilt/zoom cameras that watch moving targets which they cannot always see.

    Parameters
    ----------
    site : str
        A built-in site or the path of a site file.
    targets : int
    detection_probability, cell_noise_m : float, optional
        Override those of all cameras.
    discount : float
        Of rewards a step later; below 1 where a solver plans for ever.
    """
    from surveillance_domain.model.build import surveillance_model
    from surveillance_domain.site.load import load_site

    chosen = load_site(site).with_overrides(detection_probability, cell_noise_m)
    return surveillance_model(chosen, targets, discount).model
