"""What a referee changes on the running service: at a frame boundary, without a session ending."""

import math
import socket
from collections.abc import Iterator

import pytest

from bench.service import RunningService, running_service
from tests.app.fake_service import wait_for
from tests.faults.test_service import listener, time_of
from vision_core.models.mirror import PAPER_MIRROR, Mirror

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]
OTHER = Mirror(5.2, 0.0165, 90000.0)


@pytest.fixture(scope="module")
def service() -> Iterator[RunningService]:
    with running_service() as started:
        yield started


def edges(message: bytes) -> list[tuple[str, int]]:
    """Type and pixels of each direction."""
    text = message.decode().partition("((edge) ")[2].partition(")")[0]
    return [(text[at], int(text[at + 1 : at + 3], 16)) for at in range(0, len(text), 3)]


def changed(service: RunningService, method: str, path: str, body: object = None) -> int:
    """Make a change; returns its revision when it is in effect."""
    code, change = service.request(method, f"/api/v1{path}", body)
    assert code in (200, 201), change
    return int(change["revision"])


def goal_letters(client: socket.socket) -> set[tuple[str, str]]:
    """Which goal is seen in which half of the picture, over some views: ("u", "front")."""
    seen = set()
    for _ in range(5):
        for direction, (letter, _px) in enumerate(edges(client.recv(4096))):
            if letter in "uv":
                seen.add((letter, "front" if math.cos(math.radians(direction)) > 0.0 else "back"))
    return seen


def test_sides_are_swapped_without_a_session_ending(service: RunningService) -> None:
    client, server = listener(service, "blue", 1)
    with client:
        before = time_of(client.recv(4096))
        letters = {letter for letter, _ in goal_letters(client)}
        changed(service, "POST", "/match/swap_sides", {})
        field = service.get("/api/v1/field")[1]
        swapped: set[str] = set()
        for _ in range(60):
            message, sender = client.recvfrom(4096)
            assert sender == server
            assert time_of(message) > before
            before = time_of(message)
            swapped |= {letter for letter, _ in edges(message) if letter in "uv"}
        client.sendto(b"(bye)", server)
    assert letters <= {"u", "v"}
    assert swapped <= {"u", "v"}
    left = {s["kind"] for s in field["segments"] if s["kind"] in (2, 3) and s["x1_m"] < 0.0}
    assert left == {3}, "yellow's goal is the left one now"
    status = service.get("/api/v1/match")[1]
    assert status["blue_defends"] == "right"


def test_the_mirror_of_one_team_changes_between_two_frames(service: RunningService) -> None:
    blue, blue_server = listener(service, "blue", 2)
    yellow, yellow_server = listener(service, "yellow", 2)
    with blue, yellow:
        blue.recv(4096)
        changed(service, "PUT", "/mirrors/blue", {"a": OTHER.a, "b": OTHER.b, "c": OTHER.c})

        def asked(client: socket.socket, server: tuple[str, int]) -> Mirror:
            client.sendto(b"(mirror)", server)
            while not (message := client.recv(4096)).startswith(b"(mirror "):
                pass
            a, b, c = map(float, message.decode().strip("()").split()[1:])
            return Mirror(a, b, c)

        wait_for(lambda: asked(blue, blue_server) == OTHER)
        assert asked(yellow, yellow_server) == PAPER_MIRROR
        farthest = max(px for letter, px in edges(blue.recv(4096)) if letter != "-")
        assert farthest <= OTHER.horizon_px
        blue.sendto(b"(bye)", blue_server)
        yellow.sendto(b"(bye)", yellow_server)
    changed(service, "DELETE", "/mirrors/blue")


def test_a_client_that_is_disconnected_is_told_and_may_come_again(service: RunningService) -> None:
    client, _ = listener(service, "yellow", 3)
    with client:
        client.recv(4096)

        wait_for(
            lambda: ("yellow", 3) in [(c["team"], c["number"]) for c in service.get("/api/v1/clients")[1]["connected"]]
        )
        assert service.request("DELETE", "/api/v1/clients/yellow/3")[0] == 204
        while (message := client.recv(4096)) != b"(error not_connected)":
            assert message.startswith(b"(see ")
        client.sendto(b"(init yellow 3)", ("127.0.0.1", service.udp_port))
        assert client.recv(4096) == b"(init yellow 3 play_on)"


def test_a_client_from_another_address_waits_is_admitted_and_withdrawn(service: RunningService) -> None:
    service.request("POST", "/api/v1/refusals", {"address": "127.0.0.2"})
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.bind(("127.0.0.2", 0))
        client.settimeout(30.0)

        def waits() -> list[tuple[str, str, int]]:
            client.sendto(b"(init blue 4)", ("127.0.0.1", service.udp_port))
            waiting = service.get("/api/v1/clients")[1]["waiting"]
            return [(w["address"], w["error"], w["number"]) for w in waiting if w["address"] == "127.0.0.2"]

        wait_for(lambda: ("127.0.0.2", "not_admitted", 4) in waits())
        while client.recv(4096) != b"(error not_admitted)":
            pass  # what came before the refusal took effect
        changed(service, "POST", "/admissions", {"network": "127.0.0.2", "team": "blue", "number": 4})

        client.settimeout(0.5)

        def is_served() -> bool:
            """An init that arrives before the admission takes effect is refused, and that is told once in 5 s."""
            client.sendto(b"(init blue 4)", ("127.0.0.1", service.udp_port))
            try:
                return client.recv(4096).startswith((b"(init blue 4", b"(see "))
            except TimeoutError:
                return False

        wait_for(is_served)


def test_the_play_mode_is_told(service: RunningService) -> None:
    changed(service, "PATCH", "/match", {"play_mode": "before_kick_off"})
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.settimeout(30.0)

        def told() -> bool:
            client.sendto(b"(init yellow 1)", ("127.0.0.1", service.udp_port))
            while not (reply := client.recv(4096)).startswith(b"(init"):
                pass
            return reply == b"(init yellow 1 before_kick_off)"

        wait_for(told)
    changed(service, "PATCH", "/match", {"play_mode": "play_on"})
