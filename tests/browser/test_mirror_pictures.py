"""Mirrors from on-board pictures on the page: everything around a robot, targets by a click, refusals, undo."""

import re
from collections.abc import Iterator
from functools import partial

import numpy as np
import pytest
from playwright.sync_api import Browser, FilePayload, Locator, Page, expect

from app.web.blackboard import Blackboard, Picture
from tests.app.fake_service import FakeService, Scene, running_service, served_page, wait_for
from tests.browser.conftest import link_of
from tests.browser.test_camera import faults
from tests.calibration.mirror.pictures import CENTER_PX, SIZE_PX, around
from vision_core.calibration.mirror.verdict import SPAN_MM
from vision_core.capture.synthetic.render import Renderer
from vision_core.capture.synthetic.world import World
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.native.opencv import encode_png
from vision_core.onboard.camera import OnboardCamera
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

pytestmark = [pytest.mark.browser, pytest.mark.slow, pytest.mark.timeout(600), pytest.mark.usefixtures("built_page")]
SLOW_MS = 240_000
SETTINGS = load_settings(options={"synthetic.seed": 0})
MIRRORS = {
    "paper.png": PAPER_MIRROR,
    "low.png": Hyperboloid(500.0, 150.0, 1.6).mirror(),
    "short.png": Hyperboloid(150.0, 300.0, 1.2).mirror(),
}
FITTED = "async () => (await (await fetch('/api/v1/calibration')).json()).mirror"


@pytest.fixture
def service() -> Iterator[FakeService]:
    with running_service(Scene(clients=1, moving=False), SETTINGS) as service:
        yield service


@pytest.fixture
def page(browser: Browser, service: FakeService) -> Iterator[Page]:
    with served_page(service) as address:
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.set_default_timeout(SLOW_MS)
        page.goto(f"http://{address}{link_of(service.people)}")
        page.get_by_role("link", name="Mirror", exact=True).click()
        yield page
        page.close()


def file(name: str, pixels: Bytes) -> FilePayload:
    return {"name": name, "mimeType": "image/png", "buffer": encode_png(pixels)}


def seen(locator: Locator) -> None:
    expect(locator).to_be_visible(timeout=SLOW_MS)


def is_fitted(page: Page, name: str) -> bool:
    """Is the newest mirror that of the pairs of a picture?"""
    fitted = page.evaluate(FITTED)
    return fitted is not None and fitted["pairs"][0]["name"].startswith(name)


def drop(page: Page, *files: FilePayload) -> None:
    page.get_by_label("or choose files").set_input_files(list(files))


def test_three_mirrors_are_recovered_from_rendered_pictures(
    page: Page, service: FakeService, monkeypatch: pytest.MonkeyPatch
) -> None:
    world, camera = World(SETTINGS), CameraSetup.from_settings(SETTINGS)
    world.advance(3.0)
    snapshot = world.snapshot()
    ceiling = camera.black_image()
    Renderer(SETTINGS, camera, world.robots_worn).draw(ceiling, snapshot)
    monkeypatch.setattr(Blackboard, "picture", lambda _self: Picture(1, service.clock.now(), ceiling))
    cameras = {name: OnboardCamera(SETTINGS, (Team.BLUE, 1), mirror=mirror) for name, mirror in MIRRORS.items()}
    drop(page, *(file(name, one.picture(one.scene(snapshot))) for name, one in cameras.items()))
    for name in cameras:
        seen(page.get_by_role("button", name=name, exact=True))
    for name, one in cameras.items():
        page.get_by_role("button", name=name, exact=True).click()
        page.get_by_label("Pixels of the picture per pixel").fill(f"{one.scale:.6f}")
        page.get_by_role("button", name="Find the pairs").click()
        remove = page.get_by_role("button", name=f"Remove the pairs of {name}")
        seen(remove)
        seen(page.get_by_role("img", name=re.compile(r"picture with \d{3} pairs")))
        page.get_by_role("button", name="Fit a mirror").click()
        wait_for(partial(is_fitted, page, name), SLOW_MS / 1e3)
        seen(page.get_by_role("heading", name="✓ The fit can be taken"))
        fitted = page.evaluate(FITTED)
        found = np.array([(point["r_mm"], point["r_px"]) for point in fitted["curve"]])
        assert found[:, 0] == pytest.approx(SPAN_MM)
        assert np.abs(found[:, 1] - one.mirror.px_from_mm(SPAN_MM)).max() < 0.5
        remove.click()
        expect(remove).to_be_hidden(timeout=SLOW_MS)
    page.get_by_role("button", name=f"Undo removing the pairs of {name}").click()
    seen(remove)
    assert faults(page) == []


def test_a_click_gives_a_pair_and_what_cannot_be_used_is_named(page: Page) -> None:
    width, height = SIZE_PX
    drop(page, file("target.png", around(np.full(360, 61.3))), file("small.png", np.zeros((60, 80, 3), dtype=np.uint8)))
    seen(page.get_by_text(re.compile(r"small\.png: 80x60.*accepted")))
    page.get_by_label("a target on the floor").check()
    stage = page.get_by_role("img", name="The on-board picture")
    box = stage.bounding_box()
    assert box is not None
    shown = min(box["width"] / width, box["height"] / height)

    def click(radius_px: float) -> None:
        x, y = CENTER_PX[0] - width / 2.0 + 0.5, CENTER_PX[1] - radius_px - height / 2.0 + 0.5
        stage.click(position={"x": box["width"] / 2.0 + x * shown, "y": box["height"] / 2.0 + y * shown})

    click(40.0)
    seen(page.get_by_text("an edge in target.png: none; accepted: a place within 12 px"))
    click(58.0)
    distance = page.get_by_label(re.compile(r"Distance of the edge at R = 61\.\d\d px"))
    distance.fill("x")
    page.get_by_role("button", name="Add the pair").click()
    seen(page.get_by_text("“x”; accepted: a number above 0"))
    distance.fill("380")
    page.get_by_role("button", name="Add the pair").click()
    expect(page.get_by_label("row 1, distance r in millimetres")).to_have_value("380", timeout=SLOW_MS)
    page.get_by_role("button", name="Undo adding the pair at 380 mm").click()
    expect(page.get_by_label("row 1, distance r in millimetres")).to_have_value("", timeout=SLOW_MS)
    page.get_by_role("button", name="Find the mirror's rim").click()
    seen(page.get_by_text("Mirror's center: 159.5, 119.5 px"))
    drop(page, file("bright.png", np.full((height, width, 3), 200, dtype=np.uint8)))
    page.get_by_role("button", name="bright.png", exact=True).click()
    page.get_by_role("button", name="Find the mirror's rim").click()
    seen(page.get_by_text("the mirror's rim in bright.png: corners of brightness 200 of 255"))
    assert faults(page) == []
