"""The page in a browser, on a fake service: every page in both themes and three sizes, and a referee's evening."""

import re
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect

from tests.app.fake_service import STATES, FakeService, PageServer, Scene, starting_lines, wait_for
from tests.browser.conftest import link_of
from tests.conftest import ROOT
from vision_core.rtdb import records
from vision_core.rtdb.log_record import LOG, ServiceLog

pytestmark = [pytest.mark.browser, pytest.mark.usefixtures("built_page")]

PAGES = {
    "/": "Match",
    "/teams": "Teams",
    "/robots": "What each robot sees",
    "/robot/blue/1?beside=yellow-2": "Robot's view",
    "/robot": "A team's robots",
    "/camera": "Camera",
    "/calibrate": "Calibrate the camera",
    "/mirror": "Mirror",
    "/settings": "Settings",
    "/timing": "Timing",
    "/fairness": "Fairness",
    "/logs": "Logs",
    "/about": "About",
    "/login": "Log in",
}
SIZES = ((1440, 900), (1024, 768), (390, 844))
AXE = ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js"
COLORS = """canvas => {
  const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  const seen = new Set();
  for (let at = 0; at < data.length; at += 4 * 7) seen.add(data[at] << 16 | data[at + 1] << 8 | data[at + 2]);
  return seen.size;
}"""
"""How many colors a canvas shows: 1 when nothing is drawn."""


