"""Why no ball was found, for people: slow, and asked only when somebody wants to know."""

from collections import Counter

from vision_core.geometry import Bytes
from vision_core.models.camera_kernels import CameraMap
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
from vision_core.types.tables import Table


def explain_balls(
    blobs: Table, count: int, pixels: Bytes, classes: Bytes, camera: CameraMap,
    robots: Table, robot_count: int, finder: BallFinder, color: str,
) -> tuple[str, ...]:  # fmt: skip
    """How many blobs each gate of ``find_balls`` stopped, and the nearest to a ball with its numbers; () with a ball.

    The arguments of ``find_balls``; color: the name of the ball's class. The nearest is the one that came through
    most gates, and of these the one most like a ball.
    """
    rows = [blob for blob in blobs[:count] if blob["color"] == finder.color]
    if not rows:
        return (f"no ball: no {color} blob",)
    found = [judged(blob, pixels, classes, camera, robots, robot_count, finder) for blob in rows]
    gates = [stopping_gate(candidate, finder) for candidate in found]
    if PASSED in gates:
        return ()
    stopped = Counter(gates)
    parts = [f"{stopped[gate]} {name}" for gate, name in enumerate(GATES) if stopped[gate]]
    nearest = max(range(len(rows)), key=lambda row: (gates[row], found[row].confidence))
    blob, candidate = rows[nearest], found[nearest]
    where = f"blob at ({blob['x_px']:.0f}, {blob['y_px']:.0f}) px"
    return (
        f"no ball: {len(rows)} {color} blobs: {', '.join(parts)}",
        f"nearest to a ball: {where} {_numbers(gates[nearest], candidate, finder)}",
    )


def _numbers(gate: int, blob: Candidate, finder: BallFinder) -> str:
    """What stopped a blob, with the value found and the value accepted."""
    predicted = f"has {blob.share:.2g} of the area that camera height and ball radius predict"
    texts = {
        OFF_FIELD: f"lies at ({blob.x_m:.2f}, {blob.y_m:.2f}) m, off the field",
        TOO_SMALL: f"{predicted}; accepted: {finder.min_area:g} and more",
        TOO_LARGE: f"{predicted}; accepted: {finder.max_area:g} and less",
        TOO_LONG: f"is {blob.elongation:.1f} times as long as wide; accepted: {finder.max_elongation:g}",
        TOO_RAGGED: f"fills {blob.fill:.2f} of its box; accepted: {finder.min_fill:g} and more",
        ON_ROBOT: f"lies {blob.robot_m * 1000.0:.0f} mm from a robot's center; accepted: "
        f"{finder.inside_robot_m * 1000.0:.0f} and more",
        WRONG_SURROUNDINGS: f"has {blob.surrounding:.2f} of the wanted classes round it; accepted: "
        f"{finder.min_surrounding:g} and more",
    }
    least = f"has confidence {blob.confidence:.2f}; accepted: {finder.min_confidence:g} and more"
    return texts.get(gate, f"{least} ({predicted}, elongation {blob.elongation:.1f})")
