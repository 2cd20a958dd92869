"""Every rule of ``pslv conformance`` is broken by some server, and that is found."""

import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from tests.examination.hall import Altered, Hall
from tests.net.serving import running
from vision_core.examination.conformance.examine import RULES, examine
from vision_core.examination.conformance.probe import Probe
from vision_core.examination.conformance.rule import Verdict
from vision_core.examination.way import place_of
from vision_core.protocol import proofs

pytestmark = pytest.mark.slow

SESSION = "vision_core.protocol.session"
PROBE = "vision_core.examination.conformance.probe"


def replaced(old: bytes, new: bytes) -> Callable[[bytes], bytes]:
    return lambda datagram: datagram.replace(old, new)


def substituted(pattern: bytes, new: bytes) -> Callable[[bytes], bytes]:
    return lambda datagram: re.sub(pattern, new, datagram)


def silent_about(word: bytes) -> Callable[[bytes], bytes | None]:
    return lambda datagram: None if word in datagram else datagram


def as_ping(word: bytes) -> Callable[[bytes], bytes]:
    return lambda datagram: b"(ping)" if word in datagram else datagram


def second_init_elsewhere() -> Callable[[bytes], bytes]:
    inits: Iterator[bytes] = iter([b"(init blue 1)"])
    return lambda datagram: datagram if datagram == next(inits, b"") else datagram[:-1] + b" (port same))"


def dies_of(byte: bytes) -> Callable[[bytes], bytes | None]:
    died: list[bytes] = []

    def heard(datagram: bytes) -> bytes | None:
        died.extend([datagram] if byte in datagram else [])
        return None if died else datagram

    return heard


BROKEN: dict[str, Altered | tuple[str, Any]] = {
    "init-is-answered-with-the-play-mode": Altered(said=replaced(b"play_on", b"playing")),
    "other-spellings-of-init-are-understood": Altered(heard=silent_about(b"(team ")),
    "nul-is-answered-with-nul": Altered(said=replaced(b"\0", b"")),
    "a-repeated-init-is-answered-by-the-same-session": Altered(heard=second_init_elsewhere()),
    "mistakes-in-init-are-named-each-time": Altered(said=replaced(b"illegal_option", b"illegal_form")),
    "what-is-no-command-gets-no-answer": Altered(heard=substituted(rb"\Ainit (.*)\Z", rb"(init \1)")),
    "an-illegal-form-is-named-once": (f"{SESSION}.LIMITED_ERRORS", frozenset()),
    "unknown-options-are-illegal-in-version-1": Altered(heard=replaced(b" (novelty 1)", b"")),
    "a-datagram-of-any-bytes-does-no-harm": Altered(heard=dies_of(b"\xff")),
    "answers-and-views-come-from-another-port": Altered(heard=replaced(b"(init blue 1)", b"(init blue 1 (port same))")),
    "the-same-port-can-be-asked-for": Altered(heard=replaced(b" (port same)", b"")),
    "the-third-init-is-answered-from-the-main-port": (f"{SESSION}.UNHEARD_INITS", 99),
    "a-restarted-client-gets-its-robot": (f"{SESSION}.Sessions.refused", lambda *_: []),
    "a-program-that-runs-keeps-its-robot": (f"{SESSION}.CLAIM_S", 99.0),
    "one-socket-may-have-two-robots": Altered(said=replaced(b"(mirror blue 2 ", b"(mirror ")),
    "a-view-has-the-form-of-the-paper": Altered(seen=replaced(b") ((ball)", b")((ball)")),
    "time-grows": Altered(seen=substituted(rb"\(see [0-9.]+", b"(see 1.000")),
    "ff-is-nothing-and-nothing-is-ff": Altered(seen=replaced(b"w2cw2c)", b"w2cwff)")),
    "the-ball-is-hidden-or-somewhere": Altered(seen=substituted(rb"\(ball\) \S+", b"(ball) -1")),
    "time-has-six-decimals-if-asked": Altered(heard=replaced(b" (time us)", b"")),
    "directions-are-as-many-as-asked": Altered(heard=replaced(b"(fov 90)", b"(fov 80)")),
    "a-rate-is-kept": Altered(heard=replaced(b" (rate 5)", b"")),
    "the-mirror-is-told": Altered(said=replaced(b"(mirror 4.0187 ", b"(mirror 1.0 ")),
    "a-datagram-may-hold-several-forms": Altered(heard=substituted(rb"\)\(.*", b")")),
    "a-lag-report-gets-no-answer": Altered(heard=as_ping(b"(lag ")),
    "an-unknown-command-is-named": Altered(heard=as_ping(b"(dash ")),
    "without-a-session-there-is-no-mirror": Altered(said=replaced(b"not_connected", b"illegal_form")),
    "bye-ends-the-views": Altered(heard=as_ping(b"(bye)")),
    "an-address-is-challenged": Altered(
        said=lambda said: said.upper().replace(b"CHALLENGE", b"challenge") if b"challenge" in said else said
    ),
    "a-cookie-is-of-one-socket": (
        "vision_core.protocol.proofs._cookie",
        lambda secret, _host, _port, made=proofs._cookie: made(secret, "", 0),
    ),
    "the-answer-tells-what-the-client-has-to-know": Altered(said=replaced(b" (lease 15)", b"")),
    "a-higher-version-is-answered": Altered(heard=replaced(b"(version 99)", b"(version 0)")),
    "unknown-options-are-warned-of": Altered(said=silent_about(b"(warning ")),
    "options-change": Altered(heard=replaced(b"(set (time us))", b"(set)")),
    "extras-follow-the-ball": Altered(seen=substituted(rb" \(\(seq\) 7\)", b"")),
    "a-ping-is-answered": Altered(said=replaced(b"(pong 7)", b"(pong 8)")),
    "the-clock-is-told": Altered(heard=replaced(b"(sync 1 -5)", b"(sync 1 -6)")),
    "a-monitor-is-shown-the-field": Altered(seen=silent_about(b"(show ")),
    "a-drive-is-refused-by-name-or-not-answered": Altered(heard=replaced(b"(drive nan", b"(drive 0")),
    "a-newer-client-takes-over-and-the-older-is-told": Altered(said=silent_about(b"replaced")),
}


def test_every_rule_has_a_server_that_breaks_it() -> None:
    assert set(BROKEN) == {rule.name for rule in RULES}


@pytest.mark.parametrize("name", sorted(BROKEN))
def test_a_server_that_breaks_a_rule_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for constant, short in {"PATIENCE_S": 0.3, "ATTEMPTS": 2, "QUIET_S": 0.1}.items():
        monkeypatch.setattr(f"{PROBE}.{constant}", short)
    monkeypatch.setattr("vision_core.examination.conformance.ports.CLAIM_S", 1.5)
    monkeypatch.setattr("vision_core.examination.conformance.beyond.SHOW_S", 0.5)
    monkeypatch.setattr("vision_core.net.udp.attach_filter", lambda _: False)  # somebody else's server may have none
    how = BROKEN[name]
    if isinstance(how, tuple):
        monkeypatch.setattr(*how)
    hall = Hall(how if isinstance(how, Altered) else None)
    with running(hall):
        (found,) = examine(Probe(place_of("127.0.0.1", hall.port)), [rule for rule in RULES if rule.name == name])
    hall.close()
    assert found.verdict is Verdict.FAILED, found
    assert "expected" in found.why
    assert found.exchange
