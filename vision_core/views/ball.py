"""Which fraction of the ball is visible: interval arithmetic on exact angles, not samples.

The ball is a circle on the floor; it spans the azimuth b +- asin(r / d) around its direction b. An
obstacle hides the ball at an angle where its surface is nearer than the ball's **center** distance d: of two
objects that touch side by side, neither hides the other, and a ball in front of a wall that it touches is visible.
So each obstacle is clipped to the disc of radius d around the viewer, and what remains of it hides an interval:

- a circle at distance D, radius R: +- asin(R / D) around its direction, if the tangents touch it within the
  disc, that is d^2 >= D^2 - R^2; otherwise +- acos((D^2 + d^2 - R^2) / (2 D d)), where the two circles cross;
- a segment: from one end to the other of its part within the disc (less than half a turn);
- a square: its four sides.

Visible is what the union of these intervals leaves of the ball's interval.
"""

import math

from vision_core.geometry import Floats
from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel
from vision_core.types.tables import Table
from vision_core.views.outlines import containing_outline, corner

SLIVER_RAD = 1e-9
"""A smaller gap between two intervals is rounding: a corner that two walls share is closed."""
CORNER_DISTANCE = math.sqrt(2.0) * (1.0 + 1e-9)
"""Distance of a square's corner from its center, in half sides, rounded up."""


@kernel
def circle_shadow(x: float, y: float, radius: float, within: float) -> tuple[float, float]:
    """Direction and half width [rad] of what a circle around (x, y) hides of a ball whose center is `within` away.

    Half width 0: nothing; pi: everything, as the circle contains the viewer.
    """
    distance = math.hypot(x, y)
    if distance <= radius:
        return 0.0, math.pi
    if distance - radius >= within:
        return 0.0, 0.0
    if within * within >= distance * distance - radius * radius:
        half = math.asin(radius / distance)
    else:
        cosine = (distance * distance + within * within - radius * radius) / (2.0 * distance * within)
        half = math.acos(min(cosine, 1.0))
    return math.atan2(y, x), half


@kernel
def segment_shadow(x1: float, y1: float, x2: float, y2: float, within: float) -> tuple[float, float]:
    """Direction and half width [rad] of what a segment hides of a ball whose center is `within` away."""
    ex, ey = x2 - x1, y2 - y1
    square = ex * ex + ey * ey
    middle = -(x1 * ex + y1 * ey) / square
    aside = x1 * ey - y1 * ex
    room = within * within * square - aside * aside
    if room <= 0.0:
        return 0.0, 0.0
    # Clip the segment to the disc: parameters start..end, 0 at its first point, 1 at its second.
    half_chord = math.sqrt(room) / square
    start, end = max(middle - half_chord, 0.0), min(middle + half_chord, 1.0)
    if start >= end:
        return 0.0, 0.0
    first = math.atan2(y1 + start * ey, x1 + start * ex)
    opening = wrap_angle(math.atan2(y1 + end * ey, x1 + end * ex) - first)
    return first + opening / 2.0, abs(opening) / 2.0


@kernel
def visible_fraction(
    own: int,
    ball_x_m: float,
    ball_y_m: float,
    ball_radius_m: float,
    outlines: Table,
    outline_count: int,
    walls_m: Floats,
    hidden: Floats,
) -> float:
    """Fraction 0..1 of the ball's azimuth that a robot sees from its center; exactly 1 when nothing hides any of it.

    own: the robot's row in outlines, OUTLINE of ``collect_outlines``; walls_m: solid segments x1 y1 x2 y2, shape
    (s, 4); hidden: scratch memory for one interval of every wall and of four sides of every outline, shape (2, n).
    A ball that the robot's center is on is visible: nothing is nearer.
    """
    x, y = outlines[own].x_m, outlines[own].y_m
    bx, by = ball_x_m - x, ball_y_m - y
    within = math.sqrt(bx * bx + by * by)
    # The two cases without an azimuth: the viewer stands on the ball; another outline contains the viewer.
    if within <= ball_radius_m:
        return 1.0
    if containing_outline(x, y, own, outlines, outline_count) >= 0:
        return 0.0
    azimuth, alpha = math.atan2(by, bx), math.asin(ball_radius_m / within)
    toward_x, toward_y, sine = bx / within, by / within, ball_radius_m / within
    count = 0
    # Walls and goals: there are few, so each is clipped without a test before.
    for k in range(len(walls_m)):
        x1, y1, x2, y2 = walls_m[k, 0] - x, walls_m[k, 1] - y, walls_m[k, 2] - x, walls_m[k, 3] - y
        direction, half = segment_shadow(x1, y1, x2, y2, within)
        count = _add_hidden(direction, half, azimuth, alpha, hidden, count)
    # Robots and obstacles: most of them lie outside of the wedge to the ball, and cost no trigonometry.
    for k in range(outline_count):
        dx, dy, radius = outlines[k].x_m - x, outlines[k].y_m - y, outlines[k].radius_m
        reach = radius * CORNER_DISTANCE if outlines[k].square else radius
        if k == own or _is_clear_of(dx, dy, reach, toward_x, toward_y, sine, within):
            continue
        if outlines[k].square:
            x1, y1 = corner(outlines[k], 0)
            for side in range(1, 5):
                x2, y2 = corner(outlines[k], side)
                direction, half = segment_shadow(x1 - x, y1 - y, x2 - x, y2 - y, within)
                count = _add_hidden(direction, half, azimuth, alpha, hidden, count)
                x1, y1 = x2, y2
        else:
            direction, half = circle_shadow(dx, dy, radius, within)
            count = _add_hidden(direction, half, azimuth, alpha, hidden, count)
    # What the union of the hidden intervals leaves; rounding is neither a visible nor a hidden sliver.
    visible = _uncovered(hidden[0, :count], hidden[1, :count], -alpha, alpha)
    if visible >= 2.0 * alpha - SLIVER_RAD:
        return 1.0
    return visible / (2.0 * alpha) if visible > SLIVER_RAD else 0.0


@kernel
def _is_clear_of(
    x: float, y: float, radius: float, toward_x: float, toward_y: float, sine: float, within: float
) -> bool:
    """Whether a circle is certainly outside of the wedge around the ball, of half width asin(sine), or behind it.

    (toward_x, toward_y): unit vector to the ball's center.
    """
    along, aside = x * toward_x + y * toward_y, abs(x * toward_y - y * toward_x)
    from_wedge = aside * math.sqrt(1.0 - sine * sine) - along * sine
    return from_wedge > radius + SLIVER_RAD or along - radius > within


@kernel
def _add_hidden(direction: float, half: float, azimuth: float, alpha: float, hidden: Floats, count: int) -> int:
    """Append the part of an interval that lies in the ball's, azimuth +- alpha, relative to azimuth; the new count."""
    if half <= 0.0:
        return count
    offset = wrap_angle(direction - azimuth)
    if offset - half < alpha and offset + half > -alpha:
        hidden[0, count], hidden[1, count] = max(offset - half, -alpha), min(offset + half, alpha)
        return count + 1
    return count


@kernel
def _uncovered(lows: Floats, highs: Floats, start: float, end: float) -> float:
    """Length of what intervals leave of [start, end]. They are few: no sorting, each pass skips one overlap."""
    free, here = 0.0, start
    while here < end:
        further, gap_end = here, end
        for k in range(len(lows)):
            if lows[k] <= here + SLIVER_RAD:
                further = max(further, highs[k])
            else:
                gap_end = min(gap_end, lows[k])
        if further > here:
            here = further
        else:
            free += gap_end - here
            here = gap_end
    return free
