"""The camera page: layers over the picture, what they show as a list, zoom, and a frozen picture."""

import re
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect

from tests.app.fake_service import FakeService, Scene, running_service, served_page
from tests.browser.conftest import link_of
from tests.conftest import ROOT
from vision_core.rtdb import records

pytestmark = [pytest.mark.browser, pytest.mark.usefixtures("built_page")]

AXE = ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js"


@pytest.fixture
def service() -> Iterator[FakeService]:
    with running_service(Scene(clients=2, moving=False)) as service:
        yield service


@pytest.fixture
def address(service: FakeService) -> Iterator[str]:
    with served_page(service) as address:
        yield address


@pytest.fixture
def context(browser: Browser) -> Iterator[BrowserContext]:
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    yield context
    context.close()


def opened(context: BrowserContext, address: str) -> Page:
    page = context.new_page()
    page.goto(f"http://{address}/camera")
    expect(page.get_by_text(re.compile("picture of frame"))).to_be_visible(timeout=15_000)
    return page


def faults(page: Page) -> list[str]:
    """What axe finds."""
    page.evaluate(AXE.read_text())
    found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
    return [f"{v['id']}: {v['nodes'][0]['html'][:200]}" for v in found]


def looked_at(service: FakeService) -> tuple[str, ...]:
    return tuple(records.LOOKING.reader(service.store).value(service.clock.now()).layers)


def test_layers_are_drawn_listed_and_remembered(context: BrowserContext, address: str, service: FakeService) -> None:
    page = opened(context, address)
    assert records.LOOKING.reader(service.store).read(service.clock.now()) is None
    page.get_by_label("rejected", exact=True).check()
    rejected = page.get_by_role("button", name=re.compile("circle 24 px across; accepted: 9 to 18 px"))
    expect(rejected).to_be_visible()
    expect(page.get_by_text(re.compile("overlay of frame"))).to_be_visible()
    assert looked_at(service) == ("hypotheses",)
    rejected.focus()
    rejected.press("Enter")
    expect(rejected).to_have_attribute("aria-pressed", "true")
    expect(page.get_by_label("What is chosen")).to_contain_text("9 to 18 px")
    for name in ("blobs", "lines", "color classes", "end of the carpet", "contours"):
        page.get_by_label(name, exact=True).check()
    expect(page.get_by_role("list", name="Color classes")).to_contain_text("orange")
    page.locator("h1").hover()
    page.get_by_label("robots and ball").focus()
    expect(page.get_by_text("Blobs: 12 of 340 shown")).to_be_visible()
    expect(page.get_by_role("button", name=re.compile("line 1: missed.*paint on 12%"))).to_be_visible()
    assert set(looked_at(service)) == {"classes", "blobs", "hypotheses", "lines", "boundary", "contours"}
    assert faults(page) == []
    page.reload()
    expect(page.get_by_label("blobs", exact=True)).to_be_checked()
    page.get_by_label("blobs", exact=True).uncheck()
    expect(page.get_by_text("of 340 shown")).to_have_count(0)


def test_a_click_on_the_picture_chooses_what_is_there(context: BrowserContext, address: str) -> None:
    page = opened(context, address)
    page.get_by_label("rejected", exact=True).check()
    expect(page.get_by_role("button", name=re.compile("circle 24 px across"))).to_be_visible()
    canvas = page.locator(".camera-stage canvas")
    box = canvas.bounding_box()
    assert box is not None
    canvas.click(position={"x": box["width"] * 200 / 640, "y": box["height"] * 120 / 480})
    expect(page.get_by_label("What is chosen")).to_contain_text("circle 24 px across")


def test_keys_wheel_and_buttons_zoom(context: BrowserContext, address: str) -> None:
    page = opened(context, address)
    stage = page.get_by_role("group", name=re.compile("plus and minus zoom"))
    fit = page.get_by_role("button", name=re.compile("whole picture"))
    expect(fit).to_have_text("100 %")
    stage.focus()
    page.keyboard.press("+")
    expect(fit).to_have_text("125 %")
    stage.hover()
    page.mouse.wheel(0, -100)
    expect(fit).to_have_text("156 %")
    page.get_by_role("button", name="Zoom out").click()
    expect(fit).to_have_text("125 %")
    stage.focus()
    page.keyboard.press("0")
    expect(fit).to_have_text("100 %")


