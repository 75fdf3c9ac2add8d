"""A headless Chromium, driven as a person drives it, and what its console said."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

__all__ = ["Browser", "headless_chromium"]

_FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--window-size=1366,800",
)
_DEEP = """
const found = [];
const walk = root => {
  for (const one of root.querySelectorAll('*')) {
    if (one.matches(arguments[0])) found.push(one);
    if (one.shadowRoot) walk(one.shadowRoot);
  }
};
walk(document);
"""


@dataclass
class Browser:
    """A browser with one page open."""

    driver: Any

    def open(self, url: str) -> None:
        self.driver.get(url)

    def run(self, script: str, *arguments: object) -> Any:
        """What a script returns."""
        return self.driver.execute_script(script, *arguments)

    def deep(self, selector: str) -> list[Any]:
        """Elements by CSS selector, inside of widgets too."""
        return list(self.run(_DEEP + "return found", selector))

    def texts(self, selector: str) -> list[str]:
        """The text of all such elements that can be seen, at one moment."""
        seen = "return found.filter(one => one.getClientRects().length).map(one => one.innerText)"
        return list(self.run(_DEEP + seen, selector))

    def text(self, selector: str) -> str:
        """The same, in one."""
        return "\n".join(self.texts(selector))

    def wait(self, condition: Callable[[], object], seconds: float = 12.0) -> None:
        """Until something is so."""
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                pytest.fail(f"not so after {seconds} s; the page says: {self.text('dl, .row, body')[:2000]}")
            time.sleep(0.05)

    def size(self, width: int, height: int, mobile: bool = False) -> None:
        """The size of the window, in its own pixels."""
        wanted = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", wanted)

    def complaints(self) -> list[str]:
        """Errors and warnings of the console since the last time."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]


@contextmanager
def headless_chromium(profile: Path) -> Iterator[Browser]:
    """A fresh browser; the test is skipped where there is none."""
    selenium = pytest.importorskip("selenium.webdriver")
    browser, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if browser is None or driver is None:
        pytest.skip("no chromium and chromedriver here: sudo apt-get install chromium chromium-driver")
    options = selenium.ChromeOptions()
    options.binary_location = browser
    for flag in (*_FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    running = selenium.Chrome(options=options, service=selenium.ChromeService(driver))
    try:
        yield Browser(running)
    finally:
        running.quit()
