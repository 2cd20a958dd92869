"""The calibration on the page: a lens from pictures of a board, then the camera from several pictures of the field."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from bench.board_views import board_pictures
from bench.calibration_views import view
from tests.app.fake_service import FakeService, Scene, running_service, served_page
from tests.browser.conftest import link_of
from tests.browser.test_camera import faults
from vision_core.native.opencv import write_picture

pytestmark = [pytest.mark.browser, pytest.mark.timeout(500), pytest.mark.usefixtures("built_page")]
SLOW_MS = 240_000


@pytest.fixture
def service() -> Iterator[FakeService]:
    with running_service(Scene(clients=0)) as service:
        yield service


@pytest.fixture
def page(browser: Browser, service: FakeService) -> Iterator[Page]:
    with served_page(service) as address:
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto(f"http://{address}{link_of(service.people)}")
        page.get_by_role("link", name="Camera", exact=True).click()
        page.get_by_role("link", name="Calibrate").click()
        yield page
        page.close()


def test_a_lens_from_a_board_then_the_camera_from_several_pictures(page: Page, tmp_path: Path) -> None:
    boards = [tmp_path / f"board{number}.png" for number in range(7)]
    for path, pixels in zip(boards, board_pictures(), strict=True):
        write_picture(path, pixels)
    by_files = page.locator("input[type=file]")
    by_files.nth(1).set_input_files(boards[:3])
    expect(page.get_by_role("button", name="Take out board2.png")).to_be_visible(timeout=SLOW_MS)
    page.get_by_role("button", name="Measure the lens").click()
    expect(page.get_by_text("the board is seen in 3 of 3 pictures, 4 are needed")).to_be_visible(timeout=SLOW_MS)
    by_files.nth(1).set_input_files(boards[3:])
    expect(page.get_by_role("button", name="Take out board6.png")).to_be_visible(timeout=SLOW_MS)
    page.get_by_role("button", name="Measure the lens").click()
    expect(page.get_by_role("heading", name="✓ It can be taken")).to_be_visible(timeout=SLOW_MS)
    assert faults(page) == []
    page.get_by_role("button", name="Take the lens over").click()
    expect(page.get_by_text("A measured lens holds: 389 px")).to_be_visible()
    page.get_by_role("button", name="Let lines tell the lens again").click()
    expect(page.get_by_text("A measured lens holds")).to_be_hidden()

    shown = view(2).pixels
    for name, pixels in (("a", shown), ("b", shown), ("moved", np.roll(shown, 9, axis=1))):
        write_picture(tmp_path / f"{name}.png", pixels)
    by_files.nth(0).set_input_files([tmp_path / f"{name}.png" for name in ("a", "b", "moved")])
    expect(page.get_by_role("button", name="Take out moved.png")).to_be_visible(timeout=SLOW_MS)
    page.get_by_role("button", name="Calibrate", exact=True).click()
    expect(page.get_by_text("moved.png shows the field 9.0 px to the right")).to_be_visible(timeout=SLOW_MS)
    assert faults(page) == []
    page.get_by_role("button", name="Take out moved.png").click()
    page.get_by_role("button", name="Calibrate", exact=True).click()
    expect(page.get_by_text("pieces of lines, 0.00 px from the others").first).to_be_visible(timeout=SLOW_MS)
    page.get_by_role("button", name="Take it over").click()
    expect(page.get_by_text("kept; waits for a restart")).to_be_visible()
    page.set_viewport_size({"width": 390, "height": 844})
    assert faults(page) == []
