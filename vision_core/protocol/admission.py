"""Addresses that may connect: those of the server's own computer, and those that the settings list."""

import ipaddress
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from vision_core.errors import SettingsError

IPAddress = ipaddress.IPv4Address | ipaddress.IPv6Address
IPNetwork = ipaddress.IPv4Network | ipaddress.IPv6Network


@dataclass(frozen=True, slots=True)
class Admission:
    """Admits loopback addresses and the addresses of a list of networks."""

    networks: tuple[IPNetwork, ...] = ()

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

    def admits(self, host: str) -> bool:
        """May this address connect? False for text that is not an IP address."""
        address = _address(host)
        if address is None:
            return False
        return address.is_loopback or any(address in network for network in self.networks)


@lru_cache(maxsize=4096)
def _address(host: str) -> IPAddress | None:
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return None
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    return mapped or address
