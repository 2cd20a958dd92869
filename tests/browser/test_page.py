"""The page in a browser, on a fake service: what a person sees."""

import re
from collections.abc import Iterator
from dataclasses import replace

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.app.fake_service import STATES, FakeService, PageServer, Scene
from vision_core.geometry import rotation
from vision_core.rtdb import records
from vision_core.types.tracks import RobotTrack
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.browser

TABLET = {"width": 1180, "height": 820}
DESKTOP = {"width": 1440, "height": 900}
COLORS_OF_CANVAS = """selector => {
  const canvas = document.querySelector(selector);
  const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  const seen = new Set();
  for (let at = 0; at < data.length; at += 4 * 7) seen.add(data[at] << 16 | data[at + 1] << 8 | data[at + 2]);
  return seen.size;
}"""
"""How many colors a canvas shows: 1 when nothing is drawn."""
PLACE_ON_PAGE = """async ([x_m, y_m]) => {
  const { mapping } = await import('/web/field.js');
  const field = await (await fetch('/api/v1/field')).json();
  const box = document.querySelector('#field').getBoundingClientRect();
  const [x, y] = mapping(field, box.width, box.height).at(x_m, y_m);
  return [box.x + x, box.y + y];
}"""

COLOR_ON_FIELD = """async ([x_m, y_m]) => {
  const { mapping } = await import('/web/field.js');
  const field = await (await fetch('/api/v1/field')).json();
  const canvas = document.querySelector('#field');
  const [x, y] = mapping(field, canvas.clientWidth, canvas.clientHeight).at(x_m, y_m);
  return [...canvas.getContext('2d').getImageData(Math.round(x), Math.round(y), 1, 1).data.slice(0, 3)];
}"""
COLOR_IN_PICTURE = """color => {
  const canvas = document.querySelector('#picture');
  const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  for (let at = 0; at < data.length; at += 4) if (color.every((part, index) => part === data[at + index])) return true;
  return false;
}"""
BLUE, YELLOW, UNKNOWN, UNKNOWN_RING = [47, 111, 228], [255, 210, 63], [150, 60, 150], [240, 160, 240]
MIXED = load_settings(
    options={
        "robots.blue": {"pattern": "vsss-three-patch", "outline": "square", "radius_m": 0.1, "height_m": 0.1},
        "robots.yellow": {"pattern": "ssl-standard", "outline": "circle", "radius_m": 0.1, "height_m": 0.1},
    }
)


class Watched:
    """A page and everything it complains about."""

    def __init__(self, browser: Browser, address: str, size: dict[str, int], scheme: str = "light") -> None:
        self.complaints: list[str] = []
        self.page: Page = browser.new_page(viewport=size, color_scheme=scheme)  # type: ignore[arg-type]
        self.page.on(
            "console", lambda message: self.complaints.append(message.text) if message.type == "error" else None
        )
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("requestfailed", lambda request: self.complaints.append(request.url))
        self.page.goto(f"http://{address}/")


@pytest.fixture
def service(request: pytest.FixtureRequest) -> Iterator[FakeService]:
    param = getattr(request, "param", Scene())
    service = FakeService(*param) if isinstance(param, tuple) else FakeService(param)
    service.start()
    yield service
    service.stop()


@pytest.fixture
def server(service: FakeService) -> Iterator[PageServer]:
    server = PageServer(service)
    server.start()
    yield server
    server.stop()


@pytest.mark.parametrize(("size", "scheme"), [(TABLET, "dark"), (DESKTOP, "light")])
def test_it_shows_picture_field_and_ten_views(
    browser: Browser, server: PageServer, size: dict[str, int], scheme: str
) -> None:
    watched = Watched(browser, server.address, size, scheme)
    page = watched.page
    expect(page.locator("#verdict")).to_have_text("ready")
    expect(page.locator(".tile")).to_have_count(10)
    expect(page.locator("#clients tr")).to_have_count(10)
    expect(page.locator("#tasks canvas")).to_have_count(11)
    expect(page.locator("#lag")).to_have_text("12.4 · 0.2 · 2.0")
    expect(page.locator("#camera-rate")).to_have_text("30.0 Hz")
    expect(page.locator("#picture-empty")).to_be_hidden()
    page.wait_for_function("document.querySelector('#picture-age').textContent.endsWith('ms')")
    assert page.evaluate(COLORS_OF_CANVAS, "#picture") > 20
    assert page.evaluate(COLORS_OF_CANVAS, "#field") > 5
    for index in range(1, 11):
        page.wait_for_function(f"() => ({COLORS_OF_CANVAS})('.tile:nth-child({index}) canvas') > 3")
    overflow = "document.documentElement.scrollWidth - innerWidth + document.documentElement.scrollHeight - innerHeight"
    assert page.evaluate(overflow) == 0, "everything fits on the screen"
    assert watched.complaints == []
    page.close()


