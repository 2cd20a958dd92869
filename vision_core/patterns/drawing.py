"""A marker as a picture: SVG, seen from above, its front up."""

from vision_core.patterns.paints import PAINTS_BGR
from vision_core.patterns.pattern import Pattern
from vision_core.types.objects import Team

GROUND, ARROW, NO_PAINT = "#1e1e1e", "#9a9a9a", "#ffffff"
RIM = 1.25
"""The picture reaches so many times as far as the robot."""


def marker_svg(pattern: Pattern, team: Team, marker_id: int) -> str:
    """One marker on its robot's outline. Raises KeyError for an id that the pattern lacks."""
    half = 1e3 * pattern.robot.radius_m
    side = RIM * half
    shapes = [
        f'<rect x="{-half:g}" y="{-half:g}" width="{2 * half:g}" height="{2 * half:g}" fill="{GROUND}"/>'
        if pattern.robot.outline == "square"
        else f'<circle r="{half:g}" fill="{GROUND}"/>'
    ]
    for patch, color in zip(pattern.layout(marker_id), pattern.colors_worn(team, marker_id), strict=True):
        paint = _paint(color)
        if patch.circle_mm is not None:
            forward, left, diameter = patch.circle_mm
            shapes.append(f'<circle cx="{-left:g}" cy="{-forward:g}" r="{diameter / 2:g}" fill="{paint}"/>')
        else:
            corners = " ".join(f"{-left:g},{-forward:g}" for forward, left in patch.polygon_mm or ())
            shapes.append(f'<polygon points="{corners}" fill="{paint}"/>')
    tip, base, wide = -side * 0.98, -half * 1.04, half * 0.16
    shapes.append(f'<polygon points="0,{tip:g} {-wide:g},{base:g} {wide:g},{base:g}" fill="{ARROW}"/>')
    box = f"{-side:g} {-side:g} {2 * side:g} {2 * side:g}"
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" width="96" height="96">{"".join(shapes)}</svg>'


def _paint(color: str) -> str:
    if color not in PAINTS_BGR:
        return NO_PAINT
    blue, green, red = (round(level) for level in PAINTS_BGR[color])
    return f"#{red:02x}{green:02x}{blue:02x}"
