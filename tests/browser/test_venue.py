"""The wizard: a new venue from pictures of the demo, by mouse and keys, until it is saved; it survives a reload."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect

from tests.app.fake_service import FakeService, Scene, running_service, served_page
from tests.browser.conftest import link_of
from tests.browser.test_camera import faults
from tests.setup.demo import DemoPicture, demo_pictures
from vision_core.native.opencv import write_picture
from vision_core.venues.loader import load_settings

pytestmark = [pytest.mark.browser, pytest.mark.timeout(500), pytest.mark.usefixtures("built_page")]
SLOW_MS = 240_000


@pytest.fixture(scope="module")
def shown() -> DemoPicture:
    return demo_pictures()[0]


@pytest.fixture
def service() -> Iterator[FakeService]:
    with running_service(Scene(clients=0)) as service:
        yield service


@pytest.fixture
def address(service: FakeService, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    for module in ("app.web.routes.new_venue", "app.web.reports.new_venue", "vision_core.setup.venue_file"):
        monkeypatch.setattr(f"{module}.own_venues_folder", lambda: tmp_path / "venues")
    with served_page(service) as address:
        yield address


@pytest.fixture
def context(browser: Browser) -> Iterator[BrowserContext]:
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    yield context
    context.close()


def go_on(page: Page, step: str) -> None:
    page.get_by_role("button", name=f"Next: {step}").click()
    expect(page.get_by_role("heading", name=re.compile(f"Step . of 7: {step}"))).to_be_focused()


def pick(page: Page, shown: DemoPicture, name: str, place: tuple[int, int]) -> None:
    page.get_by_role("radio", name=re.compile(f"^{name}")).check()
    stage = page.get_by_role("application")
    box = stage.bounding_box()
    assert box is not None
    scale = box["width"] / shown.pixels.shape[1]
    stage.click(position={"x": (place[0] + 0.5) * scale, "y": (place[1] + 0.5) * scale})
    expect(page.get_by_text(re.compile(f"is a sample of {name} now"))).to_be_visible(timeout=SLOW_MS)


def test_a_venue_from_pictures_to_its_file(
    context: BrowserContext, address: str, service: FakeService, shown: DemoPicture, tmp_path: Path
) -> None:
    good, bad = tmp_path / "field.png", tmp_path / "bad.png"
    write_picture(good, shown.pixels)
    bad.write_text("no picture")
    page = context.new_page()
    page.goto(f"http://{address}{link_of(service.people)}")
    page.get_by_role("link", name="New venue").click()
    page.locator("input[type=file]").set_input_files([bad, good])
    expect(page.get_by_text("bad.png: a file that is no picture")).to_be_visible(timeout=SLOW_MS)
    expect(page.get_by_text("640x480, the first")).to_be_visible(timeout=SLOW_MS)
    assert faults(page) == []

    go_on(page, "Markers")
    page.get_by_role("radio", name=re.compile("ssl-standard")).check()
    assert faults(page) == []
    page.get_by_label("Robots per team").fill("4")
    go_on(page, "Field")
    expect(page.get_by_role("button", name="Undo: robots per team: 4")).to_be_visible()
    page.get_by_role("radio", name=re.compile("ssl-2002")).check()
    assert faults(page) == []
    go_on(page, "Camera")
    page.get_by_role("radio", name=re.compile("beginning with four corners")).check()
    for name in ("left top", "right top"):  # the magnifier of one corner is over none of the others
        corner = page.get_by_role("slider", name=f"corner {name}")
        before = corner.get_attribute("aria-valuetext")
        box = corner.locator("circle").bounding_box()
        assert box is not None
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.mouse.down()
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 40)
        page.mouse.up()
        expect(corner).not_to_have_attribute("aria-valuetext", before or "")
    page.get_by_role("radio", name=re.compile("search the painted lines")).check()
    page.get_by_label("Height of the camera [m]").fill("3,75")
    page.get_by_role("button", name="Find the camera").press("Enter")
    expect(page.get_by_role("heading", name="✓ It can be taken")).to_be_visible(timeout=SLOW_MS)
    assert faults(page) == []
    page.get_by_role("button", name="Take this camera").click()
    expect(page.get_by_role("heading", name="✓ Taken")).to_be_visible()

    go_on(page, "Colors")
    for name, places in shown.papers().items():
        pick(page, shown, name, places[0])
    page.reload()
    expect(page.get_by_text("Every color has a sample.")).to_be_visible(timeout=SLOW_MS)
    expect(page.get_by_alt_text("The color class of every pixel")).to_be_visible(timeout=SLOW_MS)
    stage = page.get_by_role("application")
    stage.focus()
    stage.press("Shift+ArrowUp")
    page.get_by_role("radio", name=re.compile("^none")).check()
    stage.press("Enter")
    expect(page.get_by_text(re.compile("is a sample of none now"))).to_be_visible(timeout=SLOW_MS)
    page.get_by_role("button", name=re.compile("Undo: sample .* of none")).click()
    expect(page.get_by_role("button", name=re.compile("Undo: sample .* of none"))).to_have_count(0)
    assert faults(page) == []

    go_on(page, "Try it")
    page.get_by_role("button", name="Look for robots and ball").click()
    expect(page.get_by_text(re.compile(rf"robots, {len(shown.ids())} with an id.* in 1 picture"))).to_be_visible(
        timeout=SLOW_MS
    )
    assert faults(page) == []
    go_on(page, "Save")
    page.get_by_label("Name").fill("demo-lab")
    page.get_by_role("button", name="Save the venue").click()
    expect(page.get_by_text(re.compile("Saved: .*demo-lab.toml"))).to_be_visible(timeout=SLOW_MS)
    assert faults(page) == []
    page.get_by_role("button", name="Use it now").click()
    expect(page.get_by_role("button", name="Restart the service")).to_be_visible(timeout=SLOW_MS)
    assert load_settings(str(tmp_path / "venues" / "demo-lab.toml")).colors.classes == {}