def test_a_robot_is_chosen_by_keyboard_and_by_click(browser: Browser, server: PageServer) -> None:
    watched = Watched(browser, server.address, DESKTOP)
    page = watched.page
    tile = page.locator(".tile.blue").nth(1)
    tile.focus()
    page.keyboard.press("Enter")
    expect(tile).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#selected")).to_contain_text("blue 2")
    page.locator(".tile.yellow").nth(0).click()
    expect(tile).to_have_attribute("aria-pressed", "false")
    expect(page.locator("#selected")).to_contain_text("yellow 1")
    assert watched.complaints == []
    page.close()


@pytest.mark.parametrize("service", [STATES["unread"]], indirect=True)
def test_robots_that_are_not_seen_are_called_so(browser: Browser, server: PageServer) -> None:
    watched = Watched(browser, server.address, DESKTOP)
    page = watched.page
    tile = page.locator(".tile.yellow").nth(4)
    tile.click()
    expect(page.locator("#selected")).to_have_text("yellow 5 is not seen")
    expect(tile.locator(".unseen-robot")).to_be_visible()
    expect(page.locator("#clients tr", has_text="yellow 5")).to_contain_text("not seen")
    expect(page.locator("#clients tr", has_text="yellow 4")).not_to_contain_text("not seen")
    page.keyboard.press("Escape")
    expect(tile).to_have_attribute("aria-pressed", "false")
    assert watched.complaints == []
    page.close()


@pytest.mark.parametrize("service", [STATES["unread"]], indirect=True)
def test_a_robot_is_chosen_on_the_field(browser: Browser, service: FakeService, server: PageServer) -> None:
    watched = Watched(browser, server.address, DESKTOP)
    page = watched.page
    expect(page.locator("#verdict")).to_have_text("ready")
    service.stop()  # so that they stand
    page.wait_for_timeout(200)
    unread, named = records.WORLD.reader(service.store).value(service.clock.now()).robots[:2]
    for robot in (named, unread):
        page.mouse.click(*page.evaluate(PLACE_ON_PAGE, [robot.x_m, robot.y_m]))
        expect(page.locator("#field")).to_have_css("cursor", "pointer")
        expect(page.locator(".tile.blue").nth(1)).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#selected")).to_contain_text("B?: its number cannot be read")
    assert watched.complaints == []
    page.close()


@pytest.mark.parametrize("service", [(Scene(unread=True, obstacles=False, moving=False), MIXED)], indirect=True)
def test_robots_are_drawn_as_their_team_is_and_turned(
    browser: Browser, service: FakeService, server: PageServer
) -> None:
    watched = Watched(browser, server.address, DESKTOP)
    page = watched.page
    expect(page.locator("#verdict")).to_have_text("ready")
    page.wait_for_function(f"async () => ({COLORS_OF_CANVAS})('#field') > 5")
    unread, *robots = records.WORLD.reader(service.store).value(service.clock.now()).robots
    blue, yellow = robots[0], robots[-1]

    def color(robot: RobotTrack, ahead: float, left: float) -> list[int]:
        """Of what is drawn so far from a robot's center, in halves of its width."""
        offset = rotation(robot.heading_rad) @ (0.1 * ahead, 0.1 * left)
        shown: list[int] = page.evaluate(COLOR_ON_FIELD, [robot.x_m + offset[0], robot.y_m + offset[1]])
        return shown

    for corner in ((-0.85, 0.85), (-0.85, -0.85)):
        assert color(blue, *corner) == BLUE
        assert color(unread, *corner) != BLUE
        assert color(yellow, *corner) != YELLOW
    assert color(blue, 0.8, 0.5) == [255, 255, 255], "the mark at its front"
    assert color(yellow, -0.85, 0.0) == YELLOW
    assert color(unread, 0.85, 0.0) == BLUE, "a full circle"
    assert watched.complaints == []
    page.close()


