"""A referee's evening on the running service, by keyboard alone.

First run, password, two teams, a program from another address, sides, a team's own page, undo, and everything moved to
another server.
"""

import contextlib
import json
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from app.web.auth.people_file import NAME
from bench.service import RunningService, running_service
from tests.app.fake_service import FakeService, Scene, served_page, wait_for
from tests.browser.conftest import link_of
from tests.faults.test_service import listener, time_of

pytestmark = [
    pytest.mark.browser,
    pytest.mark.slow,
    pytest.mark.timeout(400),
    pytest.mark.usefixtures("built_page"),
]
STRANGER = "127.0.0.2"
PASSWORD = "a long evening"
MOST_TABS = 150
IS_FOCUSED = "element => element === document.activeElement"


class Keyboard:
    """Operates a page with the keyboard alone: Tab, Enter, letters."""

    def press(self, target: Locator) -> None:
        """Press a button, or follow a link."""
        self._reach(target)
        target.page.keyboard.press("Enter")

    def fill(self, target: Locator, text: str) -> None:
        """Write into a field."""
        self._reach(target)
        target.page.keyboard.press("Control+A")
        target.page.keyboard.type(text)

    def choose(self, target: Locator, label: str) -> None:
        """Choose an option."""
        self._reach(target)
        target.page.keyboard.type(label)
        target.page.keyboard.press("Enter")

    def turn_to(self, tab: Locator) -> None:
        """Show another tab."""
        self._reach(tab.page.get_by_role("tab", selected=True))
        while not tab.evaluate(IS_FOCUSED):
            tab.page.keyboard.press("ArrowRight")

    @staticmethod
    def _reach(target: Locator) -> None:
        expect(target).to_be_visible()
        for _ in range(MOST_TABS):
            if target.evaluate(IS_FOCUSED):
                return
            target.page.keyboard.press("Tab")
        raise AssertionError(f"{target} is not reached by Tab")


@contextmanager
def server(folder: Path) -> Iterator[tuple[RunningService, str]]:
    """A service that nobody has used yet, and the path of the link that it prints."""
    folder.mkdir()
    with running_service(variables={"PSLV_DATABASE": str(folder)}) as service:
        yield service, link_of(folder / NAME)


def test_an_evening_by_keyboard_alone(browser: Browser, tmp_path: Path) -> None:
    hands = Keyboard()
    with server(tmp_path / "hall") as (service, path):
        service.request("POST", "/api/v1/refusals", {"address": STRANGER})  # this machine's addresses are admitted
        page = browser.new_page(accept_downloads=True)
        page.goto(service.http + path)
        first_run(page, hands)
        register(page, hands, "Cologne", "CGN")
        register(page, hands, "Bremen", "BRE")
        visit(page, hands, "Match")
        hands.choose(page.get_by_label("Team that plays blue"), "Cologne")
        expect(page.locator(".side-of.blue")).to_contain_text("Cologne")
        hands.choose(page.get_by_label("Team that plays yellow"), "Bremen")
        expect(page.locator(".side-of.yellow")).to_contain_text("Bremen")
        program_of_another_address(page, hands, service)
        sides(page, hands, service)
        team_page(browser, page, hands, service)
        undo(page, hands)
        exported = export(page, hands, tmp_path)
        page.close()
    other = FakeService(Scene())
    other.start()
    with served_page(other) as address:
        page = browser.new_page()
        page.goto(f"http://{address}{link_of(other.people)}")
        first_run(page, hands)
        import_(page, hands, exported)
        page.close()
    other.stop()


def visit(page: Page, hands: Keyboard, name: str) -> None:
    hands.press(page.get_by_role("navigation", name="Pages").get_by_role("link", name=name))
    expect(page.get_by_role("heading", level=1, name=name)).to_be_visible()


def first_run(page: Page, hands: Keyboard) -> None:
    hands.press(page.get_by_role("link", name="Set a password"))
    hands.fill(page.get_by_label("New password or PIN"), PASSWORD)
    hands.fill(page.get_by_label("Once more"), PASSWORD)
    hands.press(page.get_by_role("button", name="Set", exact=True))
    expect(page.get_by_text("The password is set.").first).to_be_visible()


def register(page: Page, hands: Keyboard, name: str, short: str) -> None:
    visit(page, hands, "Teams")
    hands.press(page.get_by_role("button", name="Register a team"))
    dialog = page.get_by_role("dialog")
    hands.fill(dialog.get_by_label("Name", exact=True), name)
    hands.fill(dialog.get_by_label("Short name"), short)
    hands.press(dialog.get_by_role("button", name="Register"))
    expect(page.get_by_role("heading", name=name)).to_be_visible()


