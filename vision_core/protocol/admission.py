"""Addresses that may connect: those that the settings list, and in practice those of the server's own computer.

A rule may admit an address for the robots of one team, or for one robot. Open practice admits every address of the
local network. An address that is refused may not connect, whatever admits it.
"""

import ipaddress
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

from vision_core.errors import SettingsError
from vision_core.types.objects import Team

IPAddress = ipaddress.IPv4Address | ipaddress.IPv6Address
IPNetwork = ipaddress.IPv4Network | ipaddress.IPv6Network

LOCAL = tuple(
    map(
        ipaddress.ip_network,
        ("10.0.0.0/8", "172.16.0.0/12", "192.168.0.0/16", "169.254.0.0/16", "fc00::/7", "fe80::/10"),
    )
)
"""Addresses of local networks (RFC 1918, 3927, 4193, 4291): no router of the Internet forwards to them."""


@dataclass(frozen=True, slots=True)
class Rule:
    """Addresses that may connect, and as which robots."""

    network: IPNetwork
    team: Team | None
    """None: of both teams."""
    number: int | None
    """None: of any number."""

    def admits_as(self, team: Team, number: int) -> bool:
        """Does it hold for this robot?"""
        return self.team in (None, team) and self.number in (None, number)


@dataclass(frozen=True, slots=True)
class Admission:
    """Which addresses may connect, and as which robots."""

    networks: tuple[IPNetwork, ...] = ()
    """May connect as every robot."""
    rules: tuple[Rule, ...] = ()
    refused: tuple[IPNetwork, ...] = ()
    loopback: bool = True
    """Programs on the server's own computer may connect as every robot."""
    open_practice: bool = False
    """So may every address of a local network."""

    @staticmethod
    def from_subnets(subnets: Iterable[str]) -> "Admission":
        """From addresses or subnets as text, ``192.168.1.0/24``. Raises SettingsError naming the first illegal one."""
        networks = []
        for subnet in subnets:
            try:
                networks.append(ipaddress.ip_network(subnet))
            except ValueError as error:
                accepted = "an address or a subnet, 192.168.1.0/24"
                raise SettingsError(f"admission.subnets {subnet!r}", found=str(error), accepted=accepted) from None
        return Admission(tuple(networks))

    @staticmethod
    def from_texts(
        subnets: Iterable[str], rules: Iterable[tuple[str, Team | None, int | None]], refused: Iterable[str]
    ) -> "Admission":
        """From networks as text, as ``from_subnets``; rules: each with team and number, or None for all."""
        parsed = (Rule(_network(network), team, number) for network, team, number in rules)
        return Admission(Admission.from_subnets(subnets).networks, tuple(parsed), tuple(map(_network, refused)))

    def admits(self, host: str) -> bool:
        """May this address connect as some robot? False for text that is not an IP address."""
        address = _address(host)
        return address is not None and (self._admits_all(address) or any(self._rules_of(address)))

    def admits_as(self, host: str, team: Team, number: int) -> bool:
        """May this address connect as this robot?"""
        address = _address(host)
        if address is None:
            return False
        return self._admits_all(address) or any(rule.admits_as(team, number) for rule in self._rules_of(address))

    def is_guest(self, host: str, team: Team, number: int) -> bool:
        """Does nothing but the open practice admit this address as this robot?"""
        return self.open_practice and not replace(self, open_practice=False).admits_as(host, team, number)

    def _admits_all(self, address: IPAddress) -> bool:
        known = (
            (self.loopback and address.is_loopback)
            or any(address in network for network in self.networks)
            or (self.open_practice and any(address in network for network in LOCAL))
        )
        return known and not self._refuses(address)

    def _rules_of(self, address: IPAddress) -> Iterator[Rule]:
        if not self._refuses(address):
            yield from (rule for rule in self.rules if address in rule.network)

    def _refuses(self, address: IPAddress) -> bool:
        return any(address in network for network in self.refused)


def _network(text: str) -> IPNetwork:
    return Admission.from_subnets([text]).networks[0]


@lru_cache(maxsize=4096)
def _address(host: str) -> IPAddress | None:
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return None
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    return mapped or address