def test_obstacles_are_shown_and_explained(browser: Browser, service: FakeService, server: PageServer) -> None:
    watched = Watched(browser, server.address, DESKTOP)
    page = watched.page
    expect(page.locator("#verdict")).to_have_text("ready")
    place = [service.settings.field.length_m * 0.025, service.settings.field.width_m * 0.475]
    edge = [place[0], place[1] - 0.08]
    page.wait_for_function(f"async () => String(await ({COLOR_ON_FIELD})({edge})) === '{','.join(map(str, UNKNOWN))}'")
    page.mouse.click(*page.evaluate(PLACE_ON_PAGE, place))
    expect(page.locator("#selected")).to_contain_text("no known robot and no ball, 22 cm wide")
    expect(page.locator("#field")).to_have_css("cursor", "help")
    assert page.evaluate(COLOR_IN_PICTURE, UNKNOWN_RING)
    page.get_by_role("checkbox", name="obstacles").uncheck()
    assert not page.evaluate(COLOR_IN_PICTURE, UNKNOWN_RING)
    page.keyboard.press("Escape")
    expect(page.locator("#selected")).to_contain_text("Choose a robot")
    assert watched.complaints == []
    page.close()


@pytest.mark.parametrize("service", [STATES["explained"]], indirect=True)
def test_reasons_are_a_list_while_there_are_any(browser: Browser, service: FakeService, server: PageServer) -> None:
    watched = Watched(browser, server.address, TABLET)
    page = watched.page
    reasons = list(service.scene.reasons)
    expect(page.locator("#detection li")).to_have_text(reasons)
    service.scene = replace(service.scene, reasons=tuple(reasons[1:2]))
    expect(page.locator("#detection li")).to_have_text(reasons[1:2])
    service.scene = replace(service.scene, reasons=())
    expect(page.locator("#detection")).to_be_hidden()
    assert watched.complaints == []
    page.close()


def test_every_task_is_shown_with_what_it_got_and_how_it_does(
    browser: Browser, service: FakeService, server: PageServer
) -> None:
    watched = Watched(browser, server.address, DESKTOP)
    page = watched.page
    expect(page.locator("#degraded")).to_be_hidden()
    rows = page.locator("#tasks tr:not([hidden])")
    expect(rows.locator("td:first-child")).to_have_text([task.name for task in service.tasks])
    lines = rows.filter(has_text="lines").locator("td")
    expect(lines.nth(1)).to_have_text("every 400 ms")
    expect(lines.nth(2)).to_have_text("FIFO 20")
    expect(lines.nth(4)).to_have_text("6.1")
    expect(lines.nth(10)).to_have_text("1")
    expect(rows.filter(has_text="perceive").locator("td").nth(1)).to_have_text("frames")
    expect(rows.filter(has_text="web").locator("td").nth(1)).to_have_text("own loop")
    expect(page.locator("#other-processes")).to_have_text("compile done, spare-1 running, spare-2 running")
    assert page.evaluate(COLORS_OF_CANVAS, "#tasks tr:nth-child(5) canvas") > 3
    answer = page.request.patch(f"http://{server.address}/api/v1/tasks/lines", data={"enabled": False})
    assert answer.ok
    expect(lines.nth(3)).to_have_text("off")
    expect(lines.nth(0)).to_have_text("lines ✎")
    expect(page.locator("#degraded li")).to_have_text(["task lines is switched off"])
    expect(page.locator("#verdict")).to_have_text("degraded")
    assert watched.complaints == []
    page.close()


