"""Helper process: a bounded flood of datagrams at a port of loopback.

    python -m bench.flooder PORT KIND RATE SECONDS

KIND is a key of KINDS. The datagrams come from the addresses of their kind, RATE a second, for SECONDS. Prints JSON:
``{"sent", "seconds"}``. An ordinary process: it takes no time from real-time tasks but through the kernel.
"""

import ipaddress
import json
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from socket import AF_INET, SOCK_DGRAM, socket

from vision_core.clock import NS_PER_S

LOOPBACK = "127.0.0.1"
STRANGERS = "127.9.0.0/24"
"""Addresses of loopback that the benchmark's settings refuse, as those of another network are."""
ADMITTED = "127.8.0.1/32"
TURN_S = 0.001
MAX_DATAGRAMS = 2_000_000
COSTLIEST = b"".join(b"(init blue %d (mirror 4.01%02d 0.0125935 90000))" % (number, number) for number in range(1, 17))
"""The form that takes the parser longest: 16 inits, each with a mirror."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of flood."""

    network: str
    """Its sender's addresses."""
    datagram: bytes


KINDS = {
    "inits of one admitted address": Kind(ADMITTED, b"(init blue 3)"),
    "inits of strangers": Kind(STRANGERS, b"(init blue 3)"),
    "16 inits with mirrors of one admitted address": Kind(ADMITTED, COSTLIEST),
    "1 kB of strangers": Kind(STRANGERS, b"(" + b"x" * 1000 + b")"),
}


def main(port: int, kind: str, rate_hz: int, seconds: float) -> None:
    """Send the flood and print how much was sent."""
    flood = KINDS[kind]
    with ExitStack() as stack:
        senders = [stack.enter_context(_sender(str(host))) for host in ipaddress.ip_network(flood.network)]
        sent = _send(senders, flood.datagram, (LOOPBACK, port), rate_hz, seconds)
    print(json.dumps({"sent": sent, "seconds": seconds}))


def _sender(host: str) -> socket:
    opened = socket(AF_INET, SOCK_DGRAM)
    opened.bind((host, 0))
    opened.setblocking(False)
    return opened


def _send(senders: list[socket], datagram: bytes, target: tuple[str, int], rate_hz: int, seconds: float) -> int:
    """Send in turns of a millisecond, each sender after the other. Returns the number of datagrams."""
    sends: list[Callable[..., int]] = [sender.sendto for sender in senders]
    sent, began = 0, time.monotonic_ns()
    while (elapsed_s := (time.monotonic_ns() - began) / NS_PER_S) < seconds and sent < MAX_DATAGRAMS:
        due = min(round(elapsed_s * rate_hz), sent + rate_hz // 100)  # after a pause it does not catch up
        for number in range(sent, due):
            try:
                sends[number % len(sends)](datagram, target)
            except OSError:  # an answer that was refused, or a full buffer
                continue
        sent = max(due, sent)
        time.sleep(TURN_S)
    return sent


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2], int(sys.argv[3]), float(sys.argv[4]))
