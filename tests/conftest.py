"""Settings of the whole test run: hypothesis profiles, pictures without a screen, the three kinds of test."""

from __future__ import annotations

import os

import pytest
from hypothesis import HealthCheck, settings

os.environ.setdefault("MPLBACKEND", "Agg")

settings.register_profile("ci", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("explore", parent=settings.get_profile("ci"), derandomize=False, max_examples=1000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))

KINDS = ("example", "property", "end_to_end")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Count a notebook as an end-to-end test."""
    for item in items:
        if item.path.suffix == ".ipynb":
            item.add_marker(pytest.mark.end_to_end)


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Fail a test that does not say of which kind it is."""
    if not any(item.get_closest_marker(kind) for kind in KINDS):
        pytest.fail(f"{item.nodeid} has no kind: mark it with one of {', '.join(KINDS)}", pytrace=False)
