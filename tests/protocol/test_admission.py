"""Addresses that may connect."""

import pytest

from tests.protocol.samples import SUBNETS
from vision_core.errors import SettingsError
from vision_core.protocol.admission import Admission

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
