"""What the operator is shown of refused requests."""

from vision_core.clock import Instant, ManualClock
from vision_core.net.refusals import MAX_KEPT, SHOWN_S, WAITING_S, Refusals
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.events import RequestRefused
from vision_core.protocol.lifecycle import Peer
from vision_core.rtdb.infos import RefusedRequest
from vision_core.types.objects import Team

LAPTOP = Peer("192.168.1.9", 5000)


def waits(number: int = 3, peer: Peer = LAPTOP) -> RequestRefused:
    return RequestRefused(peer, ErrorCode.NOT_ADMITTED, Team.BLUE, number)


def test_the_same_request_is_counted() -> None:
    clock, refusals = ManualClock(Instant(1)), Refusals()
    for _ in range(3):
        refusals.note(waits(), clock.now())
        clock.advance(1.0)
    refusals.note(waits(4), clock.now())
    first = RefusedRequest("192.168.1.9", 5000, Team.BLUE, 3, "not_admitted", Instant(1), Instant(2_000_000_001), 3)
    assert refusals.recent(clock.now())[0] == first
    assert [refused.number for refused in refusals.recent(clock.now())] == [3, 4]


def test_who_waits_to_be_admitted_stays_longer_than_a_mistake() -> None:
    clock, refusals = ManualClock(Instant(1)), Refusals()
    refusals.note(waits(), clock.now())
    refusals.note(RequestRefused(LAPTOP, ErrorCode.ILLEGAL_FORM), clock.now())
    assert len(refusals.recent(clock.now())) == 2
    clock.advance(SHOWN_S + 1.0)
    assert [refused.error for refused in refusals.recent(clock.now())] == ["not_admitted"]
    clock.advance(WAITING_S)
    assert refusals.recent(clock.now()) == ()


def test_one_address_does_not_push_out_the_others() -> None:
    clock, refusals = ManualClock(Instant(1)), Refusals()
    refusals.note(waits(), clock.now())
    for port in range(1000):
        refusals.note(waits(peer=Peer("10.0.0.1", port)), clock.now())
    kept = refusals.recent(clock.now())
    assert len(kept) == MAX_KEPT
    assert kept[0].address == LAPTOP.host
