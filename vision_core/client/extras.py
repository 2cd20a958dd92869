"""What follows the ball in a ``see``, as values: the extras that a client has asked for. A damaged one is none."""

import math
from dataclasses import dataclass

from vision_core.clock import US_PER_S
from vision_core.protocol.messages import See

PERCENT = 100.0


@dataclass(frozen=True, slots=True)
class Extras:
    """None, or no flags, for what was not asked for, and from a server of version 1."""

    seq: int | None = None
    """Number of the camera's image: a gap is a lost datagram, unless the options ask for a rate."""
    server_age_s: float | None = None
    """From the grab of the image until the view was written: the lag A of the paper's figure 8."""
    sent_s: float | None = None
    """When the view was written, in the time of ``View.time_s``."""
    confidence: float | None = None
    """How sure the server is of the robot, 0..1."""
    flags: frozenset[str] = frozenset()
    """overlap, partial, predicted, nopose: docs/protocol.md says when. nopose comes without being asked for."""


NO_EXTRAS = Extras()


def extras_from(see: See) -> Extras:
    """The extras of a message."""
    if not see.extras:
        return NO_EXTRAS
    seq, age_us, sent_s, percent = (_number(see, name) for name in ("seq", "age", "sent", "conf"))
    return Extras(
        seq=None if seq is None else int(seq),
        server_age_s=None if age_us is None else age_us / US_PER_S,
        sent_s=sent_s,
        confidence=None if percent is None else percent / PERCENT,
        flags=frozenset(see.extras.get("flags", ())),
    )


def _number(see: See, name: str) -> float | None:
    words = see.extras.get(name, ())
    try:
        value = float(words[0]) if words else math.nan
    except ValueError:
        return None
    return value if math.isfinite(value) else None
