"""The mirror on the page: pairs are pasted and fitted, the proposal is looked through, accepted, and taken back."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.app.fake_service import FakeService, Scene, running_service, served_page
from tests.browser.conftest import link_of
from tests.browser.test_camera import faults
from vision_core.models.mirror import Mirror
from vision_core.rtdb import records

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300), pytest.mark.usefixtures("built_page")]
SLOW_MS = 240_000
OTHER = Mirror(4.6, 0.0146, 90000.0)
DISTANCES = [110, 150, 220, 300, 380, 500, 700, 1000, 1500, 2000]
PAIRS = "r [mm];R [px]\n" + "\n".join(f"{mm};{OTHER.px_from_mm(mm):.2f}" for mm in DISTANCES)
PASTE = """(box, text) => {
  const clipboardData = new DataTransfer();
  clipboardData.setData("text/plain", text);
  box.dispatchEvent(new ClipboardEvent("paste", {clipboardData, bubbles: true, cancelable: true}));
}"""
PIXELS = "canvas => canvas.toDataURL()"


@pytest.fixture
def service() -> Iterator[FakeService]:
    with running_service(Scene(clients=4, moving=False)) as service:
        yield service


@pytest.fixture
def page(browser: Browser, service: FakeService) -> Iterator[Page]:
    with served_page(service) as address:
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(f"http://{address}{link_of(service.people)}")
        page.get_by_role("link", name="Mirror", exact=True).click()
        yield page
        page.close()


def mirrors(service: FakeService) -> object:
    reading = records.LIVE_SETTINGS.reader(service.store).read(service.clock.now())
    assert reading is not None
    return reading.value.mirror


def test_pairs_are_fitted_looked_through_accepted_and_undone(page: Page, service: FakeService) -> None:
    before = mirrors(service)
    table = page.get_by_role("region", name="Table of pairs")
    table.evaluate(PASTE, "r [mm];R [px]\n110;x")
    expect(page.get_by_text("the text, line 2")).to_be_visible()
    table.evaluate(PASTE, PAIRS)
    expect(page.get_by_label("row 10, radius R in pixels")).to_have_value(f"{OTHER.px_from_mm(2000):.2f}")
    page.get_by_label("row 11, distance r in millimetres").fill("12,x")
    page.get_by_role("button", name="Fit a mirror").click()
    expect(page.get_by_text("row 11: r is “12,x”")).to_be_visible()
    page.get_by_role("button", name="Remove row 11").click()
    page.get_by_role("button", name="Fit a mirror").click()
    expect(page.get_by_role("heading", name="✓ The fit can be taken")).to_be_visible(timeout=SLOW_MS)
    expect(page.get_by_role("heading", name="Proposed mirror")).to_be_visible()
    shown, proposed = (page.get_by_role("img", name=f"What blue 1 {how}") for how in ("sees", "would see"))
    expect(proposed).to_be_visible()
    page.wait_for_function("canvas => canvas.width > 100", arg=proposed.element_handle())
    assert proposed.evaluate(PIXELS) != shown.evaluate(PIXELS)
    assert faults(page) == []
    assert mirrors(service) == before, "a proposal changes nothing"

    page.get_by_role("combobox", name=re.compile("^for")).select_option("blue 3")
    page.get_by_role("button", name="Accept for blue 3").click()
    row = page.get_by_role("row", name="blue 3 its own, of the page")
    expect(row).to_be_visible()
    expect(page.get_by_text("settings/mirror.robots.blue 3")).to_be_visible()
    page.get_by_role("main").get_by_role("listitem").filter(has_text="mirror of blue 3").get_by_role(
        "button", name="Undo"
    ).click()
    expect(row).to_be_hidden()
    assert mirrors(service) == before


def test_a_broken_rule_stands_at_its_slider_and_cannot_be_accepted(page: Page) -> None:
    slider = page.get_by_role("slider", name="C", exact=True)
    slider.focus()
    for _ in range(4):
        page.keyboard.press("PageUp")
    expect(slider).to_have_attribute("aria-invalid", "true")
    expect(page.get_by_role("button", name="Accept for field")).to_be_disabled()
    number = page.get_by_label("B as a number")
    number.fill("0.2")
    number.press("Tab")
    expect(page.get_by_text("accepted: A > B sqrt(C)")).to_be_visible()
    expect(page.get_by_role("slider", name="B", exact=True)).to_have_attribute("aria-invalid", "true")
    expect(slider).to_have_attribute("aria-invalid", "false")
    expect(page.get_by_text("no mirror: nothing to draw")).to_be_visible()
    page.set_viewport_size({"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    assert faults(page) == []
    page.get_by_role("button", name="Discard").click()
    expect(number).to_have_value("0.0125935")
    expect(page.get_by_role("heading", name="Mirror in force")).to_be_visible()