class Watched:
    """A page and everything it complains about."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.complaints: list[str] = []
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("console", lambda m: self.complaints.append(m.text) if m.type in ("error", "warning") else None)


@pytest.fixture
def service() -> Iterator[FakeService]:
    service = FakeService(Scene(clients=8))
    service.start()
    yield service
    service.stop()


@pytest.fixture
def server(service: FakeService) -> Iterator[PageServer]:
    server = PageServer(service)
    server.start()
    yield server
    server.stop()


def colors_of(page: Page, canvas: str) -> int:
    """How many colors a canvas shows."""
    return int(page.locator(canvas).first.evaluate(COLORS))


def opened(context: BrowserContext, server: PageServer, path: str) -> Watched:
    watched = Watched(context.new_page())
    watched.page.goto(f"http://{server.address}{path}")
    expect(watched.page.locator(".pill")).to_contain_text(re.compile("ready|degraded"), timeout=15_000)
    return watched


@pytest.mark.parametrize(("theme", "sizes"), [("light", SIZES), ("dark", SIZES[:1])])
def test_every_page_in_every_size_is_whole_and_accessible(
    browser: Browser, service: FakeService, server: PageServer, theme: Any, sizes: Sequence[tuple[int, int]]
) -> None:
    context = browser.new_context(color_scheme=theme)
    watched = opened(context, server, link_of(service.people))
    page = watched.page
    for path, title in PAGES.items():
        for width, height in sizes:
            page.set_viewport_size({"width": width, "height": height})
            page.goto(f"http://{server.address}{path}")
            heading = "Set a password" if path == "/login" else title
            expect(page.locator("h1")).to_have_text(heading)
            page.wait_for_timeout(300)
            wide = page.evaluate("document.documentElement.scrollWidth")
            assert wide <= width, f"{path} at {width} px is {wide} px wide"
        page.evaluate(AXE.read_text())
        found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
        bad = [(v["id"], v["nodes"][0]["html"][:200]) for v in found if v["impact"] in ("serious", "critical")]
        assert bad == [], path
    assert [words for words in watched.complaints if "404" not in words] == []
    context.close()


def test_the_canvases_show_field_views_and_picture(browser: Browser, service: FakeService, server: PageServer) -> None:
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    for path, canvas in (
        ("/", ".carpet canvas"),
        ("/robot/blue/1", ".panorama"),
        ("/robot/blue/1", ".distances"),
        ("/camera", ".dark canvas"),
    ):
        page = opened(context, server, path).page
        wait_for(lambda: colors_of(page, canvas) > 3)  # noqa: B023 (called at once)
        page.close()
    context.close()


def test_an_evening_of_a_referee(browser: Browser, service: FakeService, server: PageServer, tmp_path: Path) -> None:
    context = browser.new_context(viewport={"width": 1440, "height": 900}, accept_downloads=True)
    watched = opened(context, server, link_of(service.people))
    page = watched.page
    assert "token" not in page.url
    page.get_by_role("link", name="Set a password").click()
    page.get_by_label("New password or PIN").fill("a long password")
    page.get_by_label("Once more").fill("a long password")
    page.get_by_role("button", name="Set", exact=True).click()
    expect(page.get_by_text("The password is set.").first).to_be_visible()

    page.get_by_role("link", name="Teams").click()
    for name, short in (("1. FC Köln", "CGN"), ("Robots of Aachen", "AC")):
        page.get_by_role("button", name="Register a team").click()
        page.get_by_label("Name", exact=True).fill(name)
        page.get_by_label("Short name").fill(short)
        page.get_by_label("Marker ids").fill("1, 2, three")
        page.get_by_role("button", name="Register", exact=True).click()
        expect(page.get_by_text("Whole numbers")).to_be_visible()
        expect(page.get_by_label("Name", exact=True)).to_have_value(name)
        page.get_by_label("Marker ids").fill("1 2 3 4 5")
        page.get_by_role("button", name="Register", exact=True).click()
        expect(page.get_by_role("heading", name=re.compile(re.escape(name)))).to_be_visible()
    page.get_by_role("button", name="Make a key").first.click()
    key_link = page.locator(".secret code").first.text_content()
    assert key_link is not None
    page.get_by_role("button", name="Close", exact=True).click()

    page.get_by_role("link", name="Match", exact=True).click()
    page.get_by_label("Team that plays blue").select_option("cgn")
    expect(page.locator(".side-of strong").first).to_have_text("1. FC Köln")
    page.get_by_role("button", name="Swap sides").click()
    expect(page.locator(".side-of strong").nth(1)).to_have_text("1. FC Köln")
    page.get_by_role("button", name="Undo").last.click()
    expect(page.locator(".side-of strong").first).to_have_text("1. FC Köln")
    live = records.LIVE_SETTINGS.reader(service.store).value(service.clock.now())
    assert (live.match.blue_defends, live.match.blue_name) == ("left", "1. FC Köln")

    page.get_by_role("button", name="Disconnect blue 1").click()
    expect(page.get_by_text("blue 1 is disconnected").first).to_be_visible()

    page.get_by_role("link", name="Settings").click()
    page.get_by_label("Search", exact=True).fill("validity_ms")
    field = page.get_by_label("tracks.validity_ms", exact=True)
    field.fill("-5")
    field.press("Enter")
    expect(page.get_by_text(re.compile("accepted: a number > 0"))).to_be_visible()
    expect(field).to_have_value("-5")
    field.fill("400")
    field.press("Enter")
    expect(page.get_by_text("tracks.validity_ms is 400.").first).to_be_visible()
    page.get_by_role("tab", name="Export and import").click()
    with page.expect_download() as download:
        page.get_by_role("link", name="Save as a file").click()
    download.value.save_as(tmp_path / "export.json")
    assert "1. FC K" in (tmp_path / "export.json").read_text()

    team = browser.new_context()
    own = Watched(team.new_page())
    own.page.goto(key_link.replace("localhost", "127.0.0.1"))
    expect(own.page.locator("h1")).to_have_text(re.compile("Köln|Aachen"))
    page.get_by_role("button", name="Log out").click()
    expect(page.get_by_role("link", name="Log in").first).to_be_visible()
    page.get_by_role("link", name="Match", exact=True).click()
    expect(page.get_by_role("button", name="Swap sides")).to_have_count(0)
    assert [words for words in watched.complaints + own.complaints if "422" not in words] == []
    team.close()
    context.close()


def test_sides_are_swapped_by_keyboard_alone(browser: Browser, service: FakeService, server: PageServer) -> None:
    context = browser.new_context(viewport={"width": 1024, "height": 768})
    page = opened(context, server, link_of(service.people)).page
    for _ in range(40):
        page.keyboard.press("Tab")
        if "Swap sides" in (page.evaluate("document.activeElement.textContent") or ""):
            break
    page.keyboard.press("Enter")
    expect(page.get_by_text("Sides swapped.").first).to_be_visible()
    context.close()


def test_a_lost_connection_and_old_positions_are_said_within_a_second(
    browser: Browser, service: FakeService, server: PageServer
) -> None:
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    page = opened(context, server, "/").page
    wait_for(lambda: colors_of(page, ".carpet canvas") > 3)
    service.scene.image = False
    expect(page.get_by_text(re.compile("positions .* old"))).to_be_visible(timeout=2_500)
    server.stop()
    expect(page.locator(".pill")).to_contain_text("connection lost", timeout=2_500)
    context.close()


def test_the_lag_chart_tells_the_newest_values_by_the_24_hour_clock(browser: Browser, server: PageServer) -> None:
    context = browser.new_context(viewport={"width": 1440, "height": 900}, locale="en-US")
    page = opened(context, server, "/timing").page
    legend = page.locator(".u-legend")
    expect(legend).to_contain_text(re.compile(r"time:?\s*[0-2]\d:[0-5]\d:[0-5]\d"))
    expect(legend).to_contain_text(re.compile(r"A server \[ms\]:?\s*12"))
    page.locator(".u-over").hover()
    page.locator("h1").hover()
    page.wait_for_timeout(600)
    assert "--" not in legend.inner_text()
    assert "M" not in legend.inner_text().replace("[ms]", "")  # AM, PM
    context.close()


def test_an_address_that_there_is_not_is_said_in_words(browser: Browser, server: PageServer) -> None:
    context = browser.new_context()
    page = context.new_page()
    answer = page.goto(f"http://{server.address}/mach")
    assert answer is not None
    assert answer.status == 404
    expect(page.locator("h1")).to_have_text("No such page")
    expect(page.get_by_text("/mach does not exist here")).to_be_visible()
    context.close()


def test_why_the_service_is_not_ready_is_said(browser: Browser) -> None:
    service = FakeService(STATES["crashing"])
    service.start()
    server = PageServer(service)
    server.start()
    context = browser.new_context()
    page = context.new_page()
    page.goto(f"http://{server.address}/")
    expect(page.locator(".pill")).to_contain_text(re.compile("not ready|degraded"))
    expect(page.locator(".headline")).to_contain_text("pslv restart perceive")
    page.get_by_role("button", name="alarm").click()
    alarm = page.locator(".alarms li").first
    expect(alarm).to_contain_text("process perceive is disabled")
    expect(alarm).to_contain_text(re.compile(r"What to do: .*pslv restart perceive"))
    expect(alarm).to_contain_text(re.compile(r"since \d\d:\d\d"))
    page.keyboard.press("Escape")
    expect(alarm).to_have_count(0)
    context.close()
    server.stop()
    service.stop()


@pytest.mark.parametrize("width", [1440, 1024])
def test_the_strip_stays_in_place_while_its_numbers_change(
    browser: Browser, service: FakeService, server: PageServer, width: int
) -> None:
    context = browser.new_context(viewport={"width": width, "height": 768})
    page = opened(context, server, "/about").page
    boxes = "[...document.querySelectorAll('.figure')].map(f => Math.round(f.getBoundingClientRect().x))"
    expect(page.locator(".figure.camera")).to_contain_text("30.0 Hz")
    before = page.evaluate(boxes)
    service.scene.condition.camera_rate_hz = 8.25
    service.scene.clients = 3
    expect(page.locator(".figure.camera")).to_contain_text("8.3 Hz")
    expect(page.locator(".figure.clients")).to_contain_text("3 / 0")
    expect(page.locator(".figure.camera")).to_contain_text("check", timeout=15_000)
    assert page.evaluate(boxes) == before
    context.close()


def test_a_service_that_says_nothing_is_seen_on_every_page_within_a_second(
    browser: Browser, service: FakeService, server: PageServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    context = browser.new_context()
    page = opened(context, server, "/about").page
    monkeypatch.setattr("app.web.live.connection.LiveMessages.make", _nothing)
    expect(page.locator(".pill")).to_contain_text("no news for", timeout=1_500)
    context.close()


async def _nothing(*_arguments: object) -> bool:
    """Makes no message."""
    return False


def log_of(count: int, left_out: int = 0) -> ServiceLog:
    """A log of the lines of a start, again and again."""
    pattern = list(starting_lines())
    lines = (replace(pattern[n % len(pattern)], number=n + 1, at=1.7e9 + n) for n in range(count))
    return ServiceLog(tuple(lines), left_out, 0)


def test_a_technician_reads_the_log(browser: Browser, service: FakeService, server: PageServer, tmp_path: Path) -> None:
    context = browser.new_context(viewport={"width": 1440, "height": 900}, accept_downloads=True)
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    service.put(LOG, ServiceLog((), 0, 0))
    watched = opened(context, server, link_of(service.people))
    page = watched.page
    page.get_by_role("link", name="Logs").click()
    expect(page.get_by_text("No process has printed anything yet.")).to_be_visible()
    service.put(LOG, log_of(120, left_out=7))
    rows = page.locator(".log tbody tr")
    expect(rows).to_have_count(120)
    expect(rows.last).to_be_in_viewport()
    expect(page.get_by_text("7 lines were left out")).to_be_visible()

    page.get_by_label("Show").select_option("errors only")
    expect(rows).to_have_count(40)
    page.get_by_label("with the words").fill("zero")
    expect(rows).to_have_count(20)
    expect(rows.first).to_contain_text("error")
    expect(rows.first).to_contain_text("ZeroDivisionError: division by zero")
    page.get_by_role("button", name="Copy").click()
    expect(page.get_by_text("Copied.").first).to_be_visible()
    copied = page.evaluate("navigator.clipboard.readText()")
    assert copied.count("error diagnose: ZeroDivisionError: division by zero\n") == 20
    page.get_by_label("with the words").fill("nowhere")
    expect(page.get_by_text("No line fits what is chosen above.")).to_be_visible()

    page.get_by_label("with the words").fill("")
    page.get_by_label("Show").select_option("everything")
    expect(rows.last).to_be_in_viewport()
    follows = page.get_by_label("Follow the newest")
    page.get_by_role("region", name="Lines of the log").hover()
    page.mouse.wheel(0, -600)
    expect(follows).not_to_be_checked()
    service.put(LOG, log_of(121))
    expect(rows).to_have_count(121)
    expect(rows.last).not_to_be_in_viewport()
    follows.check()
    expect(rows.last).to_be_in_viewport()

    with page.expect_download() as download:
        page.get_by_role("link", name="Download the support bundle").click()
    saved = tmp_path / "bundle.zip"
    download.value.save_as(saved)
    assert download.value.suggested_filename.startswith("pslv-support-")
    with zipfile.ZipFile(saved) as bundle:
        assert "README.txt" in bundle.namelist()
    page.get_by_role("button", name="Log out").click()
    expect(page.get_by_text("Only the operator can read the log.")).to_be_visible()
    expect(page.locator(".pill")).to_contain_text(re.compile("ready|degraded"))
    assert [words for words in watched.complaints if "404" not in words] == []
    context.close()


def test_who_was_operator_until_his_session_ended_keeps_the_page(browser: Browser, service: FakeService) -> None:
    first = PageServer(service)
    first.start()
    context = browser.new_context()
    page = opened(context, first, link_of(service.people)).page
    page.goto(f"http://{first.address}/logs")
    expect(page.locator(".log tbody tr")).to_have_count(6)
    context.clear_cookies()
    first.stop()
    second = PageServer(service, int(first.address.rpartition(":")[2]))
    second.start()
    expect(page.get_by_text("Only the operator can read the log.")).to_be_visible(timeout=15_000)
    expect(page.locator(".pill")).to_contain_text(re.compile("ready|degraded"), timeout=15_000)
    context.close()
    second.stop()