def program_of_another_address(page: Page, hands: Keyboard, service: RunningService) -> None:
    """It knows the paper only, waits, is admitted in one click and receives views."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.bind((STRANGER, 0))
        client.settimeout(1.0)
        init = b"(init yellow 3)"
        client.sendto(init, ("127.0.0.1", service.udp_port))
        assert client.recv(4096).startswith(b"(error not_admitted")
        request = page.locator(".requests li", has_text=STRANGER)
        expect(request).to_contain_text("yellow 3")
        hands.press(request.get_by_role("button", name="✓ Admit"))
        expect(page.get_by_text(f"{STRANGER} is admitted").first).to_be_visible()
        wait_for(lambda: is_served(client, init, service))
        expect(request).to_have_count(0)
        expect(page.get_by_role("region", name="Connected programs", exact=True)).to_contain_text(STRANGER)
        client.sendto(b"(bye)", ("127.0.0.1", service.udp_port))


def is_served(client: socket.socket, init: bytes, service: RunningService) -> bool:
    """Send an init, as a program does again and again; is a view the answer?"""
    client.sendto(init, ("127.0.0.1", service.udp_port))
    with contextlib.suppress(TimeoutError):
        return any(client.recv(4096).startswith(b"(see ") for _ in range(2))
    return False


def sides(page: Page, hands: Keyboard, service: RunningService) -> None:
    """Swapped without a session ending."""
    client, session = listener(service, "blue", 1)
    with client:
        before = time_of(client.recv(4096))
        hands.press(page.get_by_role("button", name="Swap sides"))
        expect(page.locator(".side-of").first).to_contain_text("Bremen")
        message, sender = client.recvfrom(4096)
        assert sender == session
        assert time_of(message) > before
        client.sendto(b"(bye)", session)


def team_page(browser: Browser, page: Page, hands: Keyboard, service: RunningService) -> None:
    """The link with a team's key shows its robots, to somebody who has not logged in."""
    visit(page, hands, "Teams")
    team = page.locator("article", has=page.get_by_role("heading", name="Cologne"))
    hands.press(team.get_by_role("button", name="Make a key …"))
    link = page.get_by_role("dialog").locator("code").first.inner_text()
    page.keyboard.press("Escape")
    visitor = browser.new_context().new_page()
    visitor.goto(link)
    expect(visitor.get_by_role("heading", level=1)).to_have_text("Cologne")
    expect(visitor.locator(".robot-view")).to_contain_text("blue 1")
    hands.press(visitor.get_by_text("The message as it is sent"))
    expect(visitor.locator("details")).to_contain_text("(see ")
    assert visitor.request.post(f"{service.http}/api/v1/match/swap_sides", data={}).status == 403
    visitor.context.close()


def undo(page: Page, hands: Keyboard) -> None:
    """What was done last is named, taken back and done again."""
    visit(page, hands, "Match")
    hands.press(page.get_by_role("button", name="Swap sides"))
    expect(page.locator(".side-of").first).to_contain_text("Cologne")
    visit(page, hands, "Settings")
    hands.press(page.get_by_role("button", name="↶ Undo"))
    visit(page, hands, "Match")
    expect(page.locator(".side-of").first).to_contain_text("Bremen")


def export(page: Page, hands: Keyboard, folder: Path) -> Path:
    visit(page, hands, "Settings")
    hands.turn_to(page.get_by_role("tab", name="Export and import"))
    with page.expect_download() as download:
        hands.press(page.get_by_role("link", name="Save as a file"))
    path = folder / "pslv-settings.json"
    download.value.save_as(path)
    assert "Cologne" in json.dumps(json.loads(path.read_text()))
    return path


def import_(page: Page, hands: Keyboard, exported: Path) -> None:
    """A preview first, then the same teams and sides."""
    visit(page, hands, "Settings")
    hands.turn_to(page.get_by_role("tab", name="Export and import"))
    page.get_by_label("File").set_input_files(exported)  # the file dialog is the browser's own
    expect(page.get_by_text("would change:")).to_be_visible()
    hands.press(page.get_by_role("button", name="Import"))
    expect(page.get_by_text("is imported").first).to_be_visible()
    visit(page, hands, "Match")
    expect(page.locator(".side-of").first).to_contain_text("Bremen")
    expect(page.locator(".side-of").last).to_contain_text("Cologne")