def test_adapted_colors_go_back_to_the_start_and_this_is_undone(
    context: BrowserContext, address: str, service: FakeService
) -> None:
    page = context.new_page()
    page.goto(f"http://{address}{link_of(service.people)}")
    page.get_by_role("link", name="Camera").click()
    panel = page.get_by_role("region", name="Light and colors since the set-up")
    expect(panel.get_by_role("status")).to_have_text(
        "Adapted to another light: other gains and a palette that was learned."
    )
    expect(panel).to_contain_text("0.06 to 16 at most")
    expect(panel.get_by_role("list", name="Last changes")).to_contain_text("9 of 10 robots read")
    assert faults(page) == []
    panel.get_by_role("button", name="Back to the start").click()
    expect(panel.get_by_role("status")).to_contain_text("Held as set up")
    expect(panel.get_by_role("button", name="Adapt again")).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    expect(panel.get_by_role("status")).to_contain_text("Adapted to another light")


def test_a_mask_is_drawn_saved_and_undone(context: BrowserContext, address: str, service: FakeService) -> None:
    page = context.new_page()
    page.goto(f"http://{address}{link_of(service.people)}")
    page.get_by_role("link", name="Camera").click()
    page.get_by_role("button", name="Draw a mask").click()
    canvas = page.locator(".camera-stage canvas")
    box = canvas.bounding_box()
    assert box is not None
    for x, y in ((100, 100), (200, 100), (200, 160), (300, 300)):
        canvas.click(position={"x": box["width"] * x / 640, "y": box["height"] * y / 480})
    expect(page.get_by_text("4 points. Click on the picture")).to_be_visible()
    page.keyboard.press("Delete")
    page.keyboard.press("Enter")
    expect(page.get_by_label("Name")).to_have_value("mask 1")
    page.get_by_label("Name").fill("scoreboard")
    points = page.get_by_label("Points of scoreboard, x and y, one per line")
    points.fill("100, 100\n200, 100\nhere")
    points.blur()
    expect(page.get_by_text("line 3: here; accepted: two numbers, as 120, 45")).to_be_visible()
    points.fill("100, 100\n200, 100\n200, 160\n100, 170")
    points.blur()
    assert faults(page) == []
    page.get_by_role("button", name="Save masks").click()
    expect(page.get_by_role("button", name="Restart the service")).to_be_visible()
    assert kept_masks(address, service) == [
        {"name": "scoreboard", "points_px": [[100.0, 100.0], [200.0, 100.0], [200.0, 160.0], [100.0, 170.0]]}
    ]
    page.get_by_role("button", name="Undo").last.click()
    expect(page.get_by_label("Name")).to_have_count(0)
    assert kept_masks(address, service) == []


def kept_masks(address: str, service: FakeService) -> Any:
    found = httpx.get(f"http://{address}/api/v1/settings", headers=service.operator).json()["settings"]
    return next(setting["value"] for setting in found if setting["key"] == "camera.masks")


def test_a_frozen_picture_stays(context: BrowserContext, address: str) -> None:
    page = opened(context, address)
    page.get_by_label("rejected", exact=True).check()
    caption = page.get_by_text(re.compile("overlay of frame"))
    expect(caption).to_be_visible()
    page.get_by_role("button", name="Freeze").click()
    expect(page.get_by_text(re.compile("frozen .* ago"))).to_be_visible()
    frames = re.findall(r"frame (\d+)", caption.text_content() or "")
    page.wait_for_timeout(600)
    assert re.findall(r"frame (\d+)", caption.text_content() or "") == frames
    page.get_by_role("button", name="Frozen").click()
    expect(caption).not_to_contain_text(f"frame {frames[0]};")
