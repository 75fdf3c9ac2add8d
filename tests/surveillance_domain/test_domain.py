"""The plugin as `factored_pomdp.domain` meets it: options, overrides, and one clear message for what is wrong."""

from __future__ import annotations

import numpy as np
import pytest

import factored_pomdp as fp


@pytest.mark.example
def test_the_domain_is_installed_and_takes_options_as_text():
    model = fp.domain("surveillance", site="tiny-3", targets="3")
    assert model.name == "surveillance of tiny-3 with 3 targets"
    assert model.joint_states == 419_904


@pytest.mark.example
def test_without_options_it_is_tiny_with_two_targets():
    assert fp.domain("surveillance").joint_states == 230_400


@pytest.mark.example
def test_overrides_reach_every_camera():
    """A cell that one preset sees: 0.8 of the detections, spread over the cells in the kernel's reach."""
    plain = fp.domain("surveillance", site="micro", targets=1)
    blurred = fp.domain("surveillance", site="micro", targets=1, detection_probability=0.75, cell_noise_m="0.5")
    given = {"west.preset.next": "near", "east.preset.next": "near", "target1.location.next": (0, 0)}
    sighting = plain.variable("target1.sighting")
    exact, spread = (
        model.observation["target1.sighting"].condition(given).array_over([sighting]) for model in (plain, blurred)
    )
    assert exact.tolist() == [1, 0, 0, 0, 0]
    assert spread[-1] == pytest.approx(0.25)
    assert (spread[:4] > 0).all()
    assert spread[0] == max(spread[:4])
    assert np.isclose(spread.sum(), 1)


@pytest.mark.example
@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"site": "nosuch"}, r"nosuch: found no such file; expected .* built-in sites corridor, .*, tiny"),
        ({"site": "hal"}, r"did you mean hall"),
        ({"targets": 0}, r"targets=0: expected 1 to 100,000"),
        ({"targets": 10**9}, r"targets=1000000000: expected 1 to 100,000"),
        ({"targets": -1}, r"targets=-1: expected 1 to 100,000"),
        ({"targets": "two"}, r"targets=two: .*integer"),
        ({"targets": 1.5}, r"targets=1.5: .*integer"),
        ({"detection_probability": 1.5}, r"detection_probability: found 1.5; expected a probability, 0 to 1"),
        ({"detection_probability": "nan"}, r"detection_probability: found nan; expected a probability, 0 to 1"),
        ({"cell_noise_m": -1}, r"cell_noise_m: found -1.0; expected metres, 0 or more"),
        ({"target": 2}, r"no option 'target' \(did you mean 'targets'\?\)"),
    ],
    ids=str,
)
def test_bad_options_give_one_message(options, said):
    with pytest.raises(ValueError, match=said):
        fp.domain("surveillance", **options)


@pytest.mark.example
def test_both_overrides_are_told_at_once():
    with pytest.raises(ValueError, match=r"(?s)detection_probability: found 2.0.*cell_noise_m: found -3.0") as told:
        fp.domain("surveillance", site="tiny", detection_probability=2, cell_noise_m=-3)
    assert str(told.value).count("detection_probability") == 1
