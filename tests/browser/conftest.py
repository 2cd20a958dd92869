"""A browser, where one is installed."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, sync_playwright

from app.web.auth.people import People

NAMES = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = [
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="module")  # not longer: its event loop would be running under everybody else's tests
def browser() -> Iterator[Browser]:
    """Chromium without a window; skips where there is none."""
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        pytest.skip("no Chromium is installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=OPTIONS)
        yield browser
        browser.close()


def link_of(people: Path) -> str:
    """The query of the link that a first start prints. people: the file of the service's people."""
    opened = People(people)
    token = opened.first_run_token()
    opened.close()
    return f"/?token={token}"