@pytest.mark.parametrize("service", [STATES["degraded"]], indirect=True)
@pytest.mark.parametrize("size", [TABLET, DESKTOP])
def test_what_is_degraded_is_said_and_marked(browser: Browser, server: PageServer, size: dict[str, int]) -> None:
    watched = Watched(browser, server.address, size)
    page = watched.page
    expect(page.locator("#verdict")).to_have_text("degraded")
    expect(page.locator("#verdict")).to_have_class("pill degraded")
    plain = ["views may be late when this machine is busy", "this machine keeps time badly"]
    expect(page.locator("#degraded li")).to_have_text([*plain, "a part of the service has been given up"])
    expect(page.locator("#alarm-details li")).to_have_count(4)
    expect(page.locator("#alarm-details li").first).to_contain_text("SCHED_FIFO 50, 45, 40, 35 is refused")
    assert page.evaluate("document.querySelector('#degraded').clientHeight") <= 45
    page.locator("#degraded").hover()
    expect(page.locator("#degraded li").last).to_be_in_viewport()
    perceive = page.locator("#tasks tr", has_text="perceive").locator("td").nth(2)
    expect(perceive).to_have_text("⚠ nice -10")
    expect(perceive).to_have_attribute("title", re.compile("SCHED_FIFO 45 is refused: no CAP_SYS_NICE"))
    expect(page.locator("#tasks td.detail:visible")).to_have_text([re.compile("^process watch is disabled: 5 ends")])
    expect(page.locator("#lag")).to_have_text("12.4 · – · –")
    expect(page.locator("#clients tr").first.locator("td").nth(3)).to_have_text("–")
    assert watched.complaints == []
    page.close()


def test_it_survives_a_restart_of_the_server(browser: Browser, service: FakeService, server: PageServer) -> None:
    first = PageServer(service)
    first.start()
    watched = Watched(browser, first.address, TABLET)
    page = watched.page
    expect(page.locator("#verdict")).to_have_text("ready")
    first.stop()
    expect(page.locator("#verdict")).to_have_text("connection lost")
    expect(page.locator("#reasons")).to_have_text("trying again")
    expect(page.locator("#picture-stale")).to_be_visible()
    second = PageServer(service, int(first.address.rpartition(":")[2]))
    second.start()
    expect(page.locator("#verdict")).to_have_text("ready", timeout=10_000)
    expect(page.locator("#picture-stale")).to_be_hidden()
    page.close()
    second.stop()


@pytest.mark.parametrize("service", [STATES["slow"]], indirect=True)
def test_a_slow_camera_is_shown_as_degraded(browser: Browser, server: PageServer) -> None:
    watched = Watched(browser, server.address, TABLET)
    page = watched.page
    expect(page.locator("#verdict")).to_have_text("degraded", timeout=30_000)
    expect(page.locator("#degraded li")).to_have_text("the camera delivers 9.0 of 30 pictures a second")
    expect(page.locator("#alarm-details")).to_be_hidden()
    assert watched.complaints == []
    page.close()


@pytest.mark.parametrize("service", [STATES["compiling"]], indirect=True)
def test_it_says_what_it_waits_for(browser: Browser, server: PageServer) -> None:
    watched = Watched(browser, server.address, DESKTOP)
    page = watched.page
    expect(page.locator("#verdict")).to_have_text("not ready")
    expect(page.locator("#reasons")).to_have_text("compiling: 3 of 7: label pixels")
    expect(page.locator("#picture-empty")).to_have_text("compiling: 3 of 7: label pixels")
    expect(page.locator("#no-clients")).to_contain_text("(init blue 1)")
    assert watched.complaints == []
    page.close()


def test_a_camera_that_stops_is_shown_as_stale(browser: Browser, service: FakeService, server: PageServer) -> None:
    watched = Watched(browser, server.address, TABLET)
    page = watched.page
    expect(page.locator("#verdict")).to_have_text("ready")
    service.scene.image = False
    expect(page.locator("#verdict")).to_have_text("not ready")
    expect(page.locator("#reasons")).to_contain_text("the camera's image is")
    expect(page.locator("#picture-stale")).to_be_visible()
    expect(page.locator("#field-stale")).to_be_visible()
    assert watched.complaints == []
    page.close()


def test_the_documentation_needs_no_internet(browser: Browser, server: PageServer) -> None:
    watched = Watched(browser, server.address, DESKTOP)
    page = watched.page
    page.wait_for_load_state("networkidle")  # what is still on its way would be given up, and complained of
    page.get_by_role("link", name="API").click()
    for path, told in (("/api/v1/status", '"ready": true'), ("/metrics", "pslv_ready 1.0")):
        details = page.locator("details", has=page.locator("summary code", has_text=re.compile(f"^{path}$")))
        details.locator("summary").click()
        details.get_by_role("button", name="Ask the service").click()
        expect(details.locator("pre")).to_contain_text(told)
    change = page.locator("#operations details", has_text="PATCH")
    change.locator("summary").click()
    expect(change).to_contain_text("Sent as JSON: Override")
    expect(page.locator("#schemas details", has_text="CameraReport").first).to_be_attached()
    assert watched.complaints == []
    page.close()
