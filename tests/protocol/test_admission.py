"""Addresses that may connect."""

from dataclasses import replace

import pytest

from tests.protocol.samples import SUBNETS
from vision_core.errors import SettingsError
from vision_core.protocol.admission import Admission
from vision_core.types.objects import Team

ADMISSION = Admission.from_subnets([*SUBNETS, "192.168.7.5"])


@pytest.mark.parametrize(
    "host",
    ["127.0.0.1", "127.8.8.8", "::1", "::ffff:127.0.0.1", "10.0.0.9", "::ffff:10.0.0.9", "fd00::5", "192.168.7.5"],
)
def test_loopback_and_the_configured_may(host: str) -> None:
    assert ADMISSION.admits(host)


@pytest.mark.parametrize("host", ["10.0.1.9", "192.168.7.6", "8.8.8.8", "fd01::5", "::ffff:8.8.8.8", "robot", ""])
def test_others_may_not(host: str) -> None:
    assert not ADMISSION.admits(host)


@pytest.mark.parametrize("subnet", ["10.0.0.0/33", "10.0.0.1/24", "robots", ""])
def test_a_bad_subnet_is_named(subnet: str) -> None:
    with pytest.raises(SettingsError, match=r"admission\.subnets"):
        Admission.from_subnets([subnet])


RULES = Admission.from_texts(
    ["10.0.0.0/24"],
    [("192.168.7.5", Team.BLUE, 3), ("192.168.7.6", Team.YELLOW, None), ("192.168.8.0/24", None, None)],
    ["10.0.0.66", "192.168.8.128/25"],
)


@pytest.mark.parametrize(
    ("host", "robots"),
    [
        ("10.0.0.9", {"blue 3", "blue 4", "yellow 3"}),
        ("192.168.7.5", {"blue 3"}),
        ("192.168.7.6", {"yellow 3"}),
        ("192.168.8.1", {"blue 3", "blue 4", "yellow 3"}),
        ("192.168.8.200", set()),
        ("10.0.0.66", set()),
        ("8.8.8.8", set()),
    ],
)
def test_a_rule_admits_as_some_robots_and_a_refusal_wins(host: str, robots: set[str]) -> None:
    asked = [(Team.BLUE, 3), (Team.BLUE, 4), (Team.YELLOW, 3)]
    assert {f"{team} {number}" for team, number in asked if RULES.admits_as(host, team, number)} == robots
    assert RULES.admits(host) == bool(robots)


def test_this_computer_can_be_refused_too() -> None:
    assert not Admission.from_texts([], [], ["127.0.0.0/8"]).admits("127.0.0.1")


OPEN = Admission(loopback=False, open_practice=True, refused=RULES.refused)


@pytest.mark.parametrize("host", ["10.1.2.3", "172.31.0.1", "192.168.9.9", "169.254.3.4", "fd00::5", "fe80::1"])
def test_open_practice_admits_the_local_network_as_a_guest(host: str) -> None:
    assert OPEN.admits_as(host, Team.BLUE, 3)
    assert OPEN.is_guest(host, Team.BLUE, 3)


@pytest.mark.parametrize("host", ["8.8.8.8", "172.32.0.1", "203.0.113.7", "2001:db8::1", "127.0.0.1", "10.0.0.66"])
def test_open_practice_admits_nobody_else(host: str) -> None:
    assert not OPEN.admits_as(host, Team.BLUE, 3)


def test_who_is_admitted_is_no_guest_of_the_open_practice() -> None:
    admission = replace(RULES, open_practice=True)
    assert not admission.is_guest("192.168.7.5", Team.BLUE, 3)
    assert admission.is_guest("192.168.7.5", Team.BLUE, 4)


def test_in_a_match_this_computer_is_admitted_like_any_other() -> None:
    assert not Admission(loopback=False).admits("127.0.0.1")
    assert Admission.from_subnets(["127.0.0.1"]).admits("127.0.0.1")
