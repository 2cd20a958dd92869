"""Why no ball is found, for people. Slow, and never on the hot path."""

from collections import Counter

from vision_core.objects.ball.finder import (
    GATES,
    OFF_FIELD,
    ON_ROBOT,
    PASSED,
    TOO_LARGE,
    TOO_LONG,
    TOO_RAGGED,
    TOO_SMALL,
    WRONG_SURROUNDINGS,
    BallFinder,
    Candidate,
    judged,
    stopping_gate,
)
from vision_core.objects.observation import Observation
from vision_core.types.reasons import Reason
from vision_core.types.tables import Table


def explain_balls(
    seen: Observation, robots: Table, robot_count: int, finder: BallFinder, color: str
) -> tuple[Reason, ...]:  # fmt: skip
    """How many blobs each gate of ``find_balls`` stopped, and the best of them with its numbers; () with a ball.

    Takes the arguments of ``find_balls``; color: name of the ball's class. The best blob is the one that passed the
    most gates, and of several the one with the highest confidence.
    """
    blobs = [blob for blob in seen.blobs[: seen.blob_count] if blob["color"] == finder.color]
    if not blobs:
        return (Reason(f"no ball: no {color} blob", f"Lay a ball on the field, or widen color class {color}."),)
    candidates = [judged(blob, seen, robots, robot_count, finder) for blob in blobs]
    gates = [stopping_gate(candidate, finder) for candidate in candidates]
    if PASSED in gates:
        return ()
    stopped = Counter(gates)
    parts = [f"{stopped[gate]} {name}" for gate, name in enumerate(GATES) if stopped[gate]]
    best = max(range(len(blobs)), key=lambda row: (gates[row], candidates[row].confidence))
    place = f"({blobs[best]['x_px']:.0f}, {blobs[best]['y_px']:.0f}) px"
    count = f"{len(blobs)} {color} {'blob' if len(blobs) == 1 else 'blobs'}"
    found, accepted = found_and_accepted(gates[best], candidates[best], finder)
    numbers = f"the best candidate for the ball, at {place}, {found}; accepted: {accepted}"
    return (
        Reason(f"no ball: {count}: {', '.join(parts)}", "Lay the ball where nothing of its color is near."),
        Reason(numbers, f"If that is the ball, change the limit that stops it; if not, look for {color} that is none."),
    )


def found_and_accepted(gate: int, blob: Candidate, finder: BallFinder) -> tuple[str, str]:
    """What stopped a blob at a gate: what it has or where it lies, and what is accepted there."""
    area = f"has {blob.area_ratio:.2g} times the area expected from camera height and ball radius"
    x_m, y_m = finder.extents_m[:2].tolist()
    texts = {
        OFF_FIELD: (f"lies at ({blob.x_m:.2f}, {blob.y_m:.2f}) m", f"up to ±{x_m:.2f} m, ±{y_m:.2f} m, or in a goal"),
        TOO_SMALL: (area, f"{finder.min_area:g} or more"),
        TOO_LARGE: (area, f"{finder.max_area:g} or less"),
        TOO_LONG: (f"is {blob.elongation:.1f} times as long as wide", f"{finder.max_elongation:g} or less"),
        TOO_RAGGED: (f"fills {blob.fill:.2f} of its bounding box", f"{finder.min_fill:g} or more"),
        ON_ROBOT: (
            f"lies {blob.robot_m * 1000.0:.0f} mm from a robot's center",
            f"{finder.inside_robot_m * 1000.0:.0f} or more",
        ),
        WRONG_SURROUNDINGS: (
            f"has a color of ball.surrounding on {blob.surrounding:.0%} of the ring round it",
            f"{finder.min_surrounding:.0%} or more",
        ),
    }
    shape = f"it {area} and is {blob.elongation:.1f} times as long as wide"
    return texts.get(gate, (f"has confidence {blob.confidence:.2f} ({shape})", f"{finder.min_confidence:g} or more"))
