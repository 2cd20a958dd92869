"""Proofs that a client brings: a cookie, that its address is its own; a team's key, that it belongs to the team.

A cookie is stateless (as in RFC 9000, 8.1): whoever sends ``init`` is sent a cookie, and returns it in the next one. A
datagram with a forged sender never sees it. The server keeps no memory of the cookies that it gave.
"""

import hashlib
import hmac
import secrets
from dataclasses import dataclass

from vision_core.clock import NS_PER_S, Instant

COOKIE_DIGITS = 24
"""Hexadecimal digits of a cookie: the first 96 bits of an HMAC-SHA256."""
EPOCH_S = 60
"""Each secret is used for so long; its cookies hold for one epoch more."""
MAX_KEY = 128
"""Longest key of a team [characters]."""


@dataclass(frozen=True, slots=True, repr=False)
class Proof:
    """What came with an ``init``. It has no representation, so that no key reaches a log."""

    cookie: str = ""
    """24 hexadecimal digits; empty: none."""
    key: str = ""
    """Empty: none."""

    def __repr__(self) -> str:
        return f"Proof(cookie={bool(self.cookie)}, key={bool(self.key)})"


NO_PROOF = Proof()


class Cookies:
    """Makes and checks cookies; its secrets are drawn anew every epoch and never leave the process."""

    def __init__(self) -> None:
        self._epoch = 0
        self._secrets: tuple[bytes, ...] = ()
        """Of the present epoch and the one before."""

    def make(self, host: str, port: int, now: Instant) -> str:
        """The cookie for a client's address and port."""
        self._rotate(now)
        return _cookie(self._secrets[0], host, port)

    def holds(self, cookie: str, host: str, port: int, now: Instant) -> bool:
        """Was this cookie made for this address and port, in this epoch or the one before?"""
        self._rotate(now)
        return sum(hmac.compare_digest(_cookie(secret, host, port), cookie) for secret in self._secrets) > 0

    def _rotate(self, now: Instant) -> None:
        epoch = now // (EPOCH_S * NS_PER_S)
        if epoch == self._epoch and self._secrets:
            return
        before = self._secrets[:1] if epoch == self._epoch + 1 else ()
        self._epoch, self._secrets = epoch, (secrets.token_bytes(32), *before)


def _cookie(secret: bytes, host: str, port: int) -> str:
    return hmac.new(secret, f"{host} {port}".encode("ascii"), hashlib.sha256).hexdigest()[:COOKIE_DIGITS]


def key_digest(key: str) -> str:
    """What is kept of a team's key: it is random and long, so a plain SHA-256 hides it."""
    return hashlib.sha256(key.encode("utf-8")).hexdigest()


def holds_key(key: str, digest: str | None) -> bool:
    """Is it the key of a digest? digest None: the team has no key. Takes the same time for every wrong key."""
    return digest is not None and hmac.compare_digest(key_digest(key), digest)
