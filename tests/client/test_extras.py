"""What follows the ball in a see, as fields of the view; what is damaged or missing is none."""

import pytest

from vision_core.client.extras import NO_EXTRAS, Extras, extras_from
from vision_core.client.view import view_from_see
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.protocol.answers import decode_message
from vision_core.protocol.messages import See
from vision_core.protocol.options import PAPER_OPTIONS


def see(extras: bytes) -> See:
    message = decode_message(b"(see 20306.148 ((edge) w2c) ((ball) 61 121 3)%s)" % extras)
    assert isinstance(message, See)
    return message


def test_each_extra_is_a_field_of_the_view() -> None:
    message = see(b" ((seq) 1234) ((age) 5210) ((sent) 20306.153210) ((conf) 97) ((flags) partial predicted)")
    view = view_from_see(message, PAPER_OPTIONS, PAPER_MIRROR)
    assert view.seq == 1234
    assert view.extras.server_age_s == pytest.approx(0.00521)
    assert view.sent_s == 20306.153210
    assert view.confidence == pytest.approx(0.97)
    assert view.flags == {"partial", "predicted"}
    assert view.is_seen


def test_without_extras_there_are_none() -> None:
    view = view_from_see(see(b""), PAPER_OPTIONS, PAPER_MIRROR)
    assert view.extras is NO_EXTRAS
    assert (view.seq, view.sent_s, view.confidence, view.flags, view.lag) == (None, None, None, frozenset(), None)


def test_no_flag_is_not_no_pose() -> None:
    assert extras_from(see(b" ((flags))")) == NO_EXTRAS
    assert not view_from_see(see(b" ((flags) nopose)"), PAPER_OPTIONS, PAPER_MIRROR).is_seen


@pytest.mark.parametrize("damaged", [b" ((seq) many)", b" ((seq))", b" ((age) nan)", b" ((conf) inf)", b" ((sent) -)"])
def test_a_damaged_extra_is_none(damaged: bytes) -> None:
    assert extras_from(see(damaged)) == NO_EXTRAS


def test_a_later_version_may_add_others() -> None:
    assert extras_from(see(b" ((speed) 3 4) ((seq) 8)")) == Extras(seq=8)
