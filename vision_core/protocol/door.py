"""Who may speak, and who may have a robot. The cheapest question comes first: a datagram is parsed only after it.

Strangers, whose address is not admitted, share one small budget. They get at most one reply per datagram, never longer
than three times the datagram, and leave nothing behind but a line in a bounded table.
"""

from typing import TypeAlias

from vision_core.clock import Instant
from vision_core.errors import SettingsError
from vision_core.models.mirror import check_span
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.events import Event, Sender, answer, refusal
from vision_core.protocol.lifecycle import Peer
from vision_core.protocol.messages import Challenge, ErrorReply, Init, MonitorInit, Reconnect, Request
from vision_core.protocol.options import Options
from vision_core.protocol.proofs import Cookies, holds_key
from vision_core.protocol.rate_limits import (
    AMPLIFICATION,
    DATAGRAM,
    SESSION_DATAGRAM_RATE,
    Rate,
    RateLimiter,
    RateLimiterTable,
    SharedBudget,
    TokenBucket,
)
from vision_core.protocol.rules import SessionRules

ALL_DATAGRAMS_RATE = Rate(400.0, 400)
"""Datagrams of all admitted addresses that have no session."""
ALL_INITS_RATE = Rate(100.0, 100)
"""Inits of all addresses; a session that repeats its init is not counted."""
STRANGER_RATE = Rate(50.0, 50)
"""Datagrams of addresses that are not admitted: as many are read, the others are dropped unread."""

Opening: TypeAlias = Init | Reconnect | MonitorInit
"""A command of a client that has nothing yet; it may bring a proof."""


class Door:
    """The limits and proofs of clients that have no session yet."""

    def __init__(self, rules: SessionRules) -> None:
        self.rules = rules
        self._cookies = Cookies()
        self._limiters = RateLimiterTable()
        self._stranger_limiters = RateLimiterTable()  # a table of its own: strangers cannot push others out of theirs
        self._datagrams = SharedBudget("datagrams", ALL_DATAGRAMS_RATE)
        self._inits = SharedBudget("inits", ALL_INITS_RATE)
        self._strangers = TokenBucket(STRANGER_RATE)

    def limiter(self, host: str) -> RateLimiter:
        """The budgets of an address."""
        return self._limiters.of(host)

    def lets_in(self, limiter: RateLimiter, now: Instant, *, known: bool) -> bool:
        """May a datagram of an admitted address be read? known: it is of a session, whose limiter it is."""
        if known:
            return limiter.take(DATAGRAM, now, SESSION_DATAGRAM_RATE)
        return limiter.take(DATAGRAM, now) and self._datagrams.take(limiter, now)

    def takes_init(self, sender: Sender) -> bool:
        """Is there a place in the budget of all inits?"""
        return self._inits.take(self._limiters.of(sender.peer.host), sender.now)

    def challenge(self, command: Opening, nul: bool, sender: Sender) -> list[Event]:
        """The cookie that a client has to return; nothing if it has returned one, or speaks version 1."""
        if isinstance(command, Init) and command.options.version == 1:
            return []
        peer, now = sender.peer, sender.now
        if self._cookies.holds(command.proof.cookie, peer.host, peer.port, now):
            return []
        return [answer(Challenge(self._cookies.make(peer.host, peer.port, now)), nul, peer, sender.endpoint)]

    def holds_key(self, command: Opening) -> bool:
        """Does a command bring the key that it needs, its team's or the monitors'?

        A client of version 1 proves no address, so its key is not read.
        """
        if isinstance(command, Init) and command.options.version == 1:
            return False
        digest = self.rules.monitor_key if isinstance(command, MonitorInit) else self.rules.keys.get(command.team)
        return holds_key(command.proof.key, digest)

    def admits(self, init: Init, peer: Peer, *, has_key: bool) -> bool:
        """May this address have this robot?"""
        return has_key or self.rules.admission.admits_as(peer.host, init.team, init.number)

    def admits_monitor(self, peer: Peer, *, has_key: bool) -> bool:
        """May this address see the whole field? In a match only with the referee's key."""
        return has_key or (self.rules.fixed is None and self.rules.admission.admits(peer.host))

    def refuses(self, init: Init, peer: Peer, *, has_key: bool) -> ErrorCode | None:
        """Why a client may not have what it asks for; None: it may."""
        if init.number > self.rules.numbers:
            return ErrorCode.ILLEGAL_NUMBER
        if init.proof.key and not has_key:
            return ErrorCode.WRONG_KEY
        if not self.admits(init, peer, has_key=has_key):
            return ErrorCode.NOT_ADMITTED
        return None if self.shows_field(init.options) else ErrorCode.ILLEGAL_MIRROR

    def shows_field(self, options: Options) -> bool:
        """Does the mirror that a client asks for reach over the field?"""
        if options.mirror is None:
            return True
        try:
            check_span(options.mirror, self.rules.diagonal_m)
        except SettingsError:
            return False
        return True

    def hears_stranger(self, now: Instant) -> bool:
        """May a stranger's datagram be read?"""
        return self._strangers.take(now)

    def turn_away(self, request: Request, length: int, sender: Sender) -> list[Event]:
        """An error at most once in 5 s, or silence. length: of the datagram [bytes]."""
        peer = sender.peer
        refused = refusal(ErrorCode.NOT_ADMITTED, peer, request.commands[0])
        reply = answer(ErrorReply(ErrorCode.NOT_ADMITTED), request.nul, peer, sender.endpoint)
        limiter = self._stranger_limiters.of(peer.host)
        too_long = len(reply.data) > AMPLIFICATION * length
        is_silent = too_long or not limiter.may_complain(ErrorCode.NOT_ADMITTED, sender.now)
        return [refused] if is_silent else [reply, refused]
